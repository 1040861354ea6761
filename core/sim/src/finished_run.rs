//! A scenario's run from reset to its end, with every edge, in one call: [`run`]; and the plan's [`step_times`].
//! [`run_watched`] reports progress, can be stopped, and can do without the edges.
//!
//! ```
//! let scenario: stepscope_scenario::Scenario = r#"{ "bus": { "channels": 2 } }"#.parse()?;
//! let run = stepscope_sim::run(&scenario)?;
//! assert_eq!(run.positions(), [3200, 0]);
//! assert_eq!(run.steps(0).len(), stepscope_sim::step_times(&scenario, 0)?.len());
//! # Ok::<(), stepscope_scenario::Problems>(())
//! ```

use crate::summary::{ControllerSummary, Summary};
use crate::{Experiment, Run, RunLimits};
use alloc::vec::Vec;
use core::ops::{ControlFlow, Deref};
use stepscope_motion::{AxisPlan, ScheduledStep};
use stepscope_peripheral::device::Faults;
use stepscope_peripheral::signal::{Record, Sink};
use stepscope_peripheral::trace::{Digest, Step, steps};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_scenario::{Problem, Problems, Scenario, ValueError};

/// Maximum edges of all controllers of a stored run, at 16 bytes each. A step has two.
pub const MAX_RECORDS: u64 = 48_000_000;
/// Edges between two checks of that maximum, and between two reports of progress.
const RECORDS_PER_CHECK: u64 = 1 << 16;
/// The same for a run with motors, whose cycles take time without edges, too.
const CYCLES_PER_CHECK: u64 = 1 << 20;

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
    let experiment = Experiment::new(scenario)?;
    // Nothing stops it.
    run_within(&experiment, Edges::Stored(MAX_RECORDS), |_| ControlFlow::Continue(()))?
        .ok_or_else(too_many_edges)
}

/// Runs an experiment to its end. Without `stores_edges` the traces are empty, and any number of edges is possible.
///
/// `on_progress` receives the number of cycles that were run: 0 first, then a new number from time to time, and all of them
/// at last. [`ControlFlow::Break`] stops the run, and the result is `None`.
///
/// # Errors
/// As [`run`].
pub fn run_watched(
    experiment: &Experiment,
    stores_edges: bool,
    on_progress: impl FnMut(Cycles) -> ControlFlow<()>,
) -> Result<Option<FinishedRun>, Problems> {
    let edges = if stores_edges { Edges::Stored(MAX_RECORDS) } else { Edges::Counted };
    run_within(experiment, edges, on_progress)
}

/// The steps of an axis as planned, with cycles of the scenario's clock from the start of the motion. `axis` counts from 0.
///
/// # Errors
/// All problems of the scenario, a source without planned axes, an axis that does not exist, and too many steps for
/// [`planned_steps`].
pub fn step_times(scenario: &Scenario, axis: usize) -> Result<Vec<ScheduledStep>, Problems> {
    let experiment = Experiment::new(scenario)?;
    planned_steps(axis_plan(&experiment, 0, axis)?, experiment.config().clock_hz())
}

/// The plan of an axis. `controller` and `axis` count from 0.
///
/// # Errors
/// A controller or an axis that does not exist, and a source without planned axes.
pub fn axis_plan(experiment: &Experiment, controller: usize, axis: usize) -> Result<&AxisPlan, Problems> {
    let out_of_range = |path, given: usize, last: usize| {
        let cause = ValueError::Range { given: given as f64, min: 0.0, max: last as f64, unit: "" };
        Problems::from(Problem::new(path, cause))
    };
    if controller >= experiment.controllers() {
        return Err(out_of_range("controller", controller, experiment.controllers().saturating_sub(1)));
    }
    let plans = experiment.plans_of(controller);
    let Some(last) = plans.len().checked_sub(1) else {
        let detail = "only a motion has planned steps; use a source of kind motion, or the steps of a run";
        return Err(Problem::new("source", ValueError::Conflict { detail }).into());
    };
    plans.get(axis).ok_or_else(|| out_of_range("axis", axis, last))
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

#[derive(Clone, Copy)]
enum Edges {
    /// At most so many, of all controllers.
    Stored(u64),
    Counted,
}

fn run_within(
    experiment: &Experiment,
    edges: Edges,
    mut on_progress: impl FnMut(Cycles) -> ControlFlow<()>,
) -> Result<Option<FinishedRun>, Problems> {
    experiment.check_has_end()?;
    let max_records = match edges {
        Edges::Stored(max_records) => max_records,
        Edges::Counted => u64::MAX,
    };
    // Segments have a known number of steps; other edges are counted during the run.
    let steps = experiment.segments().map(|segments| segments.steps());
    if steps.is_some_and(|steps| steps > max_records / 2) {
        return Err(too_many_edges());
    }
    let recording =
        || Recording { trace: matches!(edges, Edges::Stored(_)).then(Vec::new), digest: Digest::default() };
    let mut recordings: Vec<Recording> = (0..experiment.controllers()).map(|_| recording()).collect();
    let mut run = experiment.start();
    let mut limits = RunLimits { records: RECORDS_PER_CHECK, ..RunLimits::default() };
    loop {
        if on_progress(run.cycles()).is_break() {
            return Ok(None);
        }
        if run.is_done() {
            return Ok(Some(FinishedRun::of(experiment, &run, recordings)));
        }
        if experiment.plants().is_some() {
            limits.cycle = Instant(run.cycles().0.saturating_add(CYCLES_PER_CHECK));
        }
        let is_done = run.advance_observed::<_, ()>(limits, &mut recordings, &mut []);
        let records: u64 = recordings.iter().map(|recording| recording.digest.records()).sum();
        if records > max_records && !is_done {
            return Err(too_many_edges());
        }
    }
}

/// The problem of a run with more than [`MAX_RECORDS`] edges.
pub fn too_many_edges() -> Problems {
    let detail =
        "the run has more than 48000000 edges; use a shorter motion, or an earlier end with run_cycles";
    Problem::new("source", ValueError::Conflict { detail }).into()
}

struct Recording {
    trace: Option<Vec<Record>>,
    digest: Digest,
}

impl Sink for Recording {
    fn record(&mut self, record: Record) {
        self.trace.record(record);
        self.digest.record(record);
    }
}

impl FinishedRun {
    fn of(experiment: &Experiment, run: &Run, recordings: Vec<Recording>) -> Self {
        let summary = Summary::new(experiment, run, recordings.iter().map(|recording| &recording.digest));
        let traces = recordings.into_iter().map(|recording| recording.trace.unwrap_or_default());
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

    /// Every edge: a cycle, and the levels from then on. Empty if [`run_watched`] did not store them.
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

    fn stored(experiment: &Experiment, max_records: u64) -> Result<Option<FinishedRun>, Problems> {
        run_within(experiment, Edges::Stored(max_records), |_| ControlFlow::Continue(()))
    }

    #[test]
    fn progress_reports_rising_cycles_and_can_stop_the_run() {
        let long = r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":50000},"speed":{"steps_s":20000}}}]}]}}}"#;
        for json in ["{}", r#"{"plant":{}}"#, long] {
            let experiment = Experiment::from_json(json).expect("it runs");
            let expected = run(&scenario(json)).expect("it runs");
            for stores_edges in [true, false] {
                let mut reported = Vec::new();
                let found = run_watched(&experiment, stores_edges, |cycles| {
                    reported.push(cycles);
                    ControlFlow::Continue(())
                });
                let found = found.expect("it runs").expect("nothing stops it");
                assert_eq!(found.summary(), expected.summary());
                assert_eq!(found.trace().len(), if stores_edges { expected.trace().len() } else { 0 });
                assert!(reported.is_sorted() && (json == "{}" || reported.len() > 2), "{reported:?}");
                assert_eq!((reported[0], reported.last()), (Cycles(0), Some(&expected.summary().cycles)));
            }
            let mut calls = 0;
            let stopped = run_watched(&experiment, true, |_| {
                calls += 1;
                if calls == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            assert!(stopped.expect("it runs").is_none() && calls == 2);
        }
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
        let experiment = Experiment::from_json("{}").expect("it runs");
        check(axis_plan(&experiment, 1, 0).err(), "controller: 1 is out of range; use 0");
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
        assert!(stored(&motion, MAX_RECORDS).is_ok());
        assert_eq!(stored(&motion, 100_000).err(), Some(too_many_edges()));
        let segments = r#"{"source":{"segments":{"channels":[{"segments":[{"steps":{"count":1000}}]}]}}}"#;
        let segments = Experiment::from_json(segments).expect("it runs");
        assert!(stored(&segments, 2000).is_ok());
        assert_eq!(stored(&segments, 1999).err(), Some(too_many_edges()));
        assert!(too_many_edges().to_string().contains(&MAX_RECORDS.to_string()));
    }
}
