//! A validated scenario and its runs.

use crate::controller_plan::{self, ControllerPlan};
use crate::controllers::{Controllers, Generator};
use crate::hosts::framed_host::{Conversation, Progress};
use crate::plant::attached::AttachedPlants;
use crate::{cost::Cost, line::bus::Bus, run::Run};
use alloc::{boxed::Box, sync::Arc, vec::Vec};
use core::slice;
use stepscope_controller::StandAlone;
use stepscope_motion::AxisPlan;
use stepscope_peripheral::device::{Device, SegmentEngine};
use stepscope_peripheral::signal::{MAX_CHANNELS, Sink, Unpaused};
use stepscope_peripheral::wire::{Line, Schedule};
use stepscope_peripheral::{config::Config, segment::CheckedSegments, units::Instant};
use stepscope_scenario::{CheckedScenario, END_OF_TIME, Problem, Problems, Scenario, ValueError};

const MAX_TICKS: u64 = 2_000_000;
/// The address, and one byte per channel.
const MAX_PACKET_BYTES: u64 = 1 + MAX_CHANNELS as u64;
/// Maximum bytes that a host may have to send.
const MAX_LINE_BYTES: u64 = MAX_TICKS * MAX_PACKET_BYTES;
/// Maximum grid steps of a run, multiplied by the number of motors.
const MAX_MOTOR_GRID_STEPS: u64 = 10_000_000_000;

/// A validated scenario with planned motions and encoded packets.
///
/// ```
/// use stepscope_peripheral::signal::Record;
/// use stepscope_sim::Experiment;
///
/// let experiment = Experiment::from_json(r#"{ "source": { "packets": { "packets": ["83", "02"] } } }"#)?;
/// let mut trace: Vec<Record> = Vec::new(); // or your own `Sink`
/// let run = experiment.run(&mut trace);
/// assert_eq!(run.positions()[0], 3 - 2);
///
/// let problems = Experiment::from_json(r#"{ "bus": { "slots": 0 } }"#).unwrap_err();
/// assert_eq!(problems[0].path, "bus.slots");
/// # Ok::<(), stepscope_scenario::Problems>(())
/// ```
#[derive(Clone, Debug)]
pub struct Experiment {
    checked: CheckedScenario,
    /// Never empty. The scenario's own controller is first.
    controllers: Vec<ControllerPlan>,
    /// What the host sends without waiting for replies.
    schedule: Arc<Schedule>,
    /// The segment lists, if segments generate the steps. The host sends nothing in that case.
    segments: Option<Arc<CheckedSegments>>,
    line_load: Option<f64>,
    cost: Cost,
}

/// A scenario with valid fields, a plan per controller, and the load of the line.
type Validated = (CheckedScenario, Vec<ControllerPlan>, Option<f64>);

/// Errors: the problems of all fields and motions. The line is only checked if all fields are valid; ticks also need valid
/// motions.
fn validate(scenario: &Scenario) -> Result<Validated, Problems> {
    let plans = controller_plan::plans(scenario);
    let checked = match scenario.check() {
        Ok(checked) => checked,
        Err(problems) => return Err(problems.with(plans.err())),
    };
    let line_load = controller_plan::line_load(&checked).map_err(Problems::from);
    let controllers = match plans {
        Ok(plans) => controller_plan::controller_plans(&checked, plans),
        Err(problems) => return Err(problems.with(line_load.err())),
    };
    let line_load = match line_load {
        Ok(line_load) => line_load,
        Err(problems) => return Err(problems.with(controllers.err())),
    };
    let controllers = controllers?;
    debug_assert!(!controllers.is_empty() && controllers.len() == checked.configs.len());
    Ok((checked, controllers, line_load))
}

fn check_cost(path: &'static str, given: u64, max: u64, of: &'static str) -> Result<(), Problems> {
    if given <= max {
        return Ok(());
    }
    let cause = ValueError::TooMuch { given: given as f64, max: max as f64, of };
    Err(Problem::new(path, cause).into())
}

/// Whether the field at `path` is the one at `parent` or a part of it.
fn is_within(path: &str, parent: &str) -> bool {
    path.strip_prefix(parent).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
}

impl Experiment {
    /// Validates a scenario and prepares its run. Errors: every problem, each with its path.
    pub fn new(scenario: &Scenario) -> Result<Self, Problems> {
        let (mut checked, controllers, line_load) = validate(scenario)?;
        let (schedule, forced) = controller_plan::schedule(&checked, &controllers);
        checked.forced.extend(forced);
        let segments = controller_plan::segments(&checked, &controllers)?.map(Arc::new);
        let cost = match (&checked.stand_alone, &segments) {
            (Some(stand_alone), _) => Cost::of_stand_alone(stand_alone, checked.run)?,
            (None, Some(segments)) => Cost::of_segments(segments, checked.run),
            (None, None) => Cost::of(&checked, &controllers, &schedule),
        };
        let cost = cost.with_plants(&checked);
        check_cost("source", cost.bytes, MAX_LINE_BYTES, "bytes of all frames and their repetitions")?;
        let grid_steps = cost.motor_grid_steps;
        check_cost("plant.step_cycles", grid_steps, MAX_MOTOR_GRID_STEPS, "grid steps of all motors")?;
        check_cost("source", cost.end_cycle, END_OF_TIME, "cycles")?;
        let line_load = line_load.filter(|_| controllers.iter().any(ControllerPlan::has_ticks));
        Ok(Self { checked, controllers, schedule: Arc::new(schedule), segments, line_load, cost })
    }

    /// Reads, validates and prepares a scenario. Errors: every problem of types and numbers.
    pub fn from_json(text: &str) -> Result<Self, Problems> {
        let (scenario, unreadable) = Scenario::from_json_lenient(text);
        Self::from_partial(&scenario, unreadable)
    }

    /// Validates a scenario. If there are `unreadable` fields, they have their defaults, so rules about several fields are
    /// skipped. Errors: `unreadable` and all other problems.
    pub fn from_partial(scenario: &Scenario, unreadable: Option<Problems>) -> Result<Self, Problems> {
        let validated = Self::new(scenario);
        let Some(unreadable) = unreadable else { return validated };
        let others = validated.err().into_iter().flatten().filter(|problem| {
            !problem.cause.depends_on_several_fields()
                && !unreadable.iter().any(|bad| is_within(&problem.path, &bad.path))
        });
        let others = Problems::new(others.collect());
        Err(unreadable.with(others))
    }

    /// Number of controllers on the line, 1 to 32.
    pub fn controllers(&self) -> usize {
        self.controllers.len()
    }

    /// The configuration of the first controller.
    pub fn config(&self) -> &Config {
        self.first().config()
    }

    pub fn configs(&self) -> impl ExactSizeIterator<Item = &Config> {
        self.controllers.iter().map(ControllerPlan::config)
    }

    /// The host's bit rate.
    pub const fn baud(&self) -> u32 {
        self.checked.baud
    }

    /// The plan of each axis of the first controller; empty where the source is no motion.
    pub fn plans(&self) -> &[AxisPlan] {
        self.first().plans()
    }

    /// The plan of each axis of controller `index`.
    pub fn plans_of(&self, index: usize) -> &[AxisPlan] {
        self.controllers.get(index).map_or(&[], ControllerPlan::plans)
    }

    /// The ticks of controller `index`, one byte per channel, tick after tick; empty for a line script.
    pub fn ticks_of(&self, index: usize) -> &[u8] {
        self.controllers.get(index).map_or(&[], ControllerPlan::ticks)
    }

    /// The host's progress with controller `index`; `None` without ticks or if the host does not wait for replies.
    pub fn host_progress(&self, run: &Run, index: usize) -> Option<Progress> {
        run.host()?.conversation().progress().nth(self.job_index(index)?)
    }

    /// Ticks acknowledged by controller `index`; `None` as [`Self::host_progress`].
    pub fn host_acknowledged(&self, run: &Run, index: usize) -> Option<u32> {
        run.host()?.conversation().acknowledged().nth(self.job_index(index)?)
    }

    /// The host's conversation for a real line from cycle `start` on, with an opening tick; `None` on a raw line.
    pub fn conversation(&self, start: Instant) -> Option<Conversation> {
        let bit = Config::bit_of(self.config().clock_hz(), self.baud());
        let waits = self.checked.waits_for_replies();
        let jobs = || controller_plan::jobs(&self.controllers);
        waits.then(|| Conversation::new(jobs(), &self.checked.host, bit, start).with_opening_tick())
    }

    /// Position of controller `index` among those with ticks: the index of its job in the host. `None` without ticks.
    pub fn job_index(&self, index: usize) -> Option<usize> {
        self.controllers.get(index).filter(|plan| plan.has_ticks())?;
        Some(self.controllers.iter().take(index).filter(|plan| plan.has_ticks()).count())
    }

    fn first(&self) -> &ControllerPlan {
        &self.controllers[0]
    }

    /// The sends of a host that does not wait for replies; for a framed host see [`Run::schedule`].
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// The segment lists; `None` where ticks run the scenario.
    pub fn segments(&self) -> Option<&CheckedSegments> {
        self.segments.as_deref()
    }

    /// Whether a run never ends because a jog button of a stand-alone controller stays pressed.
    pub fn jogs_without_end(&self) -> bool {
        let has_end = self.checked.run.is_some() || self.cost.end_cycle < END_OF_TIME;
        !has_end && self.stand_alone().is_some_and(crate::stand_alone::jogs_without_end)
    }

    /// Fails if a run never ends.
    ///
    /// # Errors
    /// A jog button of a stand-alone controller stays pressed.
    pub fn check_has_end(&self) -> Result<(), Problems> {
        if !self.jogs_without_end() {
            return Ok(());
        }
        let detail = "a jog button stays pressed, so the run has no end; set run_cycles, or release the button in inputs";
        Err(Problem::new("run_cycles", ValueError::Conflict { detail }).into())
    }

    /// The stand-alone controllers; `None` with another source.
    pub const fn stand_alone(&self) -> Option<&stepscope_controller::CheckedSetup> {
        self.checked.stand_alone.as_ref()
    }

    fn generator(&self) -> Generator {
        if let Some(checked) = &self.checked.stand_alone {
            return Generator::StandAlone(StandAlone::new(checked));
        }
        match &self.segments {
            Some(lists) => Generator::Segments(Box::new(SegmentEngine::new(Arc::clone(lists)))),
            None => Generator::Bus,
        }
    }

    /// The maximum cost of a run.
    pub const fn cost(&self) -> Cost {
        self.cost
    }

    /// The line's load while all controllers move, 0..=1; `None` without paced packets.
    pub const fn line_load(&self) -> Option<f64> {
        self.line_load
    }

    /// Starts a run: it is before cycle 0.
    pub fn start(&self) -> Run {
        let CheckedScenario { baud, forced, run, .. } = &self.checked;
        let clock_hz = self.config().clock_hz();
        let line = Line::new(Arc::clone(&self.schedule), forced, clock_hz, *baud);
        let waits = self.checked.waits_for_replies();
        let host = waits.then(|| controller_plan::framed_host(&self.checked, &self.controllers));
        Run {
            controllers: Controllers {
                bus: Bus::new(line, host, self.configs().map(|config| self.device(config)).collect()),
                generator: self.generator(),
                end: run.map(|cycles| Instant(cycles.0)),
            },
            plants: self.plants().map(|plants| Box::new(AttachedPlants::new(plants, self.configs()))),
        }
    }

    fn device(&self, config: &Config) -> Device {
        let tests = self.checked.plants.as_ref().is_some_and(|plants| plants.self_test);
        if tests { Device::with_self_test(config) } else { Device::new(config) }
    }

    /// The plants of the controllers.
    pub const fn plants(&self) -> Option<&stepscope_scenario::Plants> {
        self.checked.plants.as_ref()
    }

    /// Runs to the end; `sink` receives the trace of the first controller.
    pub fn run(&self, sink: &mut impl Sink) -> Run {
        self.run_each(slice::from_mut(sink))
    }

    /// As [`Self::run`], with a sink per controller; controllers without a sink run too.
    pub fn run_each(&self, sinks: &mut [impl Sink]) -> Run {
        let mut run = self.start();
        let mut sinks: Vec<_> = sinks.iter_mut().map(Unpaused).collect();
        run.run_to(run.controllers.end.unwrap_or(Instant::NEVER), &mut sinks);
        debug_assert!(run.is_done());
        run
    }

    /// Runs to the end clock by clock. It is slow, and the reference for [`Self::run`].
    pub fn run_clock_by_clock(&self, sink: &mut impl Sink) -> Run {
        self.run_each_clock_by_clock(slice::from_mut(sink))
    }

    /// As [`Self::run_each`], clock by clock.
    pub fn run_each_clock_by_clock(&self, sinks: &mut [impl Sink]) -> Run {
        let mut run = self.start();
        while !run.is_done() {
            run.clock(sinks);
        }
        run
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;
    use stepscope_peripheral::signal::Record;

    fn paths(json: &str) -> Vec<String> {
        Experiment::from_json(json).err().into_iter().flatten().map(|problem| problem.path).collect()
    }

    #[test]
    fn problems_of_types_and_numbers_are_reported_together() {
        let rows: &[(&str, &[&str])] = &[
            ("{}", &[]),
            // The problems of the line and of the motion are both reported.
            (
                r#"{"line":{"baud":1200},"source":{"motion":{"axes":[{"moves":[{"constant":{"speed":{"steps_s":100000}}}]}]}}}"#,
                &["line.baud", "source.motion.axes[0]"],
            ),
            // An unreadable `channels` must not cause errors in the packets.
            (
                r#"{"bus":{"channels":"2"},"source":{"packets":{"packets":["8001","0180"]}}}"#,
                &["bus.channels"],
            ),
            // An unreadable entry keeps its index.
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
    fn only_parts_of_an_unreadable_field_are_within_it() {
        for (path, expected) in
            [("line.host", true), ("line.host.a", true), ("line.host[0]", true), ("line.host_x", false)]
        {
            assert_eq!(is_within(path, "line.host"), expected, "{path}");
        }
    }

    #[test]
    fn the_number_of_type_errors_is_limited() {
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
    fn a_whole_run_ignores_pauses_of_its_sink() {
        #[derive(Default)]
        struct Pausing(Vec<Record>);

        impl Sink for Pausing {
            fn record(&mut self, record: Record) {
                self.0.push(record);
            }

            fn is_paused(&self) -> bool {
                self.0.len() >= 50
            }
        }

        let experiment = Experiment::from_json("{}").expect("no problems");
        let (mut pausing, mut all) = (Pausing::default(), Vec::new());
        assert_eq!(experiment.run(&mut pausing).cycles(), experiment.run(&mut all).cycles());
        assert!(pausing.0 == all && all.len() > 50, "{} records", all.len());
    }

    #[test]
    fn a_scripted_runs_end_counts_the_ticks_that_wait() {
        let json =
            r#"{"source":{"line":{"sends":[{"bytes":"0505050505050505"}]}},"bus":{"self_test_cycles":0}}"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let run = experiment.run(&mut Vec::new());
        assert!(run.cycles().0 > 8 * 32_000);
        assert!(run.cycles().0 <= experiment.cost().end_cycle);
    }
}
