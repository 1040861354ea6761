//! Results as JavaScript values.

use js_sys::{Object, Reflect};
use serde::Serialize;
use stepscope_core::peripheral::signal::{Levels, Record};
use stepscope_core::peripheral::units::Instant;
use wasm_bindgen::{JsError, JsValue};

/// A plain object; maps become objects.
pub(crate) fn object(value: &impl Serialize) -> Result<JsValue, JsError> {
    value.serialize(&serde_wasm_bindgen::Serializer::json_compatible()).map_err(JsError::from)
}

pub(crate) fn field(object: &Object, name: &str, value: &JsValue) {
    let _ = Reflect::set(object, &name.into(), value);
}

#[cfg(feature = "simulation")]
pub(crate) fn numbers(object: &Object, name: &str, values: &[f64]) {
    field(object, name, &js_sys::Float64Array::from(values));
}

/// Records of 16 bytes: cycle and levels, little-endian.
pub(crate) fn records(bytes: &[u8]) -> impl Iterator<Item = Record> {
    let word = |bytes: &[u8]| bytes.try_into().map_or(0, u64::from_le_bytes);
    let record = move |record: &[u8]| Record {
        cycle: Instant(word(&record[..8])),
        levels: Levels(word(&record[8..])),
    };
    bytes.chunks_exact(16).map(record)
}
