//! `stepscope steps`, `curve` and `spectrum`: an axis as columns of numbers, for other programs.

mod columns;

use crate::failure::{Failure, Numbered};
use crate::options::Out;
use crate::quantity::whole;
use crate::{output, run_recording, scenarios};
use clap::{Args, ValueEnum};
use columns::{Columns, Format, Values};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stepscope_core::inspect::motion::{actual_motion::Pulses, spectra::Spectra};
use stepscope_core::motion::{AxisPlan, ScheduledStep};
use stepscope_core::peripheral::trace::{Step, steps as steps_of};
use stepscope_core::scenario::{Problem, Scenario, Source, ValueError};
use stepscope_core::sim::{Experiment, planned_steps};

#[derive(Args)]
struct Selection {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    scenario: PathBuf,
    /// Axis or channel, from 0
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = whole::<usize>(0..=u64::MAX))]
    axis: usize,
    /// Output format
    #[arg(long, value_enum, default_value = "csv")]
    format: Format,
    #[command(flatten)]
    out: Out,
}

#[derive(Args)]
pub(crate) struct StepsArguments {
    #[command(flatten)]
    selection: Selection,
    /// Write the steps of the plan, with cycles from the start of the motion
    ///
    /// By default these are the steps of the run, with cycles since reset.
    #[arg(long)]
    planned: bool,
}

#[derive(Args)]
pub(crate) struct CurveArguments {
    #[command(flatten)]
    selection: Selection,
    /// Number of points, evenly from 0 to the end of the motion, both included
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole::<u32>(2..=1_000_000))]
    points: u32,
}

#[derive(Args)]
pub(crate) struct SpectrumArguments {
    #[command(flatten)]
    selection: Selection,
    /// Motion to analyze
    #[arg(long, value_enum, default_value = "pulses")]
    of: Analyzed,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Analyzed {
    /// Actual pulses
    Pulses,
    /// Ideal curve
    Ideal,
}

impl Selection {
    fn validated(&self) -> Result<(Arc<Scenario>, Arc<Experiment>), Failure> {
        scenarios::validated(&self.scenario)
    }

    fn path(&self) -> &Path {
        &self.scenario
    }

    fn plan<'e>(&self, scenario: &Scenario, experiment: &'e Experiment) -> Result<&'e AxisPlan, Failure> {
        if !matches!(scenario.source, Source::Motion(_)) {
            let detail =
                "only a motion has a plan; use a source of kind motion, or stepscope steps without --planned";
            let problem = Problem::new("source", ValueError::Conflict { detail });
            return Err(Failure::Scenario(self.scenario.clone(), problem.into()));
        }
        let plans = experiment.plans();
        let missing = || Failure::index(self.path(), Numbered::Axes, self.axis, plans.len(), false);
        plans.get(self.axis).ok_or_else(missing)
    }

    fn channel(&self, experiment: &Experiment) -> Result<u8, Failure> {
        let channels = experiment.config().channels();
        let own = u8::try_from(self.axis).ok().filter(|channel| *channel < channels);
        let missing =
            || Failure::index(self.path(), Numbered::AxisChannels, self.axis, channels.into(), false);
        own.ok_or_else(missing)
    }

    fn write(&self, columns: &Columns) -> Result<(), Failure> {
        output::write_new(&self.out.out, |out| columns.write(self.format, out))
    }
}

pub(crate) fn steps(arguments: &StepsArguments) -> Result<(), Failure> {
    let selection = &arguments.selection;
    let (scenario, experiment) = selection.validated()?;
    let clock_hz = experiment.config().clock_hz();
    let steps: Vec<ScheduledStep> = if arguments.planned {
        let steps = planned_steps(selection.plan(&scenario, &experiment)?, clock_hz);
        steps.map_err(|problems| Failure::Scenario(selection.scenario.clone(), problems))?
    } else {
        let channel = selection.channel(&experiment)?;
        let recording = run_recording::of(selection.path(), &experiment)?;
        let steps = steps_of(&recording.trace, channel);
        let right = |index| Step::direction(&steps, index) > 0;
        let scheduled =
            |(index, step): (usize, &Step)| ScheduledStep { cycle: step.cycle, right: right(index) };
        steps.iter().enumerate().map(scheduled).collect()
    };
    let direction = |step: &ScheduledStep| if step.right { 1 } else { -1 };
    let time_s = |step: &ScheduledStep| step.cycle as f64 / f64::from(clock_hz);
    selection.write(&Columns {
        facts: vec![("axis", json!(selection.axis)), ("clock_hz", json!(clock_hz))],
        columns: vec![
            ("cycle", Values::Cycles(steps.iter().map(|step| step.cycle).collect())),
            ("time_s", Values::Numbers(steps.iter().map(time_s).collect())),
            ("direction", Values::Directions(steps.iter().map(direction).collect())),
        ],
    })
}

pub(crate) fn curve(arguments: &CurveArguments) -> Result<(), Failure> {
    let selection = &arguments.selection;
    let (scenario, experiment) = selection.validated()?;
    let plan = selection.plan(&scenario, &experiment)?;
    let last = f64::from(arguments.points - 1);
    let times: Vec<f64> =
        (0..arguments.points).map(|point| plan.duration_s() * f64::from(point) / last).collect();
    let sampled = |quantity: fn(&AxisPlan, f64) -> f64| {
        Values::Numbers(times.iter().map(|&time_s| quantity(plan, time_s)).collect())
    };
    selection.write(&Columns {
        facts: vec![("axis", json!(selection.axis))],
        columns: vec![
            ("time_s", Values::Numbers(times.clone())),
            ("position", sampled(AxisPlan::position)),
            ("speed", sampled(AxisPlan::speed)),
            ("acceleration", sampled(AxisPlan::acceleration)),
        ],
    })
}

pub(crate) fn spectrum(arguments: &SpectrumArguments) -> Result<(), Failure> {
    let selection = &arguments.selection;
    let (scenario, experiment) = selection.validated()?;
    let is_motion = matches!(scenario.source, Source::Motion(_));
    let plan = if is_motion || arguments.of == Analyzed::Ideal {
        Some(selection.plan(&scenario, &experiment)?)
    } else {
        None
    };
    let channel = selection.channel(&experiment)?;
    let recording = run_recording::of(selection.path(), &experiment)?;
    let steps = steps_of(&recording.trace, channel);
    let clock_hz = experiment.config().clock_hz();
    let pulses = match plan {
        Some(_) => {
            let segments = experiment.segments().and_then(|lists| lists.lists().get(selection.axis));
            Pulses::of_run(channel, &steps, &recording.packets, segments, experiment.config())
        }
        None => Pulses::recorded(channel, &steps, clock_hz),
    };
    let spectra = Spectra::of(&scenario, plan, &pulses);
    let spectrum = match arguments.of {
        Analyzed::Pulses => spectra.actual,
        Analyzed::Ideal => spectra.ideal,
    };
    let spectrum = spectrum.ok_or_else(|| {
        let why = "the axis has no spectrum, because it does not move; use another --axis";
        Failure::invalid(selection.path(), why)
    })?;
    let window = &spectrum.window;
    let fundamental_hz = window.fundamental_hz();
    let frequencies = (1..=spectrum.order).map(|harmonic| f64::from(harmonic) * fundamental_hz).collect();
    selection.write(&Columns {
        facts: vec![
            ("axis", json!(selection.axis)),
            ("position_thd", json!(spectrum.position.distortion)),
            ("speed_thd", json!(spectrum.speed.distortion)),
            ("acceleration_thd", json!(spectrum.acceleration.distortion)),
            ("start_s", json!(window.start_s)),
            ("period_s", json!(window.period_s)),
            ("periods", json!(window.periods)),
        ],
        columns: vec![
            ("frequency_hz", Values::Numbers(frequencies)),
            ("position", Values::Numbers(spectrum.position.amplitudes)),
            ("speed", Values::Numbers(spectrum.speed.amplitudes)),
            ("acceleration", Values::Numbers(spectrum.acceleration.amplitudes)),
        ],
    })
}
