//! Motors, supply and sensors of a run.

use crate::convert::{field, numbers, object};
use crate::view::simulation::Simulation;
use js_sys::Object;
use stepscope_core::inspect::plant::log::{CycleWindow, MOTOR, PlantLog, SUPPLY};
use stepscope_core::inspect::plant::report::PlantReport;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Simulation {
    /// The report of the selected controller ([`PlantReport`]); null without a plant.
    pub fn plant(&self) -> Result<JsValue, JsError> {
        object(&PlantReport::of(&self.experiment, &self.run, self.selected))
    }

    /// Curves of the supply and a motor by name ([`SUPPLY`], [`MOTOR`]): `x` in s, `min`, `max`; undefined if unknown.
    pub fn plant_curves(&self, channel: usize, from: f64, to: f64, columns: usize) -> Option<Object> {
        let (log, values, names) = self.plant_values(channel)?;
        let window = CycleWindow { from: from.max(0.0) as u64, to: to.max(0.0) as u64, columns };
        let hz = f64::from(self.experiment.config().clock_hz());
        let result = Object::new();
        let bands = log.curves(&self.selected().stored.trace, window, &values);
        for (name, band) in names.zip(bands) {
            let one = Object::new();
            let seconds: Vec<f64> = band.cycle.iter().map(|cycle| cycle / hz).collect();
            numbers(&one, "x", &seconds);
            numbers(&one, "min", &band.min);
            numbers(&one, "max", &band.max);
            field(&result, name, &one);
        }
        Some(result)
    }

    /// The same values at a cycle.
    pub fn plant_at(&self, channel: usize, cycle: f64) -> Option<Object> {
        let (log, values, names) = self.plant_values(channel)?;
        let all = log.at(&self.selected().stored.trace, cycle.max(0.0) as u64);
        let result = Object::new();
        for (name, value) in names.zip(values) {
            field(&result, name, &all.get(value).copied().into());
        }
        Some(result)
    }
}

impl Simulation {
    /// The log, and indices and names of the values.
    fn plant_values(
        &self,
        channel: usize,
    ) -> Option<(&PlantLog, Vec<usize>, impl Iterator<Item = &'static str>)> {
        let log = self.selected().plant.as_ref()?;
        let first = PlantLog::motor_index(channel);
        let has_motor = self.run.plant(self.selected).is_some_and(|plant| channel < plant.motors());
        let values = (0..SUPPLY.len()).chain(first..first + MOTOR.len()).collect();
        has_motor.then(|| (log, values, SUPPLY.into_iter().chain(MOTOR)))
    }
}
