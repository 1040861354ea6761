//! Reads bytes in hexadecimal from terminals, serial sniffers and logs, with or without times.
//!
//! ```text
//! 55 AA 0x01,02      # a comment         0.00125: 55 AA 01         t_us,bytes
//! 55AA0102           // another          12.5us RX 55              12.5,55 AA 01
//!
//! 2026-11-26T12:00:00.123456 RX: 55 AA       [12:00:00.123] 55 AA       2006-05-30 13:23:49.461075: /dev/ttyS0
//! 26.11.2026 12:00:00.123 [TX] - 55 AA       [ 12.345678] >> 55 AA      55 AA 01 02        U...
//! ```
//!
//! Bytes of one timed line have the same tick. Without times a byte's tick is its index. RX and TX are channels.

use super::hex_table::{self, Table};
use super::log_line::{
    BYTES, ByteCount, LinePrefix, Time, direction, trailing_direction, without_comment, word,
};
use super::recorder::{Recorder, quoted};
use super::times::{TimeUnit, Times};
use super::{base::Base, reading::Reader, row};
use crate::capture::{Capture, MAX_CHANNELS, TimedByte};

pub(super) struct HexText {
    recorder: Recorder,
    times: Times,
    table: Option<Table>,
    base: Base,
    /// Whether the lines have times; unknown before the first.
    timed: Option<bool>,
    has_first_line: bool,
    has_minutes: bool,
    /// Byte counts in brackets that do not match their lines.
    wrong_lengths: u64,
    bytes: Vec<u8>,
    /// A line with a time and no bytes applies to the lines after it.
    block: Option<Block>,
}

#[derive(Clone)]
struct Block {
    tick: u64,
    port: String,
}

impl HexText {
    pub(super) fn new(recorder: Recorder, table: Option<Table>) -> Self {
        let base = recorder.base.or(table.map(|table| table.base)).unwrap_or(Base::Hexadecimal);
        Self {
            recorder,
            base,
            has_minutes: false,
            wrong_lengths: 0,
            times: Times::new(table.map_or(TimeUnit::Seconds(0), |table| table.unit)),
            table,
            timed: None,
            has_first_line: false,
            bytes: Vec::new(),
            block: None,
        }
    }

    fn channel(&mut self, name: &str) -> Result<u8, String> {
        let channel = self.recorder.channel_named(name);
        channel.ok_or_else(|| format!("more than {MAX_CHANNELS} ports; split the log"))
    }

    fn push(&mut self, tick: Option<u64>, channel: u8) -> Result<(), String> {
        for at in 0..self.bytes.len() {
            let byte = self.bytes.get(at).copied().unwrap_or(0);
            let tick = tick.unwrap_or(self.recorder.capture.bytes.len() as u64);
            self.recorder.byte(TimedByte { tick, channel, byte, framing_error: false })?;
        }
        Ok(())
    }

    fn push_counted_bytes(&mut self, text: &[u8], is_log: bool) -> Result<(), String> {
        let Some(length) = ByteCount::parse(text) else { return self.push_bytes(text, is_log) };
        self.push_bytes(length.rest, is_log)?;
        if length.matches(self.bytes.len()) {
            return Ok(());
        }
        if !is_log || !length.is_decimal() || length.text.ends_with(b":") {
            return Err(format!(
                "{} before {} may be a byte or a byte count; remove it, or write all bytes in one form",
                quoted(length.text),
                quoted(length.rest.trim_ascii())
            ));
        }
        self.wrong_lengths += 1;
        Ok(())
    }

    fn push_bytes(&mut self, text: &[u8], is_log: bool) -> Result<(), String> {
        if self.base == Base::Hexadecimal {
            return parse_bytes(text, &mut self.bytes, is_log);
        }
        let words = without_comment(text).split(|byte| byte.is_ascii_whitespace() || b",;".contains(byte));
        for word in words.filter(|word| !word.is_empty()) {
            let byte = self.base.byte(word).ok_or_else(|| {
                format!("{} is not a {} byte; use 0 to 255", quoted(word), self.base.name())
            })?;
            self.bytes.push(byte);
        }
        Ok(())
    }

    fn untimed_line(&mut self, line: &[u8]) -> Result<(), String> {
        self.bytes.clear();
        // Without times the two directions have no common order.
        if direction(word(line).0).is_some() || trailing_direction(line).is_some() {
            return Err(format!(
                "{} has a direction but no time; use a time on each line, or bytes of one direction only",
                quoted(line)
            ));
        }
        self.push_counted_bytes(line, false)?;
        if let Some(Block { tick, port }) = self.block.clone() {
            let channel = self.channel(&port)?;
            return self.push(Some(tick), channel);
        }
        if self.timed == Some(true) {
            return Err(format!(
                "{} has no time, but earlier lines have one; use a time on each line or on none",
                quoted(line)
            ));
        }
        self.timed = Some(false);
        let channel = self.channel(BYTES)?;
        self.push(None, channel)
    }
}

impl Reader for HexText {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.trim_ascii();
        if without_comment(line).is_empty() {
            return Ok(());
        }
        if !core::mem::replace(&mut self.has_first_line, true)
            && self.table.is_some()
            && hex_table::is_head(line)
        {
            return Ok(());
        }
        let Some(start) = LinePrefix::parse(line, self.table)? else { return self.untimed_line(line) };
        if self.timed == Some(false) {
            return Err(format!(
                "{} has a time, but earlier lines have none; use a time on each line or on none",
                quoted(line)
            ));
        }
        self.timed = Some(true);
        let LinePrefix { time, port, rest } = start;
        let tick = match time {
            Time::Number(time) => self.times.tick_of(time, line, &mut self.recorder)?,
            Time::Ticks(text) => self.times.tick(text, &mut self.recorder)?,
            Time::Clock(stamp) => {
                self.has_minutes |= !stamp.has_seconds;
                self.times.stamp_tick(stamp, line, &mut self.recorder)?
            }
        };
        self.recorder.capture.end = tick;
        self.bytes.clear();
        if without_comment(rest).is_empty() {
            self.block = Some(Block { tick, port });
            return Ok(());
        }
        self.block = None;
        let trailing = trailing_direction(rest).filter(|_| port == BYTES && self.table.is_none());
        let (port, rest) = trailing.map_or((port, rest), |(direction, rest)| (direction.to_owned(), rest));
        self.push_counted_bytes(rest, matches!(time, Time::Clock(_)) || port != BYTES)?;
        let channel = self.channel(&port)?;
        self.push(Some(tick), channel)
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        self.times.finish(&mut self.recorder);
        let named = |name: &str| self.recorder.capture.channels.iter().any(|channel| channel.name == name);
        if named("RX") && named("TX") {
            self.recorder.note(
                "RX and TX are named as in the log; if the host wrote the log, map RX=TX,TX=RX: the host's TX is the controller's RX",
            );
        }
        if self.table.is_some_and(|table| table.is_ambiguous) && self.recorder.base.is_none() {
            self.recorder.note(
                "the bytes may be hexadecimal or decimal and are read as hexadecimal; if they are decimal, name the column dec (t_us,dec)",
            );
        }
        if self.has_minutes {
            self.recorder.note("times have no seconds, so all bytes of a minute have the same time");
        }
        if self.wrong_lengths > 0 {
            self.recorder.note(format!(
                "{} numbers in brackets differ from the number of bytes in their lines and are skipped",
                self.wrong_lengths
            ));
        }
        let capture = self.recorder.finish();
        let missing =
            if capture.is_empty() { Err("the file has no bytes; record again".into()) } else { Ok(()) };
        (capture, missing)
    }
}

pub(super) fn is_log(line: &[u8]) -> bool {
    let found = LinePrefix::parse(line, None);
    found.is_ok_and(|start| {
        start.is_some_and(|start| matches!(start.time, Time::Clock(_)) || line.starts_with(b"["))
    })
}

pub(super) fn is_line(line: &[u8]) -> bool {
    let mut bytes = Vec::new();
    match LinePrefix::parse(line, None) {
        Ok(Some(start)) => {
            let text = trailing_direction(start.rest).map_or(start.rest, |(_, text)| text);
            parse_bytes(text, &mut bytes, false).is_ok()
        }
        Ok(None) => direction(word(line).0).is_some() || parse_bytes(line, &mut bytes, false).is_ok(),
        Err(_) => false,
    }
}

/// Accepts `55 AA   U.`, `0x55,0xAA`, `[55;aa]`, `55AA`, `\x55`. A single digit in a log may be a count.
fn parse_bytes(text: &[u8], bytes: &mut Vec<u8>, is_log: bool) -> Result<(), String> {
    let text = text.trim_ascii();
    match row::parse(text, bytes) {
        // With commas, a number of many digits among others is not a byte.
        Ok(shape) if shape.group == 1 || shape.has_text || !text.contains(&b',') && !text.contains(&b';') => {
            return Ok(());
        }
        _ => bytes.clear(),
    }
    let words = without_comment(text)
        .split(|byte| byte.is_ascii_whitespace() || b",;:|-_[](){}<>\"'\\".contains(byte))
        .filter(|word| !word.is_empty());
    let is_one = words.clone().count() == 1;
    for word in words {
        let digits =
            [&b"0x"[..], b"0X", b"x", b"$"].iter().find_map(|mark| word.strip_prefix(*mark)).unwrap_or(word);
        let digits = digits.strip_suffix(b"h").unwrap_or(digits);
        let is_short = is_log && digits.len() == 1 && digits.len() == word.len();
        let is_long = digits.len() > 2 && (!is_one || !digits.len().is_multiple_of(2));
        if digits.is_empty() || is_short || is_long || !digits.iter().all(u8::is_ascii_hexdigit) {
            return Err(row::not_a_byte(word));
        }
        row::push_digits(digits, bytes);
    }
    Ok(())
}
