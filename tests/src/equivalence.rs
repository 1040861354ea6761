//! Compares all ways to run a scenario (DESIGN A2): from event to event, in slices, clock by clock, and a device that is
//! driven directly. Also checks that the trace, positions, ticks and digest of a run agree (A3, A7).
//!
//! All checks panic with the difference, so that property tests, fuzz targets and stored findings can use them.

use std::sync::Arc;
use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    peripheral::{
        config::{Config, Protocol},
        device::Device,
        signal::{Event, Levels, PacketOutcome, Record, Sink},
        trace::{Digest, steps},
        units::{Cycles, Instant},
        wire::{ForcedLevel, Line},
    },
    scenario::{Noise, Scenario},
    sim::{Experiment, Run},
};

/// All results of a run.
#[derive(Default)]
pub struct Left {
    /// Records, digest and packets.
    pub recording: StoredRun,
    /// All events, in addition to the signals.
    pub events: Vec<(Instant, Event)>,
}

impl Sink for Left {
    fn record(&mut self, record: Record) {
        self.recording.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.recording.event(at, event);
        self.events.push((at, event));
    }
}

/// The ways to run a scenario.
#[derive(Clone, Copy, Debug)]
pub struct Ways<'a> {
    /// Slices of these numbers of records, repeated; none is 0.
    pub slices: &'a [u64],
    /// Percentage of the idle cycles that a directly driven device skips at once.
    pub hurry: u64,
    /// Maximum length of a run that is also made clock by clock, in cycles.
    pub most_clocked: u64,
}

/// Runs a scenario in every way; directly only if a single controller runs ticks on a raw line without noise.
///
/// # Panics
/// If two runs differ, if the results of a run contradict each other, or if the run exceeds its computed cost
/// (not checked if the host waits for replies, because then the cost is an estimate).
pub fn check(scenario: &Scenario, experiment: &Experiment, ways: Ways<'_>) {
    let each = || -> Vec<Left> { experiment.configs().map(|_| Left::default()).collect() };
    let mut fast = each();
    let run = experiment.run_each(&mut fast);
    assert!(run.is_done(), "the run ends");
    let (cost, cycles) = (experiment.cost(), run.cycles());
    if run.host().is_none() {
        let made: usize = fast.iter().map(|left| left.recording.trace.len()).sum();
        assert!(cycles.0 <= cost.end_cycle, "{} cycles were run, {} announced", cycles.0, cost.end_cycle);
        assert!(made as u64 <= cost.records, "{made} records were made, {} announced", cost.records);
    }
    if experiment.segments().is_some() {
        assert!(fast.iter().all(|left| left.events.is_empty()), "segments make pulses and nothing else");
        assert_eq!((run.faults().bits(), run.ticks_done()), (0, 0), "segments have no faults and no ticks");
    }
    // The segment engine replaces the first controller.
    let first = run.positions();
    let positions = [&first[..]].into_iter().chain(run.devices().skip(1).map(Device::positions));
    for (((left, device), config), positions) in
        fast.iter().zip(run.devices()).zip(experiment.configs()).zip(positions)
    {
        consistent(left, config, cycles);
        counted(left, config, positions, device.ticks_done());
    }

    let (mut left, mut sliced) = (each(), experiment.start());
    for records in ways.slices.iter().cycle() {
        if sliced.advance_each(*records, &mut left) {
            break;
        }
    }
    same_run("in slices", (&left, &sliced), (&fast, &run));
    if cycles.0 <= ways.most_clocked {
        let mut left = each();
        let clocked = experiment.run_each_clock_by_clock(&mut left);
        same_run("clock by clock", (&left, &clocked), (&fast, &run));
    }
    if let [fast] = fast.as_slice()
        && experiment.config().protocol() == Protocol::Raw
        && experiment.segments().is_none()
        && experiment.stand_alone().is_none()
        && scenario.line.noise == Noise::default()
    {
        let (left, device) = by_hand(experiment.config(), line(scenario, experiment), cycles, ways.hurry);
        same("by hand", (&left, &device), (fast, run.device()));
    }
}

/// Compares two runs of the same scenario, controller by controller.
fn same_run(way: &str, (left, run): (&[Left], &Run), (fast, fast_run): (&[Left], &Run)) {
    let both = left.iter().zip(run.devices()).zip(fast.iter().zip(fast_run.devices()));
    for (index, (left, fast)) in both.enumerate() {
        same(&format!("{way}, controller {index}"), left, fast);
    }
    assert_eq!(run.schedule(), fast_run.schedule(), "{way}: what was sent");
    assert_eq!(run.positions(), fast_run.positions(), "{way}: positions");
    assert_eq!(run.cycles(), fast_run.cycles(), "{way}: cycles");
}

/// Compares the results of two runs of the same scenario.
///
/// # Panics
/// If they differ, with the name of the first and the first difference.
pub fn same(way: &str, left: (&Left, &Device), fast: (&Left, &Device)) {
    let ((left, device), (fast, fast_device)) = (left, fast);
    each_equal(way, "record", &left.recording.trace, &fast.recording.trace);
    each_equal(way, "event", &left.events, &fast.events);
    assert_eq!(left.recording.digest.value(), fast.recording.digest.value(), "{way}: digest");
    assert_eq!(device.positions(), fast_device.positions(), "{way}: positions");
    assert_eq!(device.faults(), fast_device.faults(), "{way}: faults");
    assert_eq!(device.ticks_done(), fast_device.ticks_done(), "{way}: ticks done");
    assert_eq!(device.status(), fast_device.status(), "{way}: status");
    assert_eq!(device.now(), fast_device.now(), "{way}: cycles");
}

/// Compares lists entry by entry, so that a message has only the difference.
fn each_equal<T: PartialEq + std::fmt::Debug>(way: &str, what: &str, left: &[T], fast: &[T]) {
    for index in 0..left.len().max(fast.len()) {
        assert_eq!(left.get(index), fast.get(index), "{way}: {what} {index}");
    }
}

/// Checks the form of a trace (A3).
fn consistent(left: &Left, config: &Config, cycles: Cycles) {
    let trace = &left.recording.trace;
    let first = Record { cycle: Instant::RESET, levels: Levels::RESET };
    assert_eq!(trace.first(), Some(&first), "a trace begins with reset");
    for pair in trace.windows(2) {
        assert!(pair[0].cycle < pair[1].cycle, "cycles rise: {pair:?}");
        assert_ne!(pair[0].levels, pair[1].levels, "a record is a change: {pair:?}");
    }
    assert!(trace.last().is_none_or(|last| last.cycle.0 < cycles.0), "no record after the run's end");
    let unused = !0_u16 << (config.channels() - 1) << 1;
    for record in trace {
        let levels = record.levels;
        assert_eq!((levels.step() | levels.dir()) & unused, 0, "unused channels stay low: {record:?}");
    }
    assert_eq!(Digest::of(trace), left.recording.digest.value(), "digest of the records");
}

/// Compares a controller's counters with its trace and its events.
fn counted(left: &Left, config: &Config, positions: &[i32], ticks_done: u32) {
    for (channel, &position) in (0..).zip(positions) {
        let made = steps(&left.recording.trace, channel).last().map_or(0, |step| step.position);
        assert_eq!(made, position, "position of channel {channel}, from the trace and as counted");
    }
    let count = |is: fn(&Event) -> bool| left.events.iter().filter(|(_, event)| is(event)).count();
    let begun = count(|event| matches!(event, Event::TickStart { .. }));
    let ended = count(|event| matches!(event, Event::TickEnd));
    assert_eq!(ticks_done as usize, ended, "ticks done, as counted and as events");
    if config.protocol() == Protocol::Raw {
        let queued = count(|event| matches!(event, Event::Packet(PacketOutcome::Queued)));
        assert!(begun == ended || begun == ended + 1, "{begun} ticks began, {ended} ended");
        assert!(begun <= queued, "{begun} ticks began, {queued} packets were queued");
    } else {
        // STOP cancels ticks.
        assert!(begun >= ended, "{begun} ticks began, {ended} ended");
    }
}

/// Drives a peripheral like a test of firmware: `clock` where something can change, `advance` over the idle cycles.
/// `hurry` is the percentage of them that it skips at once.
fn by_hand(config: &Config, mut line: Line, cycles: Cycles, hurry: u64) -> (Left, Device) {
    let (mut left, mut device) = (Left::default(), Device::new(config));
    while device.now().0 < cycles.0 {
        if line.next_change() == device.now() {
            line.change();
        }
        device.clock(line.level(true), &mut left);
        let horizon = line.next_change().0.min(cycles.0).saturating_sub(device.now().0);
        let quiet = device.cycles_until_event().map_or(horizon, |quiet| quiet.0.min(horizon));
        device.advance(Cycles((u128::from(quiet) * u128::from(hurry) / 100) as u64));
    }
    (left, device)
}

/// The line of a scenario, from its sends and forced levels.
fn line(scenario: &Scenario, experiment: &Experiment) -> Line {
    let forced = scenario.line.glitches.iter().map(|glitch| ForcedLevel {
        start: Instant(glitch.start_cycle),
        end: Instant(glitch.start_cycle + glitch.length_cycles),
        level: glitch.level != 0,
    });
    let forced: Vec<ForcedLevel> = forced.collect();
    Line::new(Arc::new(experiment.schedule().clone()), &forced, scenario.clock_hz, scenario.line.baud)
}
