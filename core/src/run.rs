//! From a scenario to its trace: the whole line in one call.
//!
//! ```
//! use stepscope_core::{run::Experiment, scenario::Scenario, trace::Digest};
//!
//! let scenario = Scenario::from_json(r#"{ "title": "the default motion" }"#).expect("reads");
//! let experiment = Experiment::new(&scenario).expect("has no problems");
//! let mut digest = Digest::default();
//! let run = experiment.run(&mut digest);
//! assert_eq!(run.device().positions()[0], 3200);
//! ```

mod cost;

pub use cost::{BUDGET_RECORDS, Cost};

use crate::{
    device::{Device, Faults, SegmentEngine},
    motion::{self, AxisPlan},
    quantise::{exact_segments, ticks},
    scenario::{Cause, Checked, Config, END_OF_TIME, Problem, Scenario, Source, line_time},
    segment::{CheckedSegments, PulseTimes},
    signal::{Event, MAX_CHANNELS, Record, Sink},
    units::{Cycles, Instant},
    wire::{Line, Schedule, host::carries},
};
use alloc::{rc::Rc, vec::Vec};

/// A scenario that has been judged in every respect, with its motions planned and its packets made.
#[derive(Clone, Debug)]
pub struct Experiment {
    checked: Checked,
    plans: Vec<AxisPlan>,
    schedule: Rc<Schedule>,
    /// What the segment engine runs, where segments run the scenario; then the schedule is empty.
    segments: Option<Rc<CheckedSegments>>,
    cost: Cost,
}

impl Experiment {
    /// Judges a scenario and prepares its run.
    ///
    /// # Errors
    /// Every problem of the scenario, each with its path.
    pub fn new(scenario: &Scenario) -> Result<Self, Vec<Problem>> {
        let mut problems = Vec::new();
        let checked = scenario.check().map_err(|found| problems.extend(found)).ok();
        let plans = plan(scenario).map_err(|found| problems.extend(found)).ok();
        let Some(checked) = checked else { return Err(problems) };
        if !matches!(checked.source, Source::Line(_))
            && !checked.source.runs_segments()
            && let Err(cause) = carries(&checked.config, checked.baud)
        {
            problems.push(Problem::new("line.baud", cause));
        }
        let Some(plans) = plans else { return Err(problems) };
        let schedule = match schedule(&checked, &plans) {
            Ok(schedule) if problems.is_empty() => schedule,
            judged => {
                problems.extend(judged.err().unwrap_or_default());
                return Err(problems);
            }
        };
        let segments = match segments(&checked, &plans) {
            Ok(segments) => segments.map(Rc::new),
            Err(problems) => return Err(problems),
        };
        let cost = match &segments {
            Some(segments) => Cost::of_segments(segments, checked.run),
            None => Cost::of(&checked, &schedule),
        };
        if cost.end_cycle > END_OF_TIME {
            let cause =
                Cause::TooMuch { given: cost.end_cycle as f64, most: END_OF_TIME as f64, of: "cycles" };
            return Err(alloc::vec![Problem::new("source", cause)]);
        }
        Ok(Self { checked, plans, schedule: Rc::new(schedule), segments, cost })
    }

    /// Reads, judges and prepares a scenario.
    ///
    /// # Errors
    /// Every problem, those of types and those of numbers together.
    pub fn from_json(text: &str) -> Result<Self, Vec<Problem>> {
        let (scenario, unread) = Scenario::from_json_lenient(text);
        Self::of_lenient(&scenario, unread)
    }

    /// Judges a scenario of which some fields could not be read, `unread`: these stand at their
    /// defaults while the rest is judged, and what follows from several fields together waits until
    /// all can be read.
    ///
    /// # Errors
    /// `unread` and what else is wrong.
    pub fn of_lenient(scenario: &Scenario, unread: Vec<Problem>) -> Result<Self, Vec<Problem>> {
        let judged = Self::new(scenario);
        if unread.is_empty() {
            return judged;
        }
        let mut problems = unread.clone();
        problems.extend(judged.err().unwrap_or_default().into_iter().filter(|problem| {
            !problem.cause.joins_fields() && !unread.iter().any(|bad| problem.path.starts_with(&bad.path))
        }));
        Err(problems)
    }

    /// The peripheral's configuration.
    #[must_use]
    pub const fn config(&self) -> &Config {
        &self.checked.config
    }

    /// The plan of each axis; empty where the source is no motion.
    #[must_use]
    pub fn plans(&self) -> &[AxisPlan] {
        &self.plans
    }

    /// What the host sends.
    #[must_use]
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// What the segment engine runs; `None` where ticks run the scenario.
    #[must_use]
    pub fn segments(&self) -> Option<&CheckedSegments> {
        self.segments.as_deref()
    }

    /// What the run will cost.
    #[must_use]
    pub const fn cost(&self) -> Cost {
        self.cost
    }

    /// The part of the line's time that the host's packets take, 0..=1; `None` where nothing paced
    /// is sent.
    #[must_use]
    pub fn line_load(&self) -> Option<f64> {
        let config = self.config();
        let packet = line_time(config.packet_len() as u64, config.clock_hz(), self.checked.baud);
        match self.checked.source {
            Source::Line(_) => None,
            _ if self.schedule.is_empty() => None,
            _ => Some(packet as f64 / config.tick().0 as f64),
        }
    }

    /// A run before cycle 0.
    #[must_use]
    pub fn start(&self) -> Run {
        let Checked { config, baud, forced, run, .. } = &self.checked;
        Run {
            device: Device::new(config),
            engine: self.segments.clone().map(SegmentEngine::new),
            line: Line::new(Rc::clone(&self.schedule), forced, config.clock_hz(), *baud),
            end: run.map(|cycles| Instant(cycles.0)),
        }
    }

    /// The whole run, at the fast speed.
    pub fn run(&self, sink: &mut impl Sink) -> Run {
        let mut run = self.start();
        while !run.advance(u64::MAX, sink) {}
        run
    }

    /// The whole run clock by clock: slow, and the measure of the fast speed.
    pub fn run_clock_by_clock(&self, sink: &mut impl Sink) -> Run {
        let mut run = self.start();
        while !run.is_done() {
            run.clock(sink);
        }
        run
    }
}

/// A run under way.
#[derive(Clone, Debug)]
pub struct Run {
    device: Device,
    /// Runs in place of the device, which then stays before cycle 0.
    engine: Option<SegmentEngine>,
    line: Line,
    /// First cycle that is not run; without it the run ends when nothing can change any more.
    end: Option<Instant>,
}

impl Run {
    /// The peripheral as it is now; where segments run the scenario, a peripheral before cycle 0.
    #[must_use]
    pub const fn device(&self) -> &Device {
        &self.device
    }

    /// Position counters (DESIGN A3).
    #[must_use]
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        self.engine.as_ref().map_or_else(|| self.device.positions(), SegmentEngine::positions)
    }

    /// Faults so far; segments have none.
    #[must_use]
    pub const fn faults(&self) -> Faults {
        self.device.faults()
    }

    /// Ticks that have ended; segments have none.
    #[must_use]
    pub const fn ticks_done(&self) -> u32 {
        self.device.ticks_done()
    }

    /// The cycle that comes next.
    const fn now(&self) -> Instant {
        match &self.engine {
            Some(engine) => engine.now(),
            None => self.device.now(),
        }
    }

    /// Cycles that have been run.
    #[must_use]
    pub const fn cycles(&self) -> Cycles {
        Cycles(self.now().0)
    }

    /// Whether the run is over.
    #[must_use]
    pub fn is_done(&self) -> bool {
        match self.end {
            Some(end) => self.now() >= end,
            None => match &self.engine {
                Some(engine) => engine.at_rest(),
                None => self.line.next_change() == Instant::NEVER && self.device.at_rest(),
            },
        }
    }

    /// Goes on until `records` more have been made (a few more may come) or to the end; true at the
    /// end.
    pub fn advance(&mut self, records: u64, sink: &mut impl Sink) -> bool {
        let mut slice = Slice { sink, left: records };
        let end = self.end.unwrap_or(Instant::NEVER);
        match &mut self.engine {
            Some(engine) => engine.run(end, &mut slice),
            None => self.device.run(&mut self.line, end, &mut slice),
        }
        self.is_done()
    }

    /// One cycle.
    pub fn clock(&mut self, sink: &mut impl Sink) {
        if let Some(engine) = &mut self.engine {
            engine.clock(sink);
            return;
        }
        if self.line.next_change() == self.device.now() {
            self.line.change();
        }
        self.device.clock(self.line.level(), sink);
    }
}

/// A sink that asks for a pause after so many records.
struct Slice<'a, S> {
    sink: &'a mut S,
    left: u64,
}

impl<S: Sink> Sink for Slice<'_, S> {
    #[inline(always)]
    fn record(&mut self, record: Record) {
        self.left = self.left.saturating_sub(1);
        self.sink.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.sink.event(at, event);
    }

    fn paused(&self) -> bool {
        self.left == 0
    }
}

/// The plan of each axis, if the source is a motion.
fn plan(scenario: &Scenario) -> Result<Vec<AxisPlan>, Vec<Problem>> {
    let Source::Motion(motion) = &scenario.source else { return Ok(Vec::new()) };
    motion::plan(motion)
}

/// What the host sends.
fn schedule(checked: &Checked, plans: &[AxisPlan]) -> Result<Schedule, Vec<Problem>> {
    let config = &checked.config;
    Ok(match &checked.source {
        Source::Segments(_) => Schedule::default(),
        Source::Motion(_) if checked.source.runs_segments() => Schedule::default(),
        Source::Motion(_) => {
            let ticks = ticks(plans, config.channels(), config.slots(), config.tick().0, config.clock_hz())?;
            let packet = |tick: &[u8]| config.address().into_iter().chain(tick.iter().copied()).collect();
            Schedule::paced(config, ticks.iter().map(|tick| -> Vec<u8> { packet(tick) }))
        }
        Source::Packets(source) => Schedule::paced(config, source.packets.iter().map(|packet| &packet.0)),
        Source::Line(script) => Schedule::scripted(script),
    })
}

/// What the segment engine runs, if segments run the scenario.
fn segments(checked: &Checked, plans: &[AxisPlan]) -> Result<Option<CheckedSegments>, Vec<Problem>> {
    let config = &checked.config;
    match &checked.source {
        Source::Motion(_) if checked.source.runs_segments() => {
            exact_segments(plans, config.channels(), PulseTimes::from(config), config.clock_hz()).map(Some)
        }
        _ => Ok(checked.segments.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;

    fn paths(json: &str) -> Vec<String> {
        Experiment::from_json(json)
            .err()
            .unwrap_or_default()
            .into_iter()
            .map(|problem| problem.path)
            .collect()
    }

    #[test]
    fn problems_of_types_and_numbers_come_together_and_none_is_invented() {
        let rows: &[(&str, &[&str])] = &[
            ("{}", &[]),
            // Too slow a line does not hide too fast a motion.
            (
                r#"{"line":{"baud":1200},"source":{"motion":{"axes":[{"moves":[{"constant":{"speed":{"steps_s":100000}}}]}]}}}"#,
                &["line.baud", "source.motion.axes[0]"],
            ),
            // Packets of two bytes are not judged by the default of a field that cannot be read.
            (
                r#"{"bus":{"channels":"2"},"source":{"packets":{"packets":["8001","0180"]}}}"#,
                &["bus.channels"],
            ),
            // Entries that cannot be read do not move the others.
            (
                r#"{"source":{"motion":{"axes":[{"moves":["bad",{"dwell":{"duration_s":-1}}]}]}}}"#,
                &["source.motion.axes[0].moves[0]", "source.motion.axes[0].moves[1].dwell.duration_s"],
            ),
            (r#"{"bus":{"slots":200},"title":5,"clock_hz":3}"#, &["title", "clock_hz", "bus.slots"]),
        ];
        for (json, expected) in rows {
            assert_eq!(paths(json), *expected, "{json}");
        }
    }

    #[test]
    fn many_entries_of_the_wrong_type_are_judged_in_few_readings() {
        let json = alloc::format!(
            r#"{{"source":{{"motion":{{"axes":[{{"moves":[{}5]}}]}}}}}}"#,
            "{},".repeat(11_000)
        );
        assert!(paths(&json).len() <= 101);
        let json =
            alloc::format!(r#"{{"source":{{"packets":{{"packets":[{}""]}}}}}}"#, "\"\",".repeat(20_000));
        assert!(paths(&json).len() <= 101);
    }

    #[test]
    fn a_scripted_runs_end_counts_the_ticks_that_wait() {
        let json = r#"{"source":{"line":{"sends":[{"bytes":"0505050505050505"}]}},"bus":{"boot_cycles":0}}"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let run = experiment.run(&mut Vec::new());
        assert!(run.cycles().0 > 8 * 32_000);
        assert!(run.cycles().0 <= experiment.cost().end_cycle);
    }
}
