//! Remedies of an invalid scenario.

use crate::{convert::object, scenario::ValidatedScenario};
use stepscope_core::inspect::validation::remedies::Remedies;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl ValidatedScenario {
    /// Changes for a motion that is too fast for its bus ([`Remedies`]); null for other problems.
    pub fn remedies(&self) -> Result<JsValue, JsError> {
        object(&Remedies::of(&self.0))
    }
}
