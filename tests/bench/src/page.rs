//! Functions for the worker of the benchmark's page.

use wasm_bindgen::prelude::*;

use crate::{kernels::Kernels, rounds};

#[wasm_bindgen]
extern "C" {
    /// Milliseconds.
    #[wasm_bindgen(js_namespace = performance)]
    fn now() -> f64;
}

/// The kernels, prepared.
#[wasm_bindgen]
pub struct Bench(Kernels);

#[wasm_bindgen]
impl Bench {
    /// Prepares the kernels.
    ///
    /// # Errors
    /// The problems of the motions; there are none.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Result<Bench, JsError> {
        Kernels::new().map(Self).map_err(|problems| JsError::new(&format!("{problems:?}")))
    }

    /// Runs a number of rounds of all kernels, and returns the report as JSON.
    ///
    /// # Errors
    /// None known.
    pub fn rounds(&mut self, count: u32) -> Result<String, JsError> {
        let reports = rounds::measure(&mut self.0, |_| true, count, || now() / 1e3);
        Ok(serde_json::to_string(&reports)?)
    }
}
