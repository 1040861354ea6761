//! Torque-speed curve of an axis' motor, what its plan needs, and which ramps it can follow.

use crate::{
    convert::{field, numbers, object},
    judged::Judged,
};
use js_sys::Object;
use stepscope_core::inspect::torque::TorqueReport;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Judged {
    /// What an axis' motor has and what its plan asks: `report` with the numbers ([`TorqueReport`]), `rate`, `available`
    /// and `needed` (the most at each rate, NaN at rates that the plan has not), torques in mN*m; undefined where the
    /// axis has no motor.
    ///
    /// # Errors
    /// If the scenario has problems, or no such axis.
    pub fn torque(&self, controller: usize, axis: usize) -> Result<Option<Object>, JsError> {
        let selected = self.axis(controller, axis)?;
        let Some(report) = TorqueReport::of(selected.axis, selected.plan) else { return Ok(None) };
        let result = Object::new();
        field(&result, "report", &object(&report)?);
        numbers(&result, "rate", &report.curve.rate);
        numbers(&result, "available", &report.curve.available);
        numbers(&result, "needed", &report.curve.needed);
        Ok(Some(result))
    }
}
