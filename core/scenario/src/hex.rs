//! Bytes as hexadecimal text.

use crate::{Json, JsonReader, ReadJson};
use alloc::{format, string::String, vec::Vec};
use base16ct::{lower, mixed};
use serde_json::Value;

/// Bytes as hexadecimal digits in JSON. Reads capitals and spaces; writes neither.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hex(pub Vec<u8>);

impl ReadJson for Hex {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        let Some(text) = value.text() else {
            return reader.reject_type(value, "bytes in hex, such as \"80 01 7f\"");
        };
        match Self::of_text(&text) {
            Ok(bytes) => {
                *self = bytes;
                true
            }
            Err(wrong) => reader.reject(wrong),
        }
    }

    fn blank() -> Self {
        Self::default()
    }
}

impl Hex {
    pub(crate) fn of_text(text: &str) -> Result<Self, String> {
        let digits: String = text.chars().filter(|c| !c.is_ascii_whitespace()).collect();
        mixed::decode_vec(&digits).map(Self).map_err(|_| wrong_in(&digits))
    }
}

fn wrong_in(digits: &str) -> String {
    let wrong = digits.chars().enumerate().find(|(_, c)| !c.is_ascii_hexdigit());
    let what = match wrong {
        Some((index, c)) => {
            format!("\u{201c}{c}\u{201d} in byte {} is not a hexadecimal digit", index / 2 + 1)
        }
        None => format!("byte {} has only one digit", digits.len() / 2 + 1),
    };
    format!("{what}; use two digits per byte, such as 80 01 7f")
}

impl crate::schema::ToParts for Hex {
    fn parts(&self) -> crate::schema::Parts<'_> {
        crate::schema::Parts::Value(Value::from(lower::encode_string(&self.0)))
    }
}

impl crate::schema::Typed for Hex {
    const TYPE: crate::schema::Type = crate::schema::Type::Hex;
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn errors_state_the_byte_and_the_allowed_digits() {
        let rows = [
            ("80 0g", "\u{201c}g\u{201d} in byte 2 is not"),
            ("8x", "\u{201c}x\u{201d} in byte 1 is not"),
            ("\u{fc}0", "\u{201c}\u{fc}\u{201d} in byte 1 is not"),
            ("80 01 7", "byte 3 has only one digit"),
        ];
        for (given, expected) in rows {
            let error = Hex::of_text(given).unwrap_err();
            assert!(error.starts_with(expected), "{given}: {error}");
            assert!(error.ends_with("use two digits per byte, such as 80 01 7f"), "{error}");
        }
        assert_eq!(Hex::of_text("80 01\n7F").unwrap(), Hex(vec![0x80, 1, 0x7f]));
    }
}
