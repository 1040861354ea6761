//! Measures steps without a plan: of packets, line scripts, segment lists.

use super::arguments::{Arguments, Written};
use crate::failure::{Failure, Numbered};
use crate::{json::Tables, output, run_recording};
use serde_json::{Map, Value};
use std::io::{self, Write};
use stepscope_core::inspect::motion::spectrum::{Harmonics, Spectrum};
use stepscope_core::inspect::motion::{actual_motion::Pulses, spectra::Spectra};
use stepscope_core::inspect::recording::figures::StepFigures;
use stepscope_core::scenario::{Problem, Scenario, ValueError};
use stepscope_core::{peripheral::trace::steps, sim::Experiment};

/// Includes the distortion if the steps are periodic.
pub(super) fn measures(
    arguments: &Arguments,
    scenario: &Scenario,
    experiment: &Experiment,
) -> Result<(), Failure> {
    let channel = arguments.axis.unwrap_or(scenario.analysis.axis.into());
    let channels = experiment.config().channels();
    let own = u8::try_from(channel).ok().filter(|channel| *channel < channels);
    let own = own.ok_or_else(|| {
        Failure::index(&arguments.scenario, Numbered::AxisChannels, channel, channels.into(), false)
    })?;
    let recording = run_recording::of(&arguments.scenario, experiment)?;
    let steps = steps(&recording.trace, own);
    let clock_hz = experiment.config().clock_hz();
    let figures = StepFigures::of(steps.iter().copied(), clock_hz).ok_or_else(|| {
        let detail = "this channel makes no step; use another --axis";
        let problem = Problem::new("source", ValueError::Conflict { detail });
        Failure::Scenario(arguments.scenario.clone(), problem.into())
    })?;
    let spectra = Spectra::of(scenario, None, &Pulses::recorded(own, &steps, clock_hz));
    let rows = rows(&figures, spectra.actual.as_ref()).map_err(Failure::output)?;
    output::write_new(&arguments.out.out, |out| match arguments.format {
        _ if arguments.json.json => {
            let row =
                |(name, value): (&String, &Value)| serde_json::json!({ "measure": name, "value": value });
            Tables::of("measures").with("steps", rows.iter().map(row)).write(out)
        }
        Written::Json => writeln!(out, "{:#}", Value::Object(rows)),
        Written::Csv => writeln!(out, "measure,value").and_then(|()| {
            rows.iter().try_for_each(|(name, value)| writeln!(out, "{name},{}", shown(value, "")))
        }),
        Written::Text => {
            writeln!(out, "channel {own}: the scenario has no motion, so the steps themselves are measured")
                .and_then(|()| {
                    rows.iter()
                        .try_for_each(|(name, value)| writeln!(out, "  {name:34} {}", shown(value, "-")))
                })
        }
    })
}

fn shown(value: &Value, none: &str) -> String {
    if value.is_null() { none.to_owned() } else { value.to_string() }
}

fn rows(figures: &StepFigures, spectrum: Option<&Spectrum>) -> io::Result<Map<String, Value>> {
    let Value::Object(mut rows) = serde_json::to_value(figures).map_err(io::Error::other)? else {
        return Ok(Map::new());
    };
    let Some(spectrum) = spectrum.filter(|spectrum| spectrum.window.periodic) else { return Ok(rows) };
    rows.insert("fundamental_hz".into(), spectrum.window.fundamental_hz().into());
    rows.insert("periods".into(), spectrum.window.periods.into());
    let all = [
        ("thd_position", Some(&spectrum.position)),
        ("thd_speed", Some(&spectrum.speed)),
        ("thd_acceleration", Some(&spectrum.acceleration)),
        ("thd_acceleration_filtered", spectrum.acceleration_filtered.as_ref()),
    ];
    for (name, harmonics) in all {
        let thd = harmonics.and_then(|Harmonics { distortion, .. }| *distortion);
        rows.insert(name.into(), thd.into());
    }
    Ok(rows)
}
