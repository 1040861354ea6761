//! The scenario's schema for the form and the help.

use js_sys::JSON;
use stepscope_core::scenario::schema::describe;
use wasm_bindgen::prelude::*;

/// The schema as a plain object: `{root, documents, groups}`, as `scenario::schema::describe` writes it. What terms mean
/// stands in `web/help/explained.js`, which loads with the first card.
///
/// # Errors
/// Never in practice: what the core writes is JSON.
#[wasm_bindgen]
pub fn schema() -> Result<JsValue, JsError> {
    JSON::parse(&describe()).map_err(|_| JsError::new("the schema is not JSON"))
}
