//! Annotations of sigrok's decoder of serial lines: what `sigrok-cli -A uart` prints, and PulseView's export.
//!
//! ```text
//! uart-1: 41          208-2291 uart-1: rx-data: 41          123-456 UART: RX data: 41          123-456,UART,TX data,41
//! ```
//!
//! Samples are ticks; the file does not give their rate. A byte's annotation begins with its first bit of data; where the
//! start bit before it has an annotation, the byte begins there.

use super::{
    decimal::whole,
    reading::Reader,
    recorder::{Names, Recorder, quoted},
};
use crate::capture::{Capture, MAX_CHANNELS, TimedByte};
use std::collections::BTreeMap;

/// Annotations that are being read.
pub(super) struct Annotations {
    recorder: Recorder,
    /// Whether the lines have samples; not known before the first.
    timed: Option<bool>,
    /// What came last on each channel.
    lines: BTreeMap<u8, Line>,
    /// Whether a byte has no start bit before it.
    is_data: bool,
    /// Whether no annotation names RX or TX.
    is_unnamed: bool,
    others: Names,
}

/// What came last on a channel: RX and TX may overlap.
#[derive(Clone, Copy, Default)]
struct Line {
    /// First sample of the start bit that has no byte yet.
    start: Option<u64>,
    /// Index and tick of the last byte.
    last: Option<(usize, u64)>,
}

/// A line of annotations.
struct Annotation {
    samples: Option<(u64, u64)>,
    /// The decoder, the row or class, and the text.
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

    /// The byte, if it is one: two hexadecimal digits of a class of data.
    fn byte(&self) -> Option<u8> {
        let class = self.class.to_lowercase();
        let is_data = class.is_empty() || class.contains("data") && !class.contains("bit");
        let is_pair = self.text.len() == 2 && self.text.bytes().all(|byte| byte.is_ascii_hexdigit());
        if is_data && is_pair { u8::from_str_radix(&self.text, 16).ok() } else { None }
    }
}

/// `123-456` at the beginning of a line, and what follows it.
fn samples(line: &str) -> Option<((u64, u64), &str)> {
    let end = line.find(|letter: char| !letter.is_ascii_digit() && letter != '-')?;
    let (range, rest) = line.split_at(end);
    let (from, to) = range.split_once('-')?;
    let samples = (whole(from.as_bytes())?, whole(to.as_bytes())?);
    (samples.0 <= samples.1).then(|| (samples, rest.trim_start_matches([' ', ',', ';', ':'])))
}

/// Whether a line is an annotation of a serial line.
pub(super) fn is_annotation(line: &[u8]) -> bool {
    Annotation::parse(line).is_some()
}

impl Annotations {
    pub(super) const fn new(recorder: Recorder) -> Self {
        Self {
            recorder,
            timed: None,
            lines: BTreeMap::new(),
            is_data: false,
            is_unnamed: false,
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
        channel.ok_or_else(|| format!("more than {MAX_CHANNELS} decoders; export those of one line"))
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
                "{} {} samples, and the lines before {}; export all with them, or all without",
                quoted(line),
                if is_timed { "has" } else { "has no" },
                if is_timed { "have none" } else { "have" },
            ));
        }
        let text = annotation.text.to_lowercase();
        let Some(byte) = annotation.byte() else {
            if text == "start bit" || text == "start" || text == "s" {
                let channel = self.channel(&annotation)?;
                self.line(channel).start = annotation.samples.map(|(from, _)| from);
            } else if text.starts_with("frame error") {
                let channel = self.channel(&annotation)?;
                let last = self.line(channel).last;
                if let Some(byte) = last.and_then(|(at, _)| self.recorder.capture.bytes.get_mut(at)) {
                    byte.framing_error = true;
                }
            }
            self.others.add(&annotation.text);
            return Ok(());
        };
        let channel = self.channel(&annotation)?;
        let place = self.recorder.capture.bytes.len();
        let Line { start, last } = core::mem::take(self.line(channel));
        let tick = match (annotation.samples, start) {
            (Some(_), Some(start)) => start,
            (Some((from, _)), None) => {
                self.is_data = true;
                from
            }
            (None, _) => place as u64,
        };
        if let Some((_, before)) = last.filter(|(_, before)| tick < *before) {
            return Err(format!(
                "sample {tick} comes after sample {before} of the same line; sort the lines by sample, and give one \
                 recording per file"
            ));
        }
        self.line(channel).last = Some((place, tick));
        self.recorder.byte(TimedByte { tick, channel, byte, framing_error: false })
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        self.recorder.sort_bytes();
        if !self.others.is_empty() {
            self.recorder.leave_out(format!("other annotations skipped: {}", self.others.told()));
        }
        if self.is_data {
            self.recorder.leave_out(
                "bytes without an annotated start bit are timed by their first data bit, one bit late".into(),
            );
        }
        let is_empty = self.recorder.capture.is_empty();
        if self.is_unnamed && !is_empty {
            self.recorder
                .leave_out("no annotation names RX or TX: all bytes are assigned to one line".into());
        }
        let missing = if is_empty {
            Err("the annotations have no bytes in hexadecimal; print rx-data or tx-data with format=hex (sigrok-cli -A uart=rx-data)".into())
        } else {
            Ok(())
        };
        (self.recorder.finish(), missing)
    }
}
