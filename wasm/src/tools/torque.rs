//! Torque-speed curve of an axis' motor, what its plan needs, and which ramps it can follow.

use crate::{
    convert::{field, numbers, object, records},
    judged::{Judged, listed},
};
use js_sys::Object;
use stepscope_core::{
    inspect::{
        motion::torque::{Machine, TorqueReport},
        plant::motors,
    },
    peripheral::trace::steps,
};
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
        shown(&report).map(Some)
    }

    /// The same of the steps of a channel that has no plan: `run` is what the views show of it, records as
    /// `Simulation::records_of` gives them. The motor is that of the scenario's plant, or, where it has none, the one of the
    /// list with the word `motor`; undefined where there is neither.
    ///
    /// # Errors
    /// If the scenario has problems.
    pub fn torque_of_steps(
        &self,
        controller: usize,
        channel: u8,
        run: &[u8],
        motor: &str,
    ) -> Result<Option<Object>, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        let own = Machine::of_channel(self.0.scenario(), controller, channel.into());
        let listed = || motors::motor(motor).and_then(motors::MotorSheet::machine);
        let Some(machine) = own.or_else(listed) else { return Ok(None) };
        let trace: Vec<_> = records(run).collect();
        let clock_hz = experiment.config().clock_hz();
        shown(&TorqueReport::of_steps(&machine, &steps(&trace, channel), clock_hz)).map(Some)
    }
}

fn shown(report: &TorqueReport) -> Result<Object, JsError> {
    let result = Object::new();
    field(&result, "report", &object(report)?);
    numbers(&result, "rate", &report.curve.rate);
    numbers(&result, "available", &report.curve.available);
    numbers(&result, "needed", &report.curve.needed);
    Ok(result)
}
