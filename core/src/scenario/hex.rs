//! Bytes as hexadecimal text.

use alloc::{string::String, vec::Vec};
use base16ct::{lower, mixed};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};
use serde_json::Value;

/// Bytes that JSON writes as hexadecimal digits. Capital letters and spaces are read, small ones
/// without spaces are written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hex(pub Vec<u8>);

impl Serialize for Hex {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&lower::encode_string(&self.0))
    }
}

impl<'de> Deserialize<'de> for Hex {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let digits: String = text.chars().filter(|c| !c.is_ascii_whitespace()).collect();
        mixed::decode_vec(&digits).map(Self).map_err(|e| {
            D::Error::custom(alloc::format!("hexadecimal digits, two a byte, such as \"80 01 7f\"; {e}"))
        })
    }
}

impl super::Compact for Hex {
    fn compact(&self) -> Value {
        Value::from(lower::encode_string(&self.0))
    }
}
