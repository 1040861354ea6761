//! The scenario's schema for the form and the help.

use js_sys::JSON;
use stepscope_core::scenario::schema::describe;
use wasm_bindgen::prelude::*;

/// The schema of [`describe`]. The texts of help cards are in `web/help/explained.js`.
#[wasm_bindgen]
pub fn schema() -> Result<JsValue, JsError> {
    JSON::parse(&describe()).map_err(|_| JsError::new("the schema is not JSON"))
}
