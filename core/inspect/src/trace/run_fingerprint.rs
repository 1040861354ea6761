//! The run fingerprint in a link: it shows whether a run equals the sender's run.
//!
//! ```text
//! d=<form>.<version>.<controller>….<check>        form 1
//! <controller> = <digest>.<records>.<checkpoints>
//! ```
//!
//! `check` is the CRC-32 (ISO-HDLC) of all text before the last dot, so that a damaged link is not reported as a
//! difference. Checkpoints are big-endian base64url; `_` replaces dots of the version.

use crate::trace::fingerprint::{Fingerprint, FingerprintCheck, FingerprintMatch, Mark, Shorter, spacing};
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use base64ct::{Base64UrlUnpadded, Encoding};
use core::fmt;
use crc::{CRC_32_ISO_HDLC, Crc};

const FORM: u32 = 1;
const MAX_CONTROLLERS: usize = 32;
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The fingerprints of all controllers of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunFingerprint {
    pub version: String,
    pub controllers: Vec<Fingerprint>,
}

/// Why a fingerprint cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RunFingerprintError {
    Newer {
        given: u32,
    },
    /// Wrong CRC, or no fingerprint.
    Damaged,
}

impl fmt::Display for RunFingerprintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Newer { given } => write!(
                f,
                "the sender's digest in the link is from a newer version of Stepscope (form {given}; this version reads form {FORM}); it is ignored"
            ),
            Self::Damaged => {
                f.write_str("the sender's digest in the link was cut short or changed; it is ignored")
            }
        }
    }
}

impl core::error::Error for RunFingerprintError {}

pub const VERSION: &str = env!("CARGO_PKG_VERSION");

impl RunFingerprint {
    /// A fingerprint with the version of this crate.
    pub fn of(controllers: Vec<Fingerprint>) -> Self {
        Self { version: VERSION.to_string(), controllers }
    }

    /// The text for a link.
    pub fn emit(&self) -> String {
        let mut text = format!("{FORM}.{}", self.version.replace('.', "_"));
        for Fingerprint { digest, records, checkpoints } in &self.controllers {
            let bytes: Vec<u8> = checkpoints.iter().flat_map(|value| value.to_be_bytes()).collect();
            text += &format!(".{digest:016x}.{records}.{}", Base64UrlUnpadded::encode_string(&bytes));
        }
        let check = CRC.checksum(text.as_bytes());
        text + &format!(".{check:08x}")
    }

    /// The sender's version if it differs from this one.
    pub fn other_version(&self) -> Option<&str> {
        (self.version != VERSION).then_some(self.version.as_str())
    }

    /// One check per controller, for [`Verification::of`]. Fails with the sender's number of controllers if it differs.
    pub fn checks(&self, controllers: usize) -> Result<Vec<FingerprintCheck<'_>>, usize> {
        if self.controllers.len() != controllers {
            return Err(self.controllers.len());
        }
        Ok(self.controllers.iter().map(FingerprintCheck::with).collect())
    }

    /// Reads the text of [`Self::emit`]; the form is checked before the CRC.
    pub fn parse(text: &str) -> Result<Self, RunFingerprintError> {
        let (form, _) = text.split_once('.').ok_or(RunFingerprintError::Damaged)?;
        match form.parse() {
            Ok(FORM) => {}
            Ok(given) if given > FORM => return Err(RunFingerprintError::Newer { given }),
            _ => return Err(RunFingerprintError::Damaged),
        }
        let (checked, check) = text.rsplit_once('.').ok_or(RunFingerprintError::Damaged)?;
        if check != format!("{:08x}", CRC.checksum(checked.as_bytes())) {
            return Err(RunFingerprintError::Damaged);
        }
        parse_checked(checked).ok_or(RunFingerprintError::Damaged)
    }
}

/// Whether a run matches a fingerprint; otherwise the first controller that differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verification {
    Same { edges: u64 },
    Differs { controller: usize, after: Mark, until: Mark, shorter: Option<Shorter> },
}

impl Verification {
    /// The result of the checks of all controllers, in their order.
    pub fn of<'a>(checks: impl IntoIterator<Item = FingerprintCheck<'a>>) -> Self {
        let mut edges = 0;
        for (controller, check) in checks.into_iter().enumerate() {
            match check.finish() {
                FingerprintMatch::Same(mark) => edges += mark.edges,
                FingerprintMatch::Differs { after, until, shorter } => {
                    return Self::Differs { controller, after, until, shorter };
                }
            }
        }
        Self::Same { edges }
    }
}

fn parse_checked(checked: &str) -> Option<RunFingerprint> {
    let mut parts = checked.split('.').skip(1);
    let version = parts.next()?.replace('_', ".");
    let mut controllers = Vec::new();
    while let Some(digest) = parts.next() {
        let records: u64 = parts.next()?.parse().ok()?;
        let bytes = Base64UrlUnpadded::decode_vec(parts.next()?).ok()?;
        let checkpoints: Vec<u32> = bytes
            .chunks_exact(4)
            .map(|four| four.iter().fold(0, |sum, byte| sum << 8 | u32::from(*byte)))
            .collect();
        let expected = usize::try_from(records / spacing(records)).ok()?;
        if digest.len() != 16 || records == 0 || bytes.len() != 4 * expected {
            return None;
        }
        let digest = u64::from_str_radix(digest, 16).ok()?;
        controllers.push(Fingerprint { digest, records, checkpoints });
    }
    let is_valid = (1..=MAX_CONTROLLERS).contains(&controllers.len());
    is_valid.then_some(RunFingerprint { version, controllers })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(controllers: u64) -> RunFingerprint {
        let one = |k: u64| Fingerprint {
            digest: 0x0123_4567_89ab_cdef * (k + 1),
            records: 10 + 7 * k,
            checkpoints: (0..(10 + 7 * k) / spacing(10 + 7 * k)).map(|i| (i * 0x1234_5678) as u32).collect(),
        };
        RunFingerprint { version: "0.1.0-rc.2".into(), controllers: (0..controllers).map(one).collect() }
    }

    #[test]
    fn emitted_fingerprints_are_parsed_unchanged() {
        for controllers in [1, 2, 32] {
            let fingerprint = example(controllers);
            assert_eq!(RunFingerprint::parse(&fingerprint.emit()), Ok(fingerprint));
        }
        assert!(example(1).emit().starts_with("1.0_1_0-rc_2.0123456789abcdef.10."), "{}", example(1).emit());
        assert_eq!(RunFingerprint::parse(&example(33).emit()), Err(RunFingerprintError::Damaged));
        assert_eq!(RunFingerprint::parse(&example(0).emit()), Err(RunFingerprintError::Damaged));
    }

    #[test]
    fn every_truncation_and_changed_character_is_an_error() {
        let text = example(2).emit();
        for length in 0..text.len() {
            assert_eq!(RunFingerprint::parse(&text[..length]), Err(RunFingerprintError::Damaged), "{length}");
        }
        for at in 0..text.len() {
            for with in ["A", "0", "9", "z", "_", ".", "-", "=", "%", " ", "\u{e9}"] {
                if text[at..=at] != *with {
                    let flipped = format!("{}{with}{}", &text[..at], &text[at + 1..]);
                    RunFingerprint::parse(&flipped).expect_err(&flipped);
                }
            }
        }
    }

    #[test]
    fn the_form_is_checked_before_the_crc() {
        assert_eq!(RunFingerprint::parse("2.what.ever"), Err(RunFingerprintError::Newer { given: 2 }));
        for text in [
            "1",
            "1.0_1_0",
            "1.0_1_0.0123456789abcdef",
            "1.0_1_0.0123456789abcdef.0.",
            "1.0_1_0.0123456789abcdef.1.AAAA",
            "1.0_1_0.0123456789abcdeg.1.AAAAAA",
            "1.0_1_0.123456789abcdef.1.AAAAAA",
            "1.0_1_0.0123456789abcdef.99999999999999999999.AAAAAA",
            "1.0_1_0.0123456789abcdef.18446744073709551615.AAAAAA",
        ] {
            let text = format!("{text}.{:08x}", CRC.checksum(text.as_bytes()));
            assert_eq!(RunFingerprint::parse(&text), Err(RunFingerprintError::Damaged), "{text}");
        }
    }
}
