//! Scenarios for runs, links and the study.

use stepscope_core::sim::{self, Experiment};
use stepscope_core::{peripheral::config::Config, scenario::Problems};
use wasm_bindgen::prelude::*;

/// A scenario that is read, validated and planned once.
#[wasm_bindgen]
pub struct ValidatedScenario(pub(crate) sim::ValidatedScenario);

#[wasm_bindgen]
impl ValidatedScenario {
    /// Reads, validates and plans any text.
    #[wasm_bindgen(constructor)]
    pub fn new(json: &str) -> Self {
        Self(sim::ValidatedScenario::from_json(json))
    }
}

impl ValidatedScenario {
    /// Axis `axis` of controller `controller`. Errors: if the scenario has problems, or no such axis.
    pub(crate) fn axis(&self, controller: usize, axis: usize) -> Result<sim::SelectedAxis<'_>, JsError> {
        self.0.experiment().map_err(listed)?;
        self.0.axis(controller, axis).ok_or_else(|| JsError::new("unknown axis; select one with motion"))
    }
}

pub(crate) fn listed(problems: &Problems) -> JsError {
    JsError::new(&problems.to_string())
}

/// The configuration of controller `index`.
pub(crate) fn config(experiment: &Experiment, index: usize) -> &Config {
    experiment.configs().nth(index).unwrap_or_else(|| experiment.config())
}
