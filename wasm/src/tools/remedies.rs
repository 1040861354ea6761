//! What a refused scenario could be changed to.

use crate::{convert::object, judged::Judged};
use stepscope_core::inspect::validation::remedies::Remedies;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Judged {
    /// What would let a motion run that its bus is too slow for: `{wrong, offers: [{change, scenario}]}`; null where
    /// that is not what is wrong.
    ///
    /// # Errors
    /// Never in practice.
    pub fn remedies(&self) -> Result<JsValue, JsError> {
        object(&Remedies::of(&self.0))
    }
}
