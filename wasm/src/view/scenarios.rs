//! Validation of scenarios.

use crate::{convert::object, scenario::ValidatedScenario};
use stepscope_core::{inspect::validation::Validation, scenario::Scenario};
use wasm_bindgen::prelude::*;

/// Version of Stepscope.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// The default scenario as JSON, with all fields.
#[wasm_bindgen]
pub fn default_scenario() -> String {
    Scenario::default().to_json()
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// Problems, the scenario as far as it could be read, derived values, and the cost of a run ([`Validation`]).
    pub fn check(&self) -> Result<JsValue, JsError> {
        object(&Validation::of(&self.0))
    }
}
