//! Where an exported table is from: the command that makes it again, and its inputs.

use crate::export::plain_text::needs_escape;
use alloc::{format, string::String, vec::Vec};
use core::fmt::Write;
use crc::{CRC_32_ISO_HDLC, Crc};
use stepscope_scenario::{Scenario, link};

const CRC_32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The options of `stepscope tables` that decide the bytes of a file. Paths are those of the user, as bytes.
#[derive(Clone, Copy, Debug)]
pub struct Request<'r> {
    pub scenario: Option<&'r [u8]>,
    pub steps: Option<&'r [u8]>,
    /// `None` for axis 0.
    pub axis: Option<&'r str>,
    /// `exact`, `document` or `compressed`.
    pub form: &'r str,
    /// The options of a compressed table.
    pub error_us: f64,
    pub interval_part: Option<u32>,
    pub is_early: bool,
    pub is_quick: bool,
    pub entries: &'r str,
    pub language: &'r str,
    pub name: &'r str,
}

/// The lines of a file's head that say where it is from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    pub(super) made_by: String,
    /// The inputs with their CRC-32.
    pub(super) inputs: String,
}

impl Origin {
    /// A table that the command makes again from `scenario`, or from the text of `steps`.
    pub fn new(request: &Request<'_>, scenario: &Scenario, steps: Option<&str>) -> Self {
        let mut inputs = Vec::new();
        if let Some(path) = request.scenario {
            let link = link::encode(scenario).ok();
            let crc = link.as_deref().and_then(|link| link.rsplit_once('.'));
            inputs.push(crc.map_or_else(
                || format!("Scenario {}, too long for a link", quoted(path)),
                |(_, crc)| format!("Scenario {}, CRC-32 {crc} (that of its link)", quoted(path)),
            ));
        }
        if let (Some(path), Some(text)) = (request.steps, steps) {
            let crc = CRC_32.checksum(text.as_bytes());
            inputs.push(format!("Steps {}, CRC-32 {crc:08x} (of the file)", quoted(path)));
        }
        Self { made_by: made_by(&request.command()), inputs: inputs.join(". ") }
    }

    /// A table that no command makes again, such as one of the steps of a recording in the page.
    pub fn of_page(request: &Request<'_>, subject: &str) -> Self {
        let Request { form, entries, error_us, .. } = request;
        let error = if *form == "compressed" { format!(", error {error_us} us") } else { String::new() };
        Self {
            made_by: made_by(&format!("the page, form {form}{error}, entries {entries}")),
            inputs: subject.into(),
        }
    }
}

fn made_by(what: &str) -> String {
    format!("Made by stepscope {}: {what}", env!("CARGO_PKG_VERSION"))
}

impl Request<'_> {
    fn command(&self) -> String {
        let mut command = String::from("stepscope tables");
        let mut path = |option: &str, path: Option<&[u8]>| {
            if let Some(path) = path {
                let _ = write!(command, " {option}{}", quoted(path));
            }
        };
        path("", self.scenario);
        path("--steps ", self.steps);
        let mut option = |name: &str, value: &str| {
            let _ = write!(command, " --{name} {}", quoted(value.as_bytes()));
        };
        if let Some(axis) = self.axis {
            option("axis", axis);
        }
        option("form", self.form);
        if self.form == "compressed" {
            option("error-us", &format!("{}", self.error_us));
            if let Some(part) = self.interval_part {
                option("interval-part", &format!("{part}"));
            }
            if self.is_early {
                option("window", "early");
            }
            if self.is_quick {
                option("search", "quick");
            }
        }
        option("entries", self.entries);
        option("format", self.language);
        option("name", self.name);
        command
    }
}

/// A word as a POSIX shell reads it back, and as a comment of C can hold it.
///
/// ```
/// use stepscope_inspect::export::source_code::quoted;
///
/// assert_eq!(quoted(b"turn.json"), "turn.json");
/// assert_eq!(quoted(b"a turn's.json"), r"'a turn'\''s.json'");
/// assert_eq!(quoted(b"*/\n"), r"$'*\057\012'");
/// ```
pub fn quoted(word: &[u8]) -> String {
    let mut text = String::new();
    if !word.is_empty() && word.iter().copied().all(is_plain) {
        text.extend(word.iter().map(|byte| char::from(*byte)));
        return text;
    }
    let is_printable = core::str::from_utf8(word).is_ok_and(|word| !word.chars().any(needs_escape));
    let ends_comment = |pair: &[u8]| pair == b"*/" || pair == b"/*";
    if is_printable && !word.windows(2).any(ends_comment) {
        return format!("'{}'", String::from_utf8_lossy(word).replace('\'', r"'\''"));
    }
    // Octal escapes, which every shell with $'' has.
    text.push_str("$'");
    for byte in word {
        let _ = match byte {
            b'\'' | b'\\' => write!(text, "\\{}", char::from(*byte)),
            b'/' => write!(text, "\\057"),
            b' '..=b'~' => write!(text, "{}", char::from(*byte)),
            _ => write!(text, "\\{byte:03o}"),
        };
    }
    text.push('\'');
    text
}

fn is_plain(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || b"_./:=@%+,-".contains(&byte)
}

/// The words of a line of [`quoted`] words with spaces between them, as bytes. `None` for any other line.
///
/// ```
/// use stepscope_inspect::export::source_code::unquoted;
///
/// let words = unquoted(r"tables 'a turn'\''s.json' $'*\057'").unwrap();
/// assert_eq!(words, [&b"tables"[..], b"a turn's.json", b"*/"]);
/// assert_eq!(unquoted("tables turn.json > turn.h"), None);
/// ```
pub fn unquoted(line: &str) -> Option<Vec<Vec<u8>>> {
    let (mut words, mut word) = (Vec::new(), None);
    let mut bytes = line.bytes();
    while let Some(byte) = bytes.next() {
        if byte == b' ' {
            words.extend(word.take());
            continue;
        }
        let word: &mut Vec<u8> = word.get_or_insert_default();
        match byte {
            b'\'' => loop {
                match bytes.next()? {
                    b'\'' => break,
                    byte => word.push(byte),
                }
            },
            b'$' if bytes.next()? == b'\'' => loop {
                match bytes.next()? {
                    b'\'' => break,
                    b'\\' => word.push(escaped(&mut bytes)?),
                    byte => word.push(byte),
                }
            },
            b'\\' if bytes.next()? == b'\'' => word.push(b'\''),
            byte if is_plain(byte) => word.push(byte),
            _ => return None,
        }
    }
    words.extend(word);
    Some(words)
}

/// The byte after a backslash: a quote, a backslash, or three octal digits.
fn escaped(bytes: &mut impl Iterator<Item = u8>) -> Option<u8> {
    let digit = |byte: u8| matches!(byte, b'0'..=b'7').then(|| byte - b'0');
    match bytes.next()? {
        byte @ (b'\'' | b'\\') => Some(byte),
        byte => {
            let [high, middle, low] = [digit(byte)?, digit(bytes.next()?)?, digit(bytes.next()?)?];
            high.checked_mul(64)?.checked_add(8 * middle + low)
        }
    }
}
