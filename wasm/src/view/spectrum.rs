//! Spectra.

use crate::convert::{field, numbers, object};
use crate::view::simulation::Simulation;
use js_sys::Object;
use serde::Serialize;
use stepscope_core::inspect::motion::spectra::Spectra;
use stepscope_core::inspect::motion::spectrum::{Harmonics, Spectrum};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Simulation {
    /// Spectra of the ideal and the actual motion of the analyzed axis: `{axis, ideal, pulses, note}`.
    pub fn spectrum(&mut self) -> Result<Object, JsError> {
        let axis = self.scenario.analysis.axis;
        self.count_steps(axis);
        let Spectra { ideal, actual, note } =
            Spectra::of(&self.scenario, self.plan(axis), &self.pulses_of(axis));
        let result = Object::new();
        field(&result, "axis", &axis.into());
        for (name, spectrum) in [("ideal", ideal), ("pulses", actual)] {
            let spectrum = spectrum.as_ref().map_or(Ok(JsValue::NULL), columns)?;
            field(&result, name, &spectrum);
        }
        field(&result, "note", &note.into());
        Ok(result)
    }
}

fn columns(spectrum: &Spectrum) -> Result<JsValue, JsError> {
    #[derive(Serialize)]
    struct Facts {
        fundamental_hz: f64,
        periods: u32,
        order: u16,
        periodic: bool,
    }
    let facts = object(&Facts {
        fundamental_hz: spectrum.window.fundamental_hz(),
        periods: spectrum.window.periods,
        order: spectrum.order,
        periodic: spectrum.window.periodic,
    })?;
    let target: &Object = facts.unchecked_ref();
    for (name, harmonics) in [
        ("position", Some(&spectrum.position)),
        ("speed", Some(&spectrum.speed)),
        ("acceleration", Some(&spectrum.acceleration)),
        ("acceleration_filtered", spectrum.acceleration_filtered.as_ref()),
    ] {
        if let Some(Harmonics { amplitudes, .. }) = harmonics {
            numbers(target, name, amplitudes);
        }
        let distortion = harmonics.and_then(|harmonics| harmonics.distortion);
        field(target, &format!("thd_{name}"), &distortion.map_or(JsValue::NULL, JsValue::from));
    }
    Ok(facts)
}
