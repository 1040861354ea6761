//! `stepscope measures`: how good an axis of a run is, in numbers.

mod table;

use crate::{failure::Failure, scenarios};
use clap::{Args, ValueEnum};
use std::{
    io::{self, Write},
    path::PathBuf,
};
use stepscope_core::{
    inspect::{
        actual_motion::Pulses,
        measures::{Measures, within_bounds},
        spectrum::{AnalysisWindow, Harmonics, Spectrum},
    },
    motion::AxisPlan,
    peripheral::trace::{Recording, steps},
    scenario::{Analysis, Problem, Source, ValueError},
};

/// What `stepscope measures` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario, a JSON file whose source is a motion; `-` reads standard input.
    scenario: PathBuf,
    /// The axis, from 0; that of the scenario's `analysis` without it.
    #[arg(long, value_name = "K")]
    axis: Option<usize>,
    /// How it is written: for the eye, as one JSON object, or as a table of one figure a row.
    #[arg(long, value_enum, default_value = "text")]
    format: Written,
}

#[derive(Clone, Copy, ValueEnum)]
enum Written {
    Text,
    Json,
    Csv,
}

/// Distortion of a motion that repeats: of the ideal curve and of the pulses.
struct Distortion {
    ideal: Spectrum,
    pulses: Spectrum,
}

impl Distortion {
    fn of(plan: &AxisPlan, run: &Pulses<'_>, analysis: &Analysis) -> Option<Self> {
        let stretch = AnalysisWindow::of(plan).filter(|stretch| stretch.periodic)?;
        let ideal = Spectrum::ideal(plan, analysis.order, analysis.fft_length)?;
        // To the same order, which the number of samples may have cut.
        let pulses = Spectrum::of_pulses(&stretch.pulses_of(plan, run), stretch, ideal.order);
        Some(Self {
            ideal: ideal.filtered_by(analysis.sensor_hz),
            pulses: pulses.filtered_by(analysis.sensor_hz),
        })
    }

    /// Name, and the ratios of the ideal curve and of the pulses.
    fn rows(&self) -> impl Iterator<Item = (&'static str, [Option<f64>; 2])> + '_ {
        type Of = fn(&Spectrum) -> Option<&Harmonics>;
        let of: [(_, Of); 4] = [
            ("position", |spectrum| Some(&spectrum.position)),
            ("speed", |spectrum| Some(&spectrum.speed)),
            ("acceleration", |spectrum| Some(&spectrum.acceleration)),
            ("acceleration_felt", |spectrum| spectrum.acceleration_filtered.as_ref()),
        ];
        of.into_iter().filter_map(|(name, of)| {
            let ratio = |spectrum| of(spectrum).map(|harmonics| harmonics.distortion);
            Some((name, [ratio(&self.ideal)?, ratio(&self.pulses)?]))
        })
    }
}

/// Runs the scenario and writes the measures.
pub(crate) fn measures(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let wrong = |problems| Failure::Scenario(path.clone(), problems);
    let (scenario, experiment) = scenarios::judged(path)?;
    let Source::Motion(motion) = &scenario.source else {
        let detail =
            "no motion, so there is no curve to measure the pulses by; give a scenario with source.motion";
        return Err(wrong(vec![Problem::new("source", ValueError::Conflict { detail })]));
    };
    let axis = arguments.axis.unwrap_or(scenario.analysis.axis.into());
    let plan = experiment.plans().get(axis);
    let plan = plan.ok_or_else(|| Failure::Axis(path.clone(), axis, experiment.plans().len()))?;
    // The recording has the steps of all axes.
    let plans = (0..experiment.controllers()).flat_map(|controller| experiment.plans_of(controller));
    within_bounds(plans).map_err(|cause| wrong(vec![Problem::new("source.motion", cause)]))?;
    let mut recording = Recording::default();
    experiment.run(&mut recording);
    // There are at most 16 axes.
    let channel = axis as u8;
    let steps = steps(&recording.trace, channel);
    let run = Pulses {
        channel,
        steps: &steps,
        log: &recording.packets,
        segments: experiment.segments().and_then(|lists| lists.lists().get(axis)),
        config: experiment.config(),
    };
    let found = Measures::of(plan, &run, motion.axes.get(axis));
    let distortion = Distortion::of(plan, &run, &scenario.analysis);
    let mut out = io::stdout().lock();
    let written = match arguments.format {
        Written::Text => table::text(axis, &found, distortion.as_ref(), &mut out),
        Written::Csv => table::csv(&found, distortion.as_ref(), &mut out),
        Written::Json => json(axis, &found, distortion.as_ref(), &mut out),
    };
    written.and_then(|()| out.flush()).map_err(Failure::output)
}

fn json(
    axis: usize,
    found: &Measures,
    distortion: Option<&Distortion>,
    out: &mut impl Write,
) -> io::Result<()> {
    let mut object = serde_json::to_value(found).map_err(|error| io::Error::other(error.to_string()))?;
    object["axis"] = axis.into();
    object["distortion"] = distortion.map_or(serde_json::Value::Null, |distortion| {
        let mut ratios = serde_json::json!({ "order": distortion.ideal.order });
        for (name, [ideal, pulses]) in distortion.rows() {
            ratios[name] = serde_json::json!({ "ideal": ideal, "pulses": pulses });
        }
        ratios
    });
    writeln!(out, "{object:#}")
}
