//! `stepscope measures`: tracking error, peaks and distortion of an axis.

mod arguments;
mod distortion;
mod table;
mod unplanned;

use crate::failure::{Failure, Numbered};
use crate::{output, run_recording, scenarios};
pub(crate) use arguments::Arguments;
use arguments::Written;
use distortion::Distortion;
use std::io::{self, Write};
use stepscope_core::inspect::motion::actual_motion::Pulses;
use stepscope_core::inspect::motion::measures::{Measures, within_bounds};
use stepscope_core::peripheral::trace::steps;
use stepscope_core::scenario::{Problem, Scenario, Source};

pub(crate) fn measures(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let wrong = |problems| Failure::Scenario(path.clone(), problems);
    let selected = |scenario: &Scenario| arguments.axis.unwrap_or(scenario.analysis.axis.into());
    let (scenario, experiment) = scenarios::validated_after(path, |scenario| {
        let (of, axes) = match &scenario.source {
            Source::Motion(motion) => (Numbered::Axes, motion.axes.len()),
            _ => (Numbered::AxisChannels, scenario.bus.channels.into()),
        };
        let axis = selected(scenario);
        // A scenario without axes has a problem of its own.
        if axis < axes || axes == 0 { Ok(()) } else { Err(Failure::index(path, of, axis, axes, false)) }
    })?;
    let Source::Motion(motion) = &scenario.source else {
        return unplanned::measures(arguments, &scenario, &experiment);
    };
    let axis = selected(&scenario);
    let plan = experiment.plans().get(axis);
    let count = experiment.plans().len();
    let plan = plan.ok_or_else(|| Failure::index(path, Numbered::Axes, axis, count, false))?;
    // The recording has all axes' steps.
    let plans = (0..experiment.controllers()).flat_map(|controller| experiment.plans_of(controller));
    within_bounds(plans).map_err(|cause| wrong(Problem::new("source.motion", cause).into()))?;
    let recording = run_recording::of(path, &experiment)?;
    // There are at most 16 axes.
    let channel = axis as u8;
    let steps = steps(&recording.trace, channel);
    let run = Pulses::of_run(
        channel,
        &steps,
        &recording.packets,
        experiment.segments().and_then(|lists| lists.lists().get(axis)),
        experiment.config(),
    );
    let found = Measures::of(plan, &run, motion.axes.get(axis));
    let distortion = Distortion::of(plan, &run, &scenario.analysis);
    output::write_new(&arguments.out.out, |out| match arguments.format {
        _ if arguments.json.json => table::tables(axis, &found, distortion.as_ref()).write(out),
        Written::Text => table::text(axis, &found, distortion.as_ref(), out),
        Written::Csv => table::csv(&found, distortion.as_ref(), out),
        Written::Json => json(axis, &found, distortion.as_ref(), out),
    })
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
