//! Available and needed torque of an axis.

use crate::convert::{field, numbers, object, records};
use crate::scenario::{ValidatedScenario, listed};
use js_sys::Object;
use stepscope_core::inspect::motion::torque::{Machine, TorqueReport};
use stepscope_core::inspect::plant::motors;
use stepscope_core::peripheral::trace::steps;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl ValidatedScenario {
    /// The torque of an axis: `report` ([`TorqueReport`]), `rate`, `available` and `needed` (NaN at unused rates), in mN*m;
    /// undefined without a motor. Errors: if the scenario has problems, or no such axis.
    pub fn torque(&self, controller: usize, axis: usize) -> Result<Option<Object>, JsError> {
        let selected = self.axis(controller, axis)?;
        let Some(report) = TorqueReport::of(selected.axis, selected.plan) else { return Ok(None) };
        shown(&report).map(Some)
    }

    /// The same for a channel without a plan, from the records of `Simulation::records_of`. The motor is that of the plant, or
    /// the listed `motor`; undefined without one. Errors: if the scenario has problems.
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
