//! The axes whose steps become tables.

use super::options::{Arguments, FormName, Search};
use crate::failure::Failure;
use crate::{run_recording, scenarios, steps::steps_of_table};
use std::path::{Path, PathBuf};
use stepscope_core::{
    inspect::export::step_tables::{scheduled, tolerance_cycles},
    motion::{
        AxisPlan, Cause, ScheduledStep, plan_lists,
        step_tables::{EntryFormat, Form, Stored, Tolerance, stored, stored_steps},
    },
    peripheral::{config::Config, segment::PulseTimes, trace::steps},
    scenario::{Motion, Problem, Scenario, Source as ScenarioSource, ValueError, of_config, of_motion},
    sim::Experiment,
};

pub(super) struct Axes {
    pub(super) path: PathBuf,
    pub(super) scenario: Scenario,
    /// The text of `--steps`.
    pub(super) listed: Option<String>,
    pub(super) clock_hz: u32,
    pub(super) pulse: PulseTimes,
    pub(super) axes: Vec<Steps>,
    pub(super) tolerance: Tolerance,
    pub(super) search: Search,
}

pub(super) enum Steps {
    Planned(AxisPlan),
    Listed(Vec<ScheduledStep>),
}

/// What gives the steps.
enum StepSource<'a> {
    List(&'a Path),
    Motion(&'a Motion),
    Run(Vec<Vec<ScheduledStep>>),
}

impl Axes {
    pub(super) fn new(arguments: &Arguments) -> Result<Self, Failure> {
        let scenario = arguments.scenario.as_deref().map(scenarios::read).transpose()?.unwrap_or_default();
        let path = arguments.scenario.clone().unwrap_or_else(|| PathBuf::from(scenarios::DEFAULT));
        let wrong = |problems| Failure::Scenario(path.clone(), problems);
        let source = match (&arguments.steps, &scenario.source) {
            (Some(list), _) => StepSource::List(list),
            (None, ScenarioSource::Motion(motion)) => StepSource::Motion(motion),
            // Runs first: it checks the whole scenario, of which the bus is a part.
            (None, _) => StepSource::Run(steps_of_run(&path, &scenario)?),
        };
        let clock_hz = scenario.clock_hz;
        let config = Config::of_segments(clock_hz, &scenario.bus, &scenario.line.serial());
        let pulse = PulseTimes::from(&config.map_err(of_config).map_err(wrong)?);
        let cycles = tolerance_cycles(arguments.error_us(), clock_hz);
        let (interval_part, search) = (arguments.interval_part, arguments.search.unwrap_or_default());
        let tolerance =
            Tolerance { cycles, interval_part, side: arguments.window.unwrap_or_default().side() };
        let (path, listed, axes) = match source {
            StepSource::List(list) => {
                let text = scenarios::text(list)?;
                let steps = steps_of_table(&text, clock_hz);
                let steps = steps.map_err(|why| Failure::Invalid(list.to_owned(), why))?;
                (list.to_owned(), Some(text), vec![Steps::Listed(steps)])
            }
            StepSource::Motion(motion) => {
                let plans = plan_lists([motion.axis_list()]).map_err(of_motion).map_err(wrong)?;
                (path, None, plans.into_iter().flatten().map(Steps::Planned).collect())
            }
            StepSource::Run(steps) => (path, None, steps.into_iter().map(Steps::Listed).collect()),
        };
        Ok(Self { path, scenario, listed, clock_hz, pulse, axes, tolerance, search })
    }

    pub(super) fn stored(&self, steps: &Steps, form: FormName, format: EntryFormat) -> Result<Stored, Cause> {
        let form = match (form, self.search) {
            (FormName::Exact, _) => Form::Exact,
            (FormName::Document, _) => Form::Document,
            (FormName::Compressed, Search::Fewest) => Form::Compressed(self.tolerance),
            (FormName::Compressed, Search::Quick) => Form::Quick(self.tolerance),
        };
        match steps {
            Steps::Planned(plan) => stored(plan, form, format, self.pulse, self.clock_hz),
            Steps::Listed(steps) => stored_steps(steps, form, format, self.pulse),
        }
    }

    pub(super) fn failure(&self, axis: usize, cause: Cause) -> Failure {
        if let Some(Steps::Listed(_)) = self.axes.get(axis) {
            return Failure::Invalid(self.path.clone(), cause.to_string());
        }
        let problem = Problem::new(format!("source.motion.axes[{axis}]"), cause);
        Failure::Scenario(self.path.clone(), problem.into())
    }
}

/// Steps of the scenario's run from cycle 1, for each channel up to the last one with steps.
fn steps_of_run(path: &Path, scenario: &Scenario) -> Result<Vec<Vec<ScheduledStep>>, Failure> {
    let wrong = |problems| Failure::Scenario(path.to_owned(), problems);
    let experiment = Experiment::new(scenario).map_err(wrong)?;
    let recording = run_recording::of(path, &experiment)?;
    let of = |channel| scheduled(&steps(&recording.trace, channel));
    let mut all: Vec<_> = (0..experiment.config().channels()).map(of).collect();
    while all.last().is_some_and(Vec::is_empty) {
        all.pop();
    }
    if all.is_empty() {
        let detail = "no channel has steps, so there is no table; use a scenario with steps, or --steps";
        return Err(wrong(Problem::new("source", ValueError::Conflict { detail }).into()));
    }
    Ok(all)
}
