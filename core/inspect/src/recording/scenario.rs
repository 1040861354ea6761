//! The scenario that reproduces a recording: steps as segment lists, or bytes as a line script.
//!
//! Steps are exact to the requested error. Pulse width and DIR set-up belong to the bus: the shortest recorded ones are
//! used. Bytes begin within half a bit of the recording; those back to back are one send.

use super::serial::{DecodedLine, Guess};
use crate::trace::timing::{Rule, TimingCheck};
use alloc::{format, string::String, vec::Vec};
use core::fmt;
use stepscope_motion::step_tables::{EntryFormat, Form, MAX_TOLERANCE, Tolerance, stored_steps};
use stepscope_motion::{Cause, ScheduledStep};
use stepscope_peripheral::config::{Bus, Protocol, SerialLine, limits::PULSE_WIDTH_CYCLES};
use stepscope_peripheral::segment::{PulseTimes, Segment, SegmentList};
use stepscope_peripheral::trace::{Step, steps};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::bit_times::{BYTE_BITS, BitTimes};
use stepscope_peripheral::{signal::Record, signal::Sink};
use stepscope_scenario::{
    ChannelSegments, Direction, Hex, LineScript, Problem, Scenario, ScriptedSend, SegmentLists, Source,
    TimingRules,
};
use stepscope_sim::replayed;

/// Lists start at cycle 1 at the earliest.
const START: u64 = 1;
/// Cycles before the first step in addition to its pulse.
const MARGIN: u64 = 1;
/// A pulse is at most this fraction (1/2) of the interval, so that DIR can change.
const MAX_WIDTH_PART: u64 = 2;

/// Options for a scenario that reproduces recorded steps.
#[derive(Clone, Copy, Debug)]
pub struct StepRequest {
    pub clock_hz: u32,
    pub channels: u8,
    /// Maximum error of a step in cycles; more makes fewer segments.
    pub within_cycles: u64,
}

/// A scenario that reproduces a recording, with its errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Reproduction {
    pub scenario: Scenario,
    /// Delay of everything, because a first step may need time for its pulse.
    pub later_cycles: u64,
    pub greatest_error_cycles: u64,
    pub entries: usize,
}

/// Why no scenario reproduces a recording.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotReproducible {
    NoSteps,
    NoBytes,
    Channel(u8, Cause),
    FewCycles(u32, u32),
    Invalid(Problem),
}

impl fmt::Display for NotReproducible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSteps => f.write_str("no channel steps; map a channel to STEP0"),
            Self::NoBytes => f.write_str("no byte was decoded; map a channel to RX, or use another bit rate"),
            Self::Channel(channel, cause) => write!(f, "channel {channel}: {cause}"),
            Self::FewCycles(clock_hz, baud) => write!(
                f,
                "a bit of {baud} baud has fewer than 11 cycles of {clock_hz} Hz; use a clock of at least {} Hz",
                11 * u64::from(*baud)
            ),
            Self::Invalid(problem) => {
                write!(
                    f,
                    "no scenario can reproduce the recording ({problem}); use a shorter recording or another clock"
                )
            }
        }
    }
}

impl core::error::Error for NotReproducible {}

/// The steps of all channels as segment lists.
pub fn of_steps(records: &[Record], request: &StepRequest) -> Result<Reproduction, NotReproducible> {
    let all: Vec<Vec<Step>> = (0..request.channels).map(|channel| steps(records, channel)).collect();
    of_list(&all, request, Some(records))
}

/// Steps by channel, without pulses: the width is half of the shortest interval, at most the default.
pub fn of_step_times(all: &[Vec<Step>], request: &StepRequest) -> Result<Reproduction, NotReproducible> {
    of_list(all, request, None)
}

fn of_list(
    all: &[Vec<Step>],
    request: &StepRequest,
    records: Option<&[Record]>,
) -> Result<Reproduction, NotReproducible> {
    let first = all
        .iter()
        .filter_map(|steps| steps.first())
        .map(|step| step.cycle)
        .min()
        .ok_or(NotReproducible::NoSteps)?;
    let pulse = pulse_times(records, all, request.clock_hz);
    let min_start = pulse.width.0 + (pulse.hold.0 + pulse.setup.0).max(1) + MARGIN;
    let later_cycles = (START + min_start).saturating_sub(first);
    let form = match request.within_cycles {
        0 => Form::Exact,
        within => Form::Quick(Tolerance::of(Cycles(within.min(MAX_TOLERANCE.0)))),
    };
    let (mut channels, mut max_error, mut entries) = (Vec::new(), 0, 0);
    for (channel, steps) in (0..).zip(all) {
        let mut list = ChannelSegments { start_cycle: START, segments: Vec::new() };
        if !steps.is_empty() {
            let scheduled: Vec<ScheduledStep> = steps
                .iter()
                .enumerate()
                .map(|(index, step)| ScheduledStep {
                    cycle: step.cycle + later_cycles - START,
                    right: Step::direction(steps, index) > 0,
                })
                .collect();
            let stored = stored_steps(&scheduled, form, EntryFormat::Q16, pulse)
                .map_err(|cause| NotReproducible::Channel(channel, cause))?;
            max_error = max_error.max(stored.error.max_cycles);
            list = channel_list(&stored.list);
        }
        entries += list.segments.len();
        channels.push(list);
    }
    let mut scenario = Scenario { clock_hz: request.clock_hz, ..Scenario::default() };
    scenario.bus.channels = request.channels;
    let narrow = |cycles: Cycles| u32::try_from(cycles.0).unwrap_or(u32::MAX);
    scenario.bus.pulse_width_cycles = narrow(pulse.width);
    scenario.bus.dir_setup_cycles = narrow(pulse.setup);
    scenario.bus.dir_hold_cycles = narrow(pulse.hold);
    scenario.source = Source::Segments(SegmentLists { channels });
    scenario.analysis.axis = 0;
    Ok(Reproduction { scenario, later_cycles, greatest_error_cycles: max_error, entries })
}

fn channel_list(list: &SegmentList) -> ChannelSegments {
    use stepscope_scenario::{DwellSegment, Segment as Written, StepSegment};
    let segment = |each: &Segment| match *each {
        Segment::Steps { count, interval, add, right } => Written::Steps(StepSegment {
            count,
            interval_q16: interval,
            add_q16: add,
            direction: Direction::of_dir(right),
        }),
        Segment::Dwell(length_q16) => Written::Dwell(DwellSegment { length_q16 }),
    };
    ChannelSegments { start_cycle: list.start.0, segments: list.segments.iter().map(segment).collect() }
}

/// The shortest recorded width and set-up, which fit all pulses.
fn pulse_times(records: Option<&[Record]>, all: &[Vec<Step>], clock_hz: u32) -> PulseTimes {
    let mut check = TimingCheck::new(&TimingRules::default(), clock_hz, 0);
    records.into_iter().flatten().for_each(|record| check.record(*record));
    let shortest = |rule: Rule| {
        let found = check.results().iter().find(|result| result.rule == rule)?.shortest?;
        Some(found.measured.0)
    };
    let interval = all
        .iter()
        .flat_map(|steps| steps.iter().zip(steps.iter().skip(1)))
        .map(|(before, step)| step.cycle - before.cycle)
        .min()
        .unwrap_or(u64::MAX);
    let width = shortest(Rule::StepHigh)
        .unwrap_or_else(|| Bus::default().pulse_width_cycles.into())
        .min(interval / MAX_WIDTH_PART)
        .clamp(*PULSE_WIDTH_CYCLES.start(), *PULSE_WIDTH_CYCLES.end());
    // DIR changes at the start of a segment, long before most of its steps. A longer set-up would only reject some.
    let setup =
        shortest(Rule::DirSetup).unwrap_or(0).min(width).min(interval.saturating_sub(width) / MAX_WIDTH_PART);
    PulseTimes { width: Cycles(width), setup: Cycles(setup), hold: Cycles(0) }
}

/// Options for a scenario that reproduces recorded bytes.
#[derive(Clone, Copy, Debug)]
pub struct ByteRequest {
    pub clock_hz: u32,
    pub baud: u32,
    pub guess: Guess,
    /// Used if the bytes do not determine it.
    pub channels: u8,
}

/// The bytes of a line as a line script for the controllers of `base`, or for one that the bytes imply.
pub fn of_bytes(
    decoded: &DecodedLine,
    request: &ByteRequest,
    base: Option<&Scenario>,
) -> Result<Reproduction, NotReproducible> {
    let ByteRequest { clock_hz, baud, .. } = *request;
    let first = decoded.bytes.first().ok_or(NotReproducible::NoBytes)?;
    let mut scenario = base.map_or_else(|| implied_by(request), Scenario::clone);
    let own_hz = scenario.clock_hz;
    if u64::from(own_hz) < 11 * u64::from(baud) {
        return Err(NotReproducible::FewCycles(own_hz, baud));
    }
    let times = BitTimes::new(own_hz, baud);
    let half_bit = times.bit(1).0 / 2;
    let cycle = |at: Instant| {
        let (clock_hz, own_hz) = (u128::from(clock_hz.max(1)), u128::from(own_hz));
        u64::try_from((2 * u128::from(at.0) * own_hz + clock_hz) / (2 * clock_hz)).unwrap_or(u64::MAX)
    };
    let later_cycles = START.saturating_sub(cycle(first.start));
    let mut sends: Vec<ScriptedSend> = Vec::new();
    let mut max_error = 0;
    for byte in &decoded.bytes {
        let at = cycle(byte.start).saturating_add(later_cycles);
        let next =
            sends.last().map(|send| send.start_cycle.saturating_add(times.byte(send.bytes.0.len() as u64).0));
        // With a fast clock bytes overlap; these are sent back to back.
        match (sends.last_mut(), next) {
            (Some(send), Some(next)) if at <= next.saturating_add(half_bit) => {
                max_error = max_error.max(at.abs_diff(next));
                send.bytes.0.push(byte.byte);
            }
            _ => {
                sends.push(ScriptedSend { start_cycle: at, bytes: Hex(Vec::from([byte.byte])), frame: None });
            }
        }
    }
    scenario.line.baud = baud;
    let entries = sends.len();
    let scenario = replayed(scenario, LineScript { sends });
    Ok(Reproduction { scenario, later_cycles, greatest_error_cycles: max_error, entries })
}

fn implied_by(request: &ByteRequest) -> Scenario {
    let mut scenario = Scenario::default();
    if u64::from(scenario.clock_hz) < 11 * u64::from(request.baud) {
        scenario.clock_hz = request.clock_hz;
    }
    let defaults = SerialLine::default();
    let (protocol, address, own) = match request.guess {
        Guess::Framed { address, channels, .. } => (Protocol::Framed, Some(address), channels),
        Guess::Raw { length, .. } => (Protocol::Raw, None, Some(length)),
        Guess::Other => (defaults.protocol, None, None),
    };
    scenario.bus.channels = own.unwrap_or(request.channels).clamp(1, 16);
    scenario.line.protocol = protocol;
    scenario.line.address = address;
    scenario
}

/// The note of the scenario: what it reproduces, and how exactly.
pub fn note(file: &str, reproduced: &Reproduction) -> String {
    let error = match reproduced.greatest_error_cycles {
        0 => "cycle-exact".into(),
        cycles => format!("none more than {cycles} cycles off"),
    };
    let later = match reproduced.later_cycles {
        0 => String::new(),
        cycles => format!(", all {cycles} cycles later than recorded"),
    };
    match reproduced.scenario.source {
        Source::Line(_) => format!("Bytes recorded in {file}: {} sends, {error}{later}.", reproduced.entries),
        _ => format!("Steps recorded in {file}: {} segments, {error}{later}.", reproduced.entries),
    }
}

/// The end of the last byte.
pub fn end_of(decoded: &DecodedLine, bit_cycles: u64) -> Option<Instant> {
    decoded.bytes.last().map(|byte| Instant(byte.start.0 + BYTE_BITS * bit_cycles))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::serial::{decode_line, guess};
    use crate::trace::stored_run::StoredRun;
    use stepscope_peripheral::signal::Levels;
    use stepscope_sim::Experiment;

    fn recorded(json: &str) -> StoredRun {
        let mut recording = StoredRun::default();
        Experiment::from_json(json).expect("no problems").run(&mut recording);
        recording
    }

    #[test]
    fn two_reversing_axes_are_reproduced_despite_an_early_first_step() {
        let motion = r#"{"bus":{"channels":2},"source":{"motion":{"engine":"segments","axes":[
            {"moves":[{"cosine":{"distance":{"steps":400}}},{"dwell":{}},{"cosine":{"distance":{"steps":-100}}}]},
            {"moves":[{"constant":{"distance":{"steps":-300},"speed":{"steps_s":5000}}}]}]}}}"#;
        let mut trace = recorded(motion).trace;
        for early in [0, 1700] {
            let first = steps(&trace, 1)[0].cycle;
            let by = first.saturating_sub(2) * u64::from(early > 0);
            for record in trace.iter_mut().skip(1) {
                record.cycle = Instant(record.cycle.0.saturating_sub(by).max(1));
            }
            let request = StepRequest { clock_hz: 16_000_000, channels: 2, within_cycles: 0 };
            let reproduced = of_steps(&trace, &request).expect("steps");
            assert_eq!(reproduced.greatest_error_cycles, 0);
            let mut again = StoredRun::default();
            Experiment::new(&reproduced.scenario).expect("no problems").run(&mut again);
            for channel in 0..2 {
                let shifted = |step: &Step| Step { cycle: step.cycle + reproduced.later_cycles, ..*step };
                let expected: Vec<Step> = steps(&trace, channel).iter().map(shifted).collect();
                assert_eq!(steps(&again.trace, channel), expected, "channel {channel}, {by} earlier");
            }
            assert_eq!(reproduced.later_cycles > 0, early > 0);
        }
    }

    #[test]
    fn decoded_bytes_reproduce_the_run() {
        for json in [
            r#"{"line":{"protocol":"framed","address":3}}"#,
            r#"{"bus":{"channels":2},"source":{"motion":{"axes":[{},{}]}}}"#,
        ] {
            let recording = recorded(json);
            let clock_hz = 16_000_000;
            let decoded = decode_line(&recording.trace, Levels::RX, clock_hz, 115_200);
            let request =
                ByteRequest { clock_hz, baud: 115_200, guess: guess(&decoded.bytes, 139), channels: 1 };
            let reproduced = of_bytes(&decoded, &request, None).expect("bytes");
            let mut again = StoredRun::default();
            Experiment::new(&reproduced.scenario).expect("no problems").run(&mut again);
            assert_eq!(steps(&again.trace, 0), steps(&recording.trace, 0), "{json}");
            assert!(reproduced.greatest_error_cycles <= 1, "{reproduced:?}");
        }
        let error = of_bytes(
            &DecodedLine::default(),
            &ByteRequest { clock_hz: 1, baud: 1, guess: Guess::Other, channels: 1 },
            None,
        );
        assert_eq!(error, Err(NotReproducible::NoBytes));
    }
}
