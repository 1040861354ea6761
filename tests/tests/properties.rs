//! What holds for every scenario, over random ones of all sources: all speeds give the same run (DESIGN A2), a run
//! costs no more than was said before it, and a scenario survives its way through JSON and links (PAGE "Share link").
#![cfg(not(target_arch = "wasm32"))]

use proptest::{prelude::*, test_runner::FileFailurePersistence};
use std::rc::Rc;
use stepscope_core::{
    device::Device,
    run::{Cost, Experiment, Run},
    scenario::{
        Compact, Config, Forced, Scenario,
        link::{LinkError, decode, encode},
    },
    signal::{Event, Record, Sink},
    trace::{Digest, Recording},
    units::{Cycles, Instant},
    wire::Line,
};
use stepscope_tests::scenarios::{segmented, small, typed};

/// Some seconds' worth of cases, or as many as PROPTEST_CASES says.
fn cases(cases: u32) -> ProptestConfig {
    let told = ProptestConfig::default();
    ProptestConfig {
        cases: if std::env::var_os("PROPTEST_CASES").is_some() { told.cases } else { cases },
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..told
    }
}

/// All that a run leaves.
#[derive(Default)]
struct Left {
    recording: Recording,
    events: Vec<(Instant, Event)>,
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

/// Two ways through the same scenario left the same.
fn same(way: &str, left: (&Left, &Device), fast: (&Left, &Device)) -> Result<(), TestCaseError> {
    let ((left, device), (fast, fast_device)) = (left, fast);
    let longest = left.recording.trace.len().max(fast.recording.trace.len());
    for index in 0..longest {
        let (record, expected) = (left.recording.trace.get(index), fast.recording.trace.get(index));
        prop_assert_eq!(record, expected, "{}: record {}", way, index);
    }
    prop_assert_eq!(left.recording.digest.value(), fast.recording.digest.value(), "{}: digest", way);
    prop_assert_eq!(&left.events, &fast.events, "{}: events", way);
    prop_assert_eq!(device.positions(), fast_device.positions(), "{}: positions", way);
    prop_assert_eq!(device.faults(), fast_device.faults(), "{}: faults", way);
    prop_assert_eq!(device.ticks_done(), fast_device.ticks_done(), "{}: ticks done", way);
    prop_assert_eq!(device.now(), fast_device.now(), "{}: cycles", way);
    Ok(())
}

/// The run in slices of so many records, again and again.
fn in_slices(experiment: &Experiment, slices: &[u64]) -> (Left, Run) {
    let (mut left, mut run) = (Left::default(), experiment.start());
    for records in slices.iter().cycle() {
        if run.advance(*records, &mut left) {
            break;
        }
    }
    (left, run)
}

/// As a firmware's test would drive a peripheral by hand: `clock` where something can change, `skip` over what `quiet`
/// says. `hurry` is how much of that it skips at once, in percent.
fn by_hand(config: &Config, mut line: Line, cycles: Cycles, hurry: u64) -> (Left, Device) {
    let (mut left, mut device) = (Left::default(), Device::new(config));
    while device.now().0 < cycles.0 {
        if line.next_change() == device.now() {
            line.change();
        }
        device.clock(line.heard(true), &mut left);
        let horizon = line.next_change().0.min(cycles.0).saturating_sub(device.now().0);
        let quiet = device.quiet().map_or(horizon, |quiet| quiet.0.min(horizon));
        device.skip(Cycles((u128::from(quiet) * u128::from(hurry) / 100) as u64));
    }
    (left, device)
}

/// The line of a scenario, made from the outside.
fn line(scenario: &Scenario, experiment: &Experiment) -> Line {
    let forced = scenario.line.glitches.iter().map(|glitch| Forced {
        start: Instant(glitch.start_cycle),
        end: Instant(glitch.start_cycle + glitch.length_cycles),
        level: glitch.level != 0,
    });
    let forced: Vec<Forced> = forced.collect();
    Line::new(Rc::new(experiment.schedule().clone()), &forced, scenario.clock_hz, scenario.line.baud)
}

/// What was made is not above what was said before.
fn within(cost: Cost, left: &Left, cycles: Cycles) -> Result<(), TestCaseError> {
    prop_assert!(cycles.0 <= cost.end_cycle, "{} cycles were run, {} announced", cycles.0, cost.end_cycle);
    let made = left.recording.trace.len() as u64;
    prop_assert!(made <= cost.records, "{} records were made, {} announced", made, cost.records);
    Ok(())
}

proptest! {
    #![proptest_config(cases(1_500))]

    #[test]
    fn every_way_through_a_scenario_leaves_the_same(
        scenario in small(),
        slices in prop::collection::vec(1..40_u64, 1..5),
        hurry in 0..=100_u64,
    ) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        let (mut fast, mut slow) = (Left::default(), Left::default());
        let run = experiment.run(&mut fast);
        within(experiment.cost(), &fast, run.cycles())?;
        prop_assert!(run.is_done());

        let (left, sliced) = in_slices(&experiment, &slices);
        same("in slices", (&left, sliced.device()), (&fast, run.device()))?;
        let (left, device) = by_hand(experiment.config(), line(&scenario, &experiment), run.cycles(), hurry);
        same("by hand", (&left, &device), (&fast, run.device()))?;
        if run.cycles().0 < 200_000 {
            let clocked = experiment.run_clock_by_clock(&mut slow);
            same("clock by clock", (&slow, clocked.device()), (&fast, run.device()))?;
        }
    }

    #[test]
    fn every_way_through_segments_leaves_the_same(
        scenario in segmented(),
        slices in prop::collection::vec(1..40_u64, 1..5),
    ) {
        let Ok(experiment) = Experiment::new(&scenario) else { return Ok(()) };
        let (mut fast, mut slow) = (Left::default(), Left::default());
        let run = experiment.run(&mut fast);
        within(experiment.cost(), &fast, run.cycles())?;
        prop_assert!(run.is_done());
        prop_assert!(fast.events.is_empty() && run.faults().bits() == 0 && run.ticks_done() == 0);
        let clocked = experiment.run_clock_by_clock(&mut slow);
        let (sliced, sliced_run) = in_slices(&experiment, &slices);
        for (left, other) in [(&slow, &clocked), (&sliced, &sliced_run)] {
            prop_assert_eq!(&left.recording.trace, &fast.recording.trace);
            prop_assert_eq!(left.recording.digest.value(), fast.recording.digest.value());
            prop_assert_eq!((other.positions(), other.cycles()), (run.positions(), run.cycles()));
        }
    }

    /// Not only what a scenario can put on the line: any levels at all, such as a firmware's test would feed.
    #[test]
    fn no_line_makes_the_peripheral_fail_and_skipping_changes_nothing(
        scenario in small(),
        lengths in prop::collection::vec(prop_oneof![3 => 1..30_u64, 1 => 1..2_000_u64], 0..200),
    ) {
        let Ok(config) = Config::new(scenario.clock_hz, &scenario.bus, &scenario.line) else { return Ok(()) };
        let (mut every, mut skipping) = (Left::default(), Left::default());
        let (mut clocked, mut skipped) = (Device::new(&config), Device::new(&config));
        let mut end = 0;
        for (index, length) in lengths.iter().chain(&[1_000]).enumerate() {
            let level = index % 2 == 0;
            end += length;
            while clocked.now().0 < end {
                clocked.clock(level, &mut every);
            }
            while skipped.now().0 < end {
                skipped.clock(level, &mut skipping);
                let left = end - skipped.now().0;
                skipped.skip(skipped.quiet().map_or(Cycles(left), |quiet| Cycles(quiet.0.min(left))));
            }
        }
        same("skipping", (&skipping, &skipped), (&every, &clocked))?;
    }
}

proptest! {
    #![proptest_config(cases(4_000))]

    #[test]
    fn a_scenario_survives_json_and_links(scenario in prop_oneof![typed(), small()]) {
        for json in [scenario.to_json(), scenario.compact().to_string()] {
            let read = Scenario::from_json(&json);
            prop_assert_eq!(read.as_ref(), Ok(&scenario), "{}", json);
        }
        match encode(&scenario) {
            Ok(link) => {
                let opened = decode(&link);
                prop_assert_eq!(opened.as_ref(), Ok(&scenario));
                prop_assert_eq!(encode(&opened.unwrap_or_default()), Ok(link));
            }
            Err(error) => prop_assert!(matches!(error, LinkError::TooLong { .. }), "{:?}", error),
        }
    }

    /// Equal is equal: however its numbers were written.
    #[test]
    fn equal_scenarios_have_the_same_link(scenario in typed()) {
        let again = Scenario::from_json(&without_signs_of_zero(&scenario.to_json())).expect("reads");
        prop_assert_eq!(&again, &scenario);
        prop_assert_eq!(again.compact().to_string(), scenario.compact().to_string());
    }
}

/// -0.0 and 0.0 are the same number.
fn without_signs_of_zero(json: &str) -> String {
    json.replace(": -0.0,", ": 0.0,").replace(": -0.0\n", ": 0.0\n")
}

#[test]
fn the_same_run_has_the_same_digest_whatever_takes_its_records() {
    let experiment = Experiment::new(&Scenario::default()).expect("the default has no problems");
    let mut both = (Digest::default(), Vec::<Record>::new());
    experiment.run(&mut both);
    assert_eq!(both.0.value(), Digest::of(&both.1));
    assert_eq!(both.0.records(), both.1.len() as u64);
}
