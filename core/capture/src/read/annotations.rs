//! Reads annotations of sigrok's UART decoder: the output of `sigrok-cli -A uart`, and PulseView's export.
//!
//! ```text
//! uart-1: 41          208-2291 uart-1: rx-data: 41          123-456 UART: RX data: 41          123-456,UART,TX data,41
//! ```
//!
//! Samples are ticks; the file does not give their rate. A byte begins at its start bit if that has an annotation,
//! otherwise at its first data bit. The option `format` is not in the file: all values together determine the base.

use super::base::{Base, Digits, Guess};
use super::recorder::{Names, Recorder, quoted};
use super::{decimal::whole, reading::Reader};
use crate::capture::{Capture, MAX_CHANNELS, TimedByte};
use std::collections::BTreeMap;

const NO_BYTES: &str = "the annotations have no bytes in hexadecimal; print rx-data or tx-data with format=hex (sigrok-cli -A uart=rx-data)";

pub(super) struct Annotations {
    recorder: Recorder,
    /// Whether the lines have samples; unknown before the first.
    timed: Option<bool>,
    lines: BTreeMap<u8, Line>,
    /// Bytes without a start bit are timed by their first data bit.
    has_late_times: bool,
    is_unnamed: bool,
    /// The base depends on all values together.
    values: Vec<Value>,
    digits: Digits,
    is_text: bool,
    has_bits: bool,
    /// 0 and 1 without a class were dropped as bits.
    has_ambiguous_bits: bool,
    others: Names,
}

/// Up to 8 digits of a byte: three of 4 bits or eight of 1 bit, and above them (from bit 12) their number. Packed, because a
/// recording has millions.
#[derive(Clone, Copy)]
struct Value(u16);

impl Value {
    fn of(text: &[u8]) -> Option<Self> {
        let bits = match text.len() {
            1..=3 => 4,
            8 if text.iter().all(|digit| matches!(digit, b'0' | b'1')) => 1,
            _ => return None,
        };
        let packed = text
            .iter()
            .try_fold(0_u16, |packed, digit| Some(packed << bits | char::from(*digit).to_digit(16)? as u16));
        packed.map(|packed| Self((text.len() as u16) << 12 | packed))
    }

    fn byte(self, base: Base) -> Option<u8> {
        let length = match base {
            Base::Hexadecimal => Some(2),
            Base::Octal => Some(3),
            Base::Binary => Some(8),
            Base::Decimal => None,
        };
        if length.is_some_and(|length| length != self.0 >> 12) {
            return None;
        }
        let (count, bits) = (self.0 >> 12, if self.0 >> 12 == 8 { 1 } else { 4 });
        let digit = |at: u16| char::from_digit(u32::from(self.0 >> (at * bits) & ((1 << bits) - 1)), 16);
        let digits: Option<Vec<u8>> =
            (0..count).rev().map(|at| digit(at).and_then(|digit| u8::try_from(digit).ok())).collect();
        base.byte(&digits?)
    }
}

/// The latest of a channel; RX and TX may overlap.
#[derive(Clone, Copy, Default)]
struct Line {
    start: Option<u64>,
    last: Option<(usize, u64)>,
}

struct Annotation {
    samples: Option<(u64, u64)>,
    decoder: String,
    class: String,
    text: String,
}

impl Annotation {
    fn parse(line: &[u8]) -> Option<Self> {
        let line = core::str::from_utf8(line).ok()?.trim();
        let (samples, rest) = match samples(line) {
            Some((samples, rest)) => (Some(samples), rest),
            None => (None, line),
        };
        let separator = [": ", ",", ";"].into_iter().find(|separator| rest.contains(separator))?;
        let parts: Vec<&str> = rest.splitn(4, separator).map(|part| part.trim().trim_matches('"')).collect();
        let (decoder, class, text) = match parts.as_slice() {
            [decoder, text] => (*decoder, "", *text),
            [decoder, class, text] => (*decoder, *class, *text),
            [decoder, _, class, text] => (*decoder, *class, *text),
            _ => return None,
        };
        let is_uart = decoder.to_lowercase().starts_with("uart");
        is_uart.then(|| Self { samples, decoder: decoder.into(), class: class.into(), text: text.into() })
    }

    /// With annotated bits and no class, 0 and 1 are bits, not bytes.
    fn may_be_data(&self, has_bits: bool) -> bool {
        match self.class.to_lowercase().as_str() {
            "" => !has_bits || !matches!(self.text.as_str(), "0" | "1"),
            class => class.contains("data") && !class.contains("bit"),
        }
    }
}

/// A control character as sigrok's format=ascii prints it: `[0D]`.
fn is_control(text: &str) -> bool {
    let inner = text.strip_prefix('[').and_then(|text| text.strip_suffix(']'));
    inner.is_some_and(|text| text.len() == 2 && text.bytes().all(|digit| digit.is_ascii_hexdigit()))
}

/// Splits `123-456` off the beginning of a line.
fn samples(line: &str) -> Option<((u64, u64), &str)> {
    let end = line.find(|letter: char| !letter.is_ascii_digit() && letter != '-')?;
    let (range, rest) = line.split_at(end);
    let (from, to) = range.split_once('-')?;
    let samples = (whole(from.as_bytes())?, whole(to.as_bytes())?);
    (samples.0 <= samples.1).then(|| (samples, rest.trim_start_matches([' ', ',', ';', ':'])))
}

pub(super) fn is_annotation(line: &[u8]) -> bool {
    Annotation::parse(line).is_some()
}

impl Annotations {
    pub(super) const fn new(recorder: Recorder) -> Self {
        Self {
            recorder,
            timed: None,
            lines: BTreeMap::new(),
            has_late_times: false,
            is_unnamed: false,
            values: Vec::new(),
            digits: Digits::new(),
            is_text: false,
            has_bits: false,
            has_ambiguous_bits: false,
            others: Names::new(),
        }
    }

    fn channel(&mut self, annotation: &Annotation) -> Result<u8, String> {
        let class = annotation.class.to_lowercase();
        let name = match () {
            () if class.starts_with("rx") => "RX",
            () if class.starts_with("tx") => "TX",
            () => {
                self.is_unnamed = true;
                annotation.decoder.as_str()
            }
        };
        let channel = self.recorder.channel_named(name);
        channel.ok_or_else(|| format!("more than {MAX_CHANNELS} decoders; export the decoders of one line"))
    }

    fn base(&mut self) -> Result<Base, String> {
        if let Some(base) = self.recorder.base {
            return Ok(base);
        }
        let guess = self.digits.guess();
        let is_hexadecimal =
            matches!(guess, Guess::Certain(Base::Hexadecimal) | Guess::Ambiguous(Base::Hexadecimal, _));
        if self.is_text && !is_hexadecimal {
            return Err(NO_BYTES.into());
        }
        match guess {
            Guess::Certain(Base::Decimal) if self.has_ambiguous_bits => Err(
                "0 and 1 may be bits or decimal bytes; print only the bytes (sigrok-cli -A uart=rx-data) or with \
                 format=hex"
                    .into(),
            ),
            Guess::Certain(base) => {
                if base != Base::Hexadecimal {
                    self.recorder.note(format!("the bytes are read as {}", base.name()));
                }
                Ok(base)
            }
            Guess::Ambiguous(Base::Hexadecimal, _) => {
                self.recorder.note(
                    "the bytes may be hexadecimal or decimal and are read as hexadecimal; if they are decimal, print them with format=hex",
                );
                Ok(Base::Hexadecimal)
            }
            Guess::Ambiguous(one, other) => Err(format!(
                "the bytes may be {} or {}; print them with format=hex (sigrok-cli -P uart:format=hex)",
                one.name(),
                other.name()
            )),
            // Read up to the first value that does not fit.
            Guess::Unknown => Ok(Base::Hexadecimal),
        }
    }

    /// Ends the bytes at the first value that does not fit the base.
    fn set_bytes(&mut self) -> Result<(), String> {
        if self.values.is_empty() {
            return Ok(());
        }
        let base = self.base().inspect_err(|_| self.recorder.capture.bytes.clear())?;
        let mut bytes = self.recorder.capture.bytes.iter_mut().zip(&self.values);
        let wrong = bytes.position(|(byte, value)| {
            let found = value.byte(base);
            byte.byte = found.unwrap_or(0);
            found.is_none()
        });
        let Some(wrong) = wrong else { return Ok(()) };
        self.recorder.capture.bytes.truncate(wrong);
        Err(format!("byte {wrong} (the first is 0) is not {}; print all bytes with format=hex", base.name()))
    }

    /// Takes an annotation that is not a byte: start bits and frame errors are used, others are skipped.
    fn take_other(&mut self, annotation: &Annotation, may_be_data: bool) -> Result<(), String> {
        let text = annotation.text.to_lowercase();
        self.is_text |= may_be_data && (annotation.text.chars().count() == 1 || is_control(&annotation.text));
        self.has_ambiguous_bits |= annotation.class.is_empty() && matches!(text.as_str(), "0" | "1");
        if matches!(text.as_str(), "start bit" | "start" | "s") {
            self.has_bits = true;
            let channel = self.channel(annotation)?;
            self.line(channel).start = annotation.samples.map(|(from, _)| from);
        } else if text.starts_with("frame error") {
            let channel = self.channel(annotation)?;
            let last = self.line(channel).last;
            if let Some(byte) = last.and_then(|(at, _)| self.recorder.capture.bytes.get_mut(at)) {
                byte.framing_error = true;
            }
        } else {
            self.others.add(&annotation.text);
        }
        Ok(())
    }

    fn line(&mut self, channel: u8) -> &mut Line {
        self.lines.entry(channel).or_default()
    }
}

impl Reader for Annotations {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        if line.trim_ascii().is_empty() {
            return Ok(());
        }
        let annotation = Annotation::parse(line).ok_or_else(|| {
            format!(
                "{} is not a UART annotation; use lines such as uart-1: 41 or 208-2291 uart-1: 41",
                quoted(line)
            )
        })?;
        let is_timed = annotation.samples.is_some();
        if *self.timed.get_or_insert(is_timed) != is_timed {
            return Err(format!(
                "{} {} sample numbers, unlike the lines before; export all lines with them, or all without",
                quoted(line),
                if is_timed { "has" } else { "has no" },
            ));
        }
        let may_be_data = annotation.may_be_data(self.has_bits);
        let value = Value::of(annotation.text.as_bytes()).filter(|_| may_be_data);
        let Some(value) = value else { return self.take_other(&annotation, may_be_data) };
        let channel = self.channel(&annotation)?;
        let index = self.recorder.capture.bytes.len();
        let Line { start, last } = core::mem::take(self.line(channel));
        let tick = match (annotation.samples, start) {
            (Some(_), Some(start)) => start,
            (Some((from, _)), None) => {
                self.has_late_times = true;
                from
            }
            (None, _) => index as u64,
        };
        if let Some((_, before)) = last.filter(|(_, before)| tick < *before) {
            return Err(format!(
                "sample {tick} follows sample {before} of the same channel; sort the lines by sample and use one recording per file"
            ));
        }
        self.line(channel).last = Some((index, tick));
        self.recorder.byte(TimedByte { tick, channel, byte: 0, framing_error: false })?;
        self.digits.take(annotation.text.as_bytes());
        self.values.try_reserve(1).map_err(|_| "not enough memory for more bytes; export a shorter time")?;
        self.values.push(value);
        Ok(())
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        let found = self.set_bytes();
        self.recorder.sort_bytes();
        self.recorder.note_skipped("other annotations", &self.others);
        if self.has_late_times {
            self.recorder
                .note("bytes without an annotated start bit are timed by their first data bit, one bit late");
        }
        let is_empty = self.recorder.capture.is_empty();
        let named = |name: &str| self.recorder.capture.channels.iter().any(|channel| channel.name == name);
        if named("RX") && named("TX") {
            self.recorder.note(
                "RX and TX are named as in the decoder; if its TX is the line to the controller, map RX=TX,TX=RX",
            );
        }
        if self.is_unnamed && !is_empty {
            self.recorder.note("no annotation names RX or TX: all bytes are assigned to one line");
        }
        let result = if found.is_err() {
            found
        } else if is_empty {
            Err(NO_BYTES.into())
        } else {
            Ok(())
        };
        (self.recorder.finish(), result)
    }
}
