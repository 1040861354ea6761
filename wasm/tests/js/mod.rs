//! Reads what the page reads: fields of plain JavaScript objects.

#![allow(dead_code, reason = "each test file uses some of it")]

use js_sys::{Array, Reflect};
use wasm_bindgen::{JsCast, JsValue};

/// A field of an object; its absence fails the test.
pub(crate) fn get(object: &JsValue, name: &str) -> JsValue {
    let value = Reflect::get(object, &name.into()).unwrap_or_default();
    assert!(!value.is_undefined(), "there is no {name} in {object:?}");
    value
}

/// A field that is a number.
pub(crate) fn number(object: &JsValue, name: &str) -> f64 {
    let value = get(object, name).as_f64();
    assert!(value.is_some(), "{name} is no number in {object:?}");
    value.unwrap_or_default()
}

/// A field that is a text.
pub(crate) fn text(object: &JsValue, name: &str) -> String {
    let value = get(object, name).as_string();
    assert!(value.is_some(), "{name} is no text in {object:?}");
    value.unwrap_or_default()
}

/// A field that is a list.
pub(crate) fn list(object: &JsValue, name: &str) -> Vec<JsValue> {
    let value = get(object, name);
    assert!(Array::is_array(&value), "{name} is no list in {object:?}");
    value.unchecked_into::<Array>().to_vec()
}
