//! Scenarios on their way into the form and the run: what is to be said of one that was judged.

use crate::{convert::object, judged::Judged};
use stepscope_core::{inspect::validation::Validation, scenario::Scenario};
use wasm_bindgen::prelude::*;

/// Version of Stepscope.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// The default scenario as JSON, every field written.
#[wasm_bindgen]
#[must_use]
pub fn default_scenario() -> String {
    Scenario::default().to_json()
}

#[wasm_bindgen]
impl Judged {
    /// All problems with their paths, the scenario as far as it could be read, what follows from it, and what a run
    /// will cost: `{problems, scenario, derived, cost}`.
    ///
    /// # Errors
    /// Never for any text: what is wrong with it is in the result.
    pub fn check(&self) -> Result<JsValue, JsError> {
        object(&Validation::of(&self.0))
    }
}
