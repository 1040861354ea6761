//! Texts as share links (PAGE "Share link"): none causes a panic, and a link that opens is a scenario within the limits
//! whose own link opens as the same scenario.

use super::scenario::MAX_PROBLEMS;
use crc::{CRC_32_ISO_HDLC, Crc};
use data_encoding::BASE64URL_NOPAD;
use stepscope_core::scenario::{
    Compact, VERSION,
    link::{LinkError, MAX_FRAGMENT_BYTES, MAX_JSON_BYTES, decode, encode},
};

/// Opens bytes as a link, unchanged and with a corrected CRC, and as the contents of a link with a valid CRC.
///
/// # Panics
/// If a property is violated.
pub fn check(data: &[u8]) {
    if let Ok(text) = str::from_utf8(data) {
        open(text);
        if let Some((checked, _)) = text.strip_prefix("c=").and_then(|text| text.rsplit_once('.')) {
            open(&with_check(checked));
        }
    }
    open(&around('j', data));
    open(&around('z', data));
}

/// The published links, and their contents.
#[must_use]
pub fn seeds() -> Vec<Vec<u8>> {
    let held = super::links().filter_map(payload);
    super::links().map(|link| link.as_bytes().to_vec()).chain(held).collect()
}

/// The contents of a link: a scenario's JSON, mostly deflated.
pub(super) fn payload(link: &str) -> Option<Vec<u8>> {
    BASE64URL_NOPAD.decode(link.split('.').nth(2)?.as_bytes()).ok()
}

/// A link with a valid CRC and any payload.
#[must_use]
pub fn around(codec: char, payload: &[u8]) -> String {
    with_check(&format!("{VERSION}.{codec}.{}", BASE64URL_NOPAD.encode(payload)))
}

fn with_check(text: &str) -> String {
    format!("c={text}.{:08x}", Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(text.as_bytes()))
}

/// Opens a link: the result is a scenario within the limits, or an error.
///
/// # Panics
/// If a property is violated.
pub fn open(fragment: &str) {
    match decode(fragment) {
        Ok(scenario) => {
            assert!(fragment.len() <= MAX_FRAGMENT_BYTES, "{} bytes", fragment.len());
            assert!(scenario.compact().to_string().len() <= 2 * MAX_JSON_BYTES);
            match encode(&scenario) {
                Ok(link) => {
                    let again = decode(&link);
                    assert_eq!(again.as_ref(), Ok(&scenario), "{link}");
                    assert_eq!(again.and_then(|again| encode(&again)).as_ref(), Ok(&link));
                }
                Err(error) => assert!(matches!(error, LinkError::TooLong { .. }), "{error:?}"),
            }
        }
        Err(LinkError::Scenario(problems)) => assert!((1..=MAX_PROBLEMS).contains(&problems.len())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
