//! Bytes of a line in hexadecimal, as terminals and serial sniffers write them, with times or without.
//!
//! ```text
//! 55 AA 0x01,02      # a comment         0.00125: 55 AA 01         t_us,bytes
//! 55AA0102           // another          12.5us 55                 12.5,55 AA 01
//! ```
//!
//! Bytes of one line of a time have the same tick. Without times a byte's tick is its place.

use super::{
    decimal::Decimal,
    fields::separator,
    reading::Reader,
    recorder::{Recorder, quoted},
    times::{TimeUnit, Times},
};
use crate::capture::{Capture, TimedByte};

/// Bytes that are being read.
pub(super) struct HexText {
    recorder: Recorder,
    times: Times,
    /// Where the file has a head: what separates its times from their bytes, and their unit.
    table: Option<(u8, TimeUnit)>,
    /// Whether the lines have times; not known before the first.
    timed: Option<bool>,
    /// Whether lines begin with addresses.
    addresses: bool,
    any: bool,
    bytes: Vec<u8>,
}

impl HexText {
    pub(super) fn new(mut recorder: Recorder) -> Self {
        recorder.channel("bytes");
        Self {
            recorder,
            times: Times::new(TimeUnit::Seconds(0)),
            table: None,
            timed: None,
            addresses: false,
            any: false,
            bytes: Vec::new(),
        }
    }
}

impl Reader for HexText {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let line = without_comment(line);
        if line.is_empty() {
            return Ok(());
        }
        if !core::mem::replace(&mut self.any, true)
            && let Some(table) = head(line)
        {
            self.table = Some(table);
            return Ok(());
        }
        let (start, bytes) = split(line, self.table)?;
        self.addresses |= start == Start::Address;
        self.bytes.clear();
        parse_bytes(bytes, &mut self.bytes)?;
        let time = match start {
            Start::Time(time) => Some(time),
            Start::Address | Start::Bytes => None,
        };
        if *self.timed.get_or_insert(time.is_some()) != time.is_some() {
            return Err(format!(
                "{} {} a time, and the lines before {} one; give each line a time, or none",
                quoted(line),
                if time.is_some() { "has" } else { "has not" },
                if time.is_some() { "have not" } else { "have" },
            ));
        }
        let tick = match time {
            Some(time) => Some(self.times.tick_of(time, line, &mut self.recorder)?),
            None => None,
        };
        for &byte in &self.bytes {
            let tick = tick.unwrap_or(self.recorder.capture.bytes.len() as u64);
            self.recorder.byte(TimedByte { tick, channel: 0, byte, framing_error: false })?;
        }
        Ok(())
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        if self.addresses {
            self.recorder.leave_out("addresses before “:” at the beginning of lines".into());
        }
        self.times.finish(&mut self.recorder);
        let capture = self.recorder.finish();
        let missing = if capture.is_empty() { Err("the file has no bytes".into()) } else { Ok(()) };
        (capture, missing)
    }
}

/// What a line begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// In s.
    Time(Decimal),
    /// Where its bytes stand in a memory.
    Address,
    Bytes,
}

/// The line up to `#` or `//`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let sharp = line.iter().position(|byte| *byte == b'#').unwrap_or(line.len());
    let slashes = line.windows(2).position(|pair| pair == b"//").unwrap_or(line.len());
    line.get(..sharp.min(slashes)).unwrap_or(line).trim_ascii()
}

/// A head such as `t_s,bytes`.
pub(super) fn head(line: &[u8]) -> Option<(u8, TimeUnit)> {
    let separator = separator(line);
    let mut names = line.split(|byte| *byte == separator).map(|name| name.trim_ascii());
    let unit = TimeUnit::of_column(core::str::from_utf8(names.next()?).ok()?)?;
    let bytes = names.next()?.to_ascii_lowercase();
    let known = [&b"bytes"[..], b"byte", b"data", b"hex", b"value"].contains(&&bytes[..]);
    (known && unit != TimeUnit::Cycles && names.next().is_none()).then_some((separator, unit))
}

/// Whether a line can be read.
pub(super) fn is_line(line: &[u8]) -> bool {
    let mut bytes = Vec::new();
    split(line, None).is_ok_and(|(_, text)| parse_bytes(text, &mut bytes).is_ok())
}

/// A line's beginning, and its bytes.
fn split(line: &[u8], table: Option<(u8, TimeUnit)>) -> Result<(Start, &[u8]), String> {
    if let Some((separator, unit)) = table {
        let end = line.iter().position(|byte| *byte == separator).unwrap_or(line.len());
        let (time, bytes) = line.split_at(end);
        let time = seconds(time.trim_ascii(), unit).ok_or_else(|| not_a_time(time))?;
        return Ok((Start::Time(time), bytes));
    }
    if let Some(colon) = line.iter().position(|byte| *byte == b':')
        && let (before, [_, bytes @ ..]) = line.split_at(colon)
    {
        let before = before.trim_ascii();
        if before.len() >= 4 && before.iter().all(u8::is_ascii_hexdigit) {
            return Ok((Start::Address, bytes));
        }
        let (number, unit) = with_unit(before);
        let time = seconds(number, unit.unwrap_or(TimeUnit::Seconds(0))).ok_or_else(|| not_a_time(before))?;
        return Ok((Start::Time(time), bytes));
    }
    // Without a colon it is the unit that makes a time of a number.
    let first =
        line.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b',').unwrap_or(line.len());
    let (before, bytes) = line.split_at(first);
    if let (number, Some(unit)) = with_unit(before)
        && let Some(time) = seconds(number, unit)
    {
        return Ok((Start::Time(time), bytes));
    }
    let second = bytes.trim_ascii_start();
    let length = second.iter().position(u8::is_ascii_whitespace).unwrap_or(second.len());
    let (word, bytes) = second.split_at(length);
    if let (b"", Some(unit)) = with_unit(word)
        && let Some(time) = seconds(before, unit)
    {
        return Ok((Start::Time(time), bytes));
    }
    Ok((Start::Bytes, line))
}

fn not_a_time(text: &[u8]) -> String {
    format!("{} is not a time; give a number, such as 0.00125 or 12.5us", quoted(text))
}

/// A number and the unit behind it.
fn with_unit(text: &[u8]) -> (&[u8], Option<TimeUnit>) {
    let end = text.iter().rposition(|byte| byte.is_ascii_digit() || *byte == b'.').map_or(0, |last| last + 1);
    let (number, unit) = text.split_at(end);
    let unit = core::str::from_utf8(unit).ok().and_then(|unit| TimeUnit::parse(unit.trim()));
    (number.trim_ascii(), unit.filter(|unit| *unit != TimeUnit::Cycles))
}

fn seconds(number: &[u8], unit: TimeUnit) -> Option<Decimal> {
    let TimeUnit::Seconds(places) = unit else { return None };
    Decimal::parse(number).and_then(|number| number.shifted(-i32::try_from(places).ok()?))
}

/// Bytes between any separators: `55 AA`, `0x55,0xAA`, `[55;aa]`, `55AA`, `\x55`.
fn parse_bytes(text: &[u8], bytes: &mut Vec<u8>) -> Result<(), String> {
    let words = text.split(|byte| byte.is_ascii_whitespace() || b",;:|-_[](){}<>\"'".contains(byte));
    for word in words.filter(|word| !word.is_empty()) {
        for part in word.split(|byte| *byte == b'\\') {
            let digits =
                [&b"0x"[..], b"0X", b"x"].iter().find_map(|mark| part.strip_prefix(*mark)).unwrap_or(part);
            let digits = digits.strip_suffix(b"h").unwrap_or(digits);
            if part.is_empty() {
                continue;
            }
            let odd = digits.len() > 1 && !digits.len().is_multiple_of(2);
            if digits.is_empty() || odd || !digits.iter().all(u8::is_ascii_hexdigit) {
                return Err(format!(
                    "{} is not a byte; give each as two hexadecimal digits, with or without 0x, such as 55 AA 0x01",
                    quoted(word)
                ));
            }
            let value = |digits: &[u8]| {
                digits
                    .iter()
                    .fold(0, |value, digit| value << 4 | char::from(*digit).to_digit(16).unwrap_or(0) as u8)
            };
            bytes.extend(digits.chunks(2).map(value));
        }
    }
    Ok(())
}
