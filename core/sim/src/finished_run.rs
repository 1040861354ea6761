//! A scenario's run from reset to its end, with every edge, in one call: [`run`]; and the plan's [`step_times`].
//!
//! ```
//! let scenario: stepscope_scenario::Scenario = r#"{ "bus": { "channels": 2 } }"#.parse()?;
//! let run = stepscope_sim::run(&scenario)?;
//! assert_eq!(run.positions(), [3200, 0]);
//! assert_eq!(run.steps(0).len(), stepscope_sim::step_times(&scenario, 0)?.len());
//! # Ok::<(), stepscope_scenario::Problems>(())
//! ```

use crate::summary::{ControllerSummary, Summary};
use crate::{Experiment, Run};
use alloc::vec::Vec;
use core::ops::Deref;
use stepscope_motion::{AxisPlan, ScheduledStep};
use stepscope_peripheral::device::Faults;
use stepscope_peripheral::signal::{Record, Sink};
use stepscope_peripheral::trace::{Digest, Step, steps};
use stepscope_scenario::{Problem, Problems, Scenario, Source, ValueError};

/// Maximum edges of all controllers of a stored run, at 16 bytes each. A step has two.
pub const MAX_RECORDS: u64 = 48_000_000;
/// Edges between two checks of that maximum.
const RECORDS_PER_CHECK: u64 = 1 << 16;

/// A run that has ended, with every edge. It dereferences to the run of its first controller.
#[derive(Clone, Debug)]
pub struct FinishedRun {
    /// Never empty.
    controllers: Vec<ControllerRun>,
    summary: Summary,
}

/// The edges of one controller, and its state at the end.
#[derive(Clone, Debug)]
pub struct ControllerRun {
    trace: Vec<Record>,
    summary: ControllerSummary,
}

/// Runs a scenario to its end and stores every edge of every controller.
///
/// # Errors
/// All problems of the scenario, a run without an end, and more than [`MAX_RECORDS`] edges.
pub fn run(scenario: &Scenario) -> Result<FinishedRun, Problems> {
    run_within(&Experiment::new(scenario)?, MAX_RECORDS)
}

/// The steps of an axis as planned, with cycles of the scenario's clock from the start of the motion. `axis` counts from 0.
///
/// # Errors
/// All problems of the scenario, a source without planned axes, an axis that does not exist, and too many steps for
/// [`planned_steps`].
pub fn step_times(scenario: &Scenario, axis: usize) -> Result<Vec<ScheduledStep>, Problems> {
    let experiment = Experiment::new(scenario)?;
    let plans = experiment.plans();
    let Some(last) = plans.len().checked_sub(1).filter(|_| matches!(scenario.source, Source::Motion(_)))
    else {
        let detail = "only a motion has planned steps; use a source of kind motion, or the steps of a run";
        return Err(Problem::new("source", ValueError::Conflict { detail }).into());
    };
    let plan = plans.get(axis).ok_or_else(|| {
        let cause = ValueError::Range { given: axis as f64, min: 0.0, max: last as f64, unit: "" };
        Problem::new("axis", cause)
    })?;
    planned_steps(plan, scenario.clock_hz)
}

/// The steps of a plan, in cycles at `clock_hz` from the start of the motion.
///
/// # Errors
/// More steps than a stored run may have: half of [`MAX_RECORDS`].
pub fn planned_steps(plan: &AxisPlan, clock_hz: u32) -> Result<Vec<ScheduledStep>, Problems> {
    if plan.step_count() > MAX_RECORDS / 2 {
        let detail = "the axis has more than 24000000 planned steps; use a shorter motion";
        return Err(Problem::new("source", ValueError::Conflict { detail }).into());
    }
    Ok(plan.due_steps(clock_hz).collect())
}

fn run_within(experiment: &Experiment, max_records: u64) -> Result<FinishedRun, Problems> {
    experiment.check_has_end()?;
    // Segments have a known number of steps; other edges are counted during the run.
    let steps = experiment.segments().map(|segments| segments.steps());
    if steps.is_some_and(|steps| steps > max_records / 2) {
        return Err(too_long());
    }
    let mut recordings: Vec<Recording> =
        (0..experiment.controllers()).map(|_| Recording::default()).collect();
    let mut run = experiment.start();
    while !run.advance_each(RECORDS_PER_CHECK, &mut recordings) {
        let records: u64 = recordings.iter().map(|recording| recording.digest.records()).sum();
        if records > max_records {
            return Err(too_long());
        }
    }
    Ok(FinishedRun::of(experiment, &run, recordings))
}

fn too_long() -> Problems {
    let detail =
        "the run has more than 48000000 edges; use a shorter motion, or an earlier end with run_cycles";
    Problem::new("source", ValueError::Conflict { detail }).into()
}

#[derive(Default)]
struct Recording {
    trace: Vec<Record>,
    digest: Digest,
}

impl Sink for Recording {
    fn record(&mut self, record: Record) {
        self.trace.push(record);
        self.digest.record(record);
    }
}

impl FinishedRun {
    fn of(experiment: &Experiment, run: &Run, recordings: Vec<Recording>) -> Self {
        let summary = Summary::new(experiment, run, recordings.iter().map(|recording| &recording.digest));
        let traces = recordings.into_iter().map(|recording| recording.trace);
        let controllers = traces.zip(&summary.controllers);
        let controllers =
            controllers.map(|(trace, summary)| ControllerRun { trace, summary: summary.clone() });
        Self { controllers: controllers.collect(), summary }
    }

    /// The controllers in the order of the scenario, at least one.
    pub fn controllers(&self) -> &[ControllerRun] {
        &self.controllers
    }

    /// The summary that the command prints.
    pub const fn summary(&self) -> &Summary {
        &self.summary
    }
}

impl Deref for FinishedRun {
    type Target = ControllerRun;

    fn deref(&self) -> &ControllerRun {
        &self.controllers[0]
    }
}

impl ControllerRun {
    /// The digest of all edges; print it with `{:016x}`.
    pub const fn digest(&self) -> u64 {
        self.summary.digest
    }

    /// Every edge: a cycle, and the levels from then on.
    pub fn trace(&self) -> &[Record] {
        &self.trace
    }

    /// The steps of a channel, with cycles since reset. `channel` counts from 0; unused channels have no steps.
    pub fn steps(&self, channel: u8) -> Vec<Step> {
        if channel < self.summary.channels { steps(&self.trace, channel) } else { Vec::new() }
    }

    /// Positions of the channels in use, in steps since reset.
    pub fn positions(&self) -> &[i32] {
        &self.summary.positions
    }

    /// Faults at the end.
    pub const fn faults(&self) -> Faults {
        self.summary.faults
    }

    /// Ticks that have ended.
    pub const fn ticks_done(&self) -> u32 {
        self.summary.ticks_done
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{string::ToString, vec};

    fn scenario(json: &str) -> Scenario {
        json.parse().expect(json)
    }

    #[test]
    fn a_finished_run_has_the_edges_of_an_experiment() {
        let json = r#"{"line":{"protocol":"framed","address":1},"controllers":[{"address":2,"axes":[{}]}]}"#;
        let found = run(&scenario(json)).expect("it runs");
        let experiment = Experiment::from_json(json).expect("it runs");
        let mut expected = vec![Vec::<Record>::new(); 2];
        experiment.run_each(&mut expected);
        assert_eq!(found.controllers().len(), 2);
        for (controller, trace) in found.controllers().iter().zip(&expected) {
            assert!(controller.trace() == trace);
            assert_eq!(controller.digest(), Digest::of(trace));
            assert_eq!((controller.positions(), controller.steps(0).len()), (&[3200][..], 3200));
            assert!(controller.steps(1).is_empty());
            assert!(controller.ticks_done() > 0 && controller.faults() == Faults::default());
        }
        assert_eq!(found.digest(), found.summary().controllers[0].digest);
    }

    #[test]
    fn step_times_are_those_of_the_plan() {
        let scenario =
            scenario(r#"{"bus":{"channels":2},"source":{"motion":{"axes":[{},{"moves":[{"dwell":{}}]}]}}}"#);
        let experiment = Experiment::new(&scenario).expect("it runs");
        let expected: Vec<_> = experiment.plans()[0].due_steps(16_000_000).collect();
        assert_eq!(step_times(&scenario, 0), Ok(expected));
        assert_eq!(step_times(&scenario, 1), Ok(Vec::new()));
    }

    #[test]
    fn refusals_name_what_is_wrong() {
        let check = |found: Option<Problems>, expected: &str| {
            assert_eq!(found.expect(expected).to_string(), expected);
        };
        check(run(&scenario(r#"{"bus":{"slots":0}}"#)).err(), "bus.slots: 0 is out of range; use 1 to 127");
        let jog = r#"{"source":{"standalone":[{"debounce_cycles":1000,"memory":{"byte_write_cycles":10,"hold_up_cycles":1000},
            "inputs":[{"cycle":320000,"input":"jog_plus"}]}]}}"#;
        let endless = "run_cycles: a jog button stays pressed, so the run has no end; set run_cycles, or release the button in inputs";
        check(run(&scenario(jog)).err(), endless);
        check(step_times(&scenario("{}"), 1).err(), "axis: 1 is out of range; use 0");
        check(
            step_times(&scenario(r#"{"source":{"packets":{"packets":["83"]}}}"#), 0).err(),
            "source: only a motion has planned steps; use a source of kind motion, or the steps of a run",
        );
    }

    #[test]
    fn the_number_of_planned_steps_is_limited() {
        let json = r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":24000001},"speed":{"steps_s":40000}}}]}]}}}"#;
        let expected = "source: the axis has more than 24000000 planned steps; use a shorter motion";
        assert_eq!(step_times(&scenario(json), 0).expect_err("too many").to_string(), expected);
        assert!(expected.contains(&(MAX_RECORDS / 2).to_string()));
    }

    #[test]
    fn the_number_of_stored_edges_is_limited() {
        let motion = Experiment::from_json(
            r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":200000},"speed":{"steps_s":20000}}}]}]}}}"#,
        );
        let motion = motion.expect("it runs");
        assert!(run_within(&motion, MAX_RECORDS).is_ok());
        assert_eq!(run_within(&motion, 100_000).err(), Some(too_long()));
        let segments = r#"{"source":{"segments":{"channels":[{"segments":[{"steps":{"count":1000}}]}]}}}"#;
        let segments = Experiment::from_json(segments).expect("it runs");
        assert!(run_within(&segments, 2000).is_ok());
        assert_eq!(run_within(&segments, 1999).err(), Some(too_long()));
        assert!(too_long().to_string().contains(&MAX_RECORDS.to_string()));
    }
}
