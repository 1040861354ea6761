//! Spectra as the page shows them.

use crate::convert::{field, numbers, object};
use js_sys::Object;
use stepscope_core::{
    inspect::{
        actual_motion::Pulses,
        spectrum::{AnalysisWindow, Harmonics, Spectrum},
    },
    motion::AxisPlan,
    scenario::{Scenario, Source},
};
use wasm_bindgen::prelude::*;

/// `{axis, ideal, pulses, note}`: the ideal curve's spectrum and the one of the pulses as they come.
pub(crate) fn spectrum(
    scenario: &Scenario,
    plan: Option<&AxisPlan>,
    run: &Pulses<'_>,
) -> Result<JsValue, JsError> {
    let analysis = &scenario.analysis;
    let result = Object::new();
    field(&result, "axis", &analysis.axis.into());
    let stretch = plan.and_then(AnalysisWindow::of);
    let (Some(plan), Some(stretch)) = (plan, stretch) else {
        field(&result, "ideal", &JsValue::NULL);
        field(&result, "pulses", &JsValue::NULL);
        let note = match &scenario.source {
            Source::Motion(_) => format!("This controller has no axis {}.", analysis.axis),
            _ => {
                "A spectrum needs a motion; packets, line scripts and lists of segments have none.".to_owned()
            }
        };
        field(&result, "note", &note.into());
        return Ok(result.into());
    };
    let ideal = Spectrum::ideal(plan, analysis.order, analysis.fft_length);
    let felt = |spectrum: Spectrum| told(&spectrum.felt_by(analysis.sensor_hz));
    field(&result, "ideal", &ideal.map_or(Ok(JsValue::NULL), felt)?);
    let pulses = stretch.pulses_of(plan, run);
    field(&result, "pulses", &felt(Spectrum::of_pulses(&pulses, stretch, analysis.order))?);
    let note = if stretch.periodic {
        ""
    } else {
        "The motion does not repeat: its lines are no harmonics, and it has no distortion."
    };
    field(&result, "note", &note.into());
    Ok(result.into())
}

fn told(spectrum: &Spectrum) -> Result<JsValue, JsError> {
    #[derive(serde::Serialize)]
    struct Told {
        fundamental_hz: f64,
        periods: u32,
        order: u16,
        periodic: bool,
    }
    let told = object(&Told {
        fundamental_hz: spectrum.stretch.fundamental_hz(),
        periods: spectrum.stretch.periods,
        order: spectrum.order,
        periodic: spectrum.stretch.periodic,
    })?;
    let target: &Object = told.unchecked_ref();
    for (name, harmonics) in [
        ("position", &spectrum.position),
        ("speed", &spectrum.speed),
        ("acceleration", &spectrum.acceleration),
    ] {
        let Harmonics { amplitudes, distortion } = harmonics;
        numbers(target, name, amplitudes);
        field(target, &format!("thd_{name}"), &distortion.map_or(JsValue::NULL, JsValue::from));
    }
    // A figure of its own, without amplitudes: they are the acceleration's times the low pass.
    let felt = spectrum.acceleration_felt.as_ref().and_then(|felt| felt.distortion);
    field(target, "thd_acceleration_felt", &felt.map_or(JsValue::NULL, JsValue::from));
    Ok(told)
}
