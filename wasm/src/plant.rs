//! What a run's motors, supply and sensors did, as the view Motor shows it.

use crate::convert::{field, numbers, object};
#[cfg(feature = "run")]
use crate::simulation::Simulation;
use js_sys::Object;
use stepscope_core::{
    inspect::{
        plant_log::{MOTOR, PlantLog, SUPPLY, Stretch},
        plant_report::PlantReport,
    },
    peripheral::signal::Record,
    sim::{Experiment, Run},
};
use wasm_bindgen::prelude::*;

#[cfg(feature = "run")]
#[wasm_bindgen]
impl Simulation {
    /// What the selected controller's plant came to ([`PlantReport`]); null where it has none.
    ///
    /// # Errors
    /// Never in practice.
    pub fn plant(&self) -> Result<JsValue, JsError> {
        self.behind().report()
    }

    /// Values of the supply and of a motor over a stretch of cycles, by their names ([`SUPPLY`], [`MOTOR`]): `x` in s, `min`
    /// and `max`; undefined where there is no such motor.
    #[must_use]
    pub fn plant_curves(&self, channel: usize, from: f64, to: f64, columns: usize) -> Option<Object> {
        self.behind().curves(channel, from, to, columns)
    }

    /// The same values at the last point of the plant's grid up to a cycle.
    #[must_use]
    pub fn plant_at(&self, channel: usize, cycle: f64) -> Option<Object> {
        self.behind().at(channel, cycle)
    }
}

#[cfg(feature = "run")]
impl Simulation {
    fn behind(&self) -> Behind<'_> {
        let selected = self.selected();
        Behind {
            experiment: &self.experiment,
            run: &self.run,
            controller: self.selected,
            log: selected.plant.as_ref(),
            trace: &selected.recording.trace,
        }
    }
}

/// What stands behind the drivers of one controller of a run.
pub(crate) struct Behind<'a> {
    pub(crate) experiment: &'a Experiment,
    pub(crate) run: &'a Run,
    pub(crate) controller: usize,
    pub(crate) log: Option<&'a PlantLog>,
    pub(crate) trace: &'a [Record],
}

impl Behind<'_> {
    /// What it came to.
    pub(crate) fn report(&self) -> Result<JsValue, JsError> {
        object(&PlantReport::of(self.experiment, self.run, self.controller))
    }

    /// Values over a stretch of cycles, by their names.
    pub(crate) fn curves(&self, channel: usize, from: f64, to: f64, columns: usize) -> Option<Object> {
        let (log, values, names) = self.values(channel)?;
        let stretch = Stretch { from: from.max(0.0) as u64, to: to.max(0.0) as u64, columns };
        let hz = f64::from(self.experiment.config().clock_hz());
        let result = Object::new();
        let bands = log.curves(self.trace, stretch, &values);
        for (name, band) in names.zip(bands) {
            let one = Object::new();
            let seconds: Vec<f64> = band.cycle.iter().map(|cycle| cycle / hz).collect();
            numbers(&one, "x", &seconds);
            numbers(&one, "min", &band.least);
            numbers(&one, "max", &band.greatest);
            field(&result, name, &one);
        }
        Some(result)
    }

    /// The same values at the last point of the plant's grid up to a cycle.
    pub(crate) fn at(&self, channel: usize, cycle: f64) -> Option<Object> {
        let (log, values, names) = self.values(channel)?;
        let all = log.at(self.trace, cycle.max(0.0) as u64);
        let result = Object::new();
        for (name, value) in names.zip(values) {
            field(&result, name, &all.get(value).copied().into());
        }
        Some(result)
    }

    /// The log, and indices and names of the values of its supply and of one motor.
    fn values(&self, channel: usize) -> Option<(&PlantLog, Vec<usize>, impl Iterator<Item = &'static str>)> {
        let log = self.log?;
        let first = PlantLog::of_motor(channel);
        let has_motor = self.run.plant(self.controller).is_some_and(|plant| channel < plant.motors());
        let values = (0..SUPPLY.len()).chain(first..first + MOTOR.len()).collect();
        has_motor.then(|| (log, values, SUPPLY.into_iter().chain(MOTOR)))
    }
}
