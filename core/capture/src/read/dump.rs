//! Reads hexadecimal dumps: `hexdump -C`, `xxd`, `od -t x1`, and a terminal's.
//!
//! ```text
//! 00000000  44 45 41 44  |DEAD|      00000000: 55aa 0102  U...      0000000 44 45      0000: 62 65      be
//! 00000010                           00000010: 6162       ab        0000020            0010: 01
//! ```
//!
//! Offsets are checked: each row begins where the one before has ended, and `*` repeats the row before.

use super::reading::Reader;
use super::recorder::{Recorder, grouped, quoted};
use super::row::{self, RowFormat};
use crate::capture::{Capture, TimedByte};

const BASES: [u64; 3] = [16, 8, 10];
const MIN_DIGITS: usize = 4;
/// A terminal may truncate rows that begin at multiples of these.
const WIDTHS: [u64; 3] = [8, 16, 32];

pub(super) struct HexDump {
    recorder: Recorder,
    /// The next offset in each base that fits so far.
    next_offsets: [Option<u64>; 3],
    previous_offset: String,
    previous_row: Vec<u8>,
    /// Bytes of the longest row.
    width: u64,
    /// The last line was `*`.
    repeats: bool,
    has_ended: bool,
    has_offset: bool,
    is_order_known: bool,
    short_rows: u64,
}

impl HexDump {
    pub(super) fn new(mut recorder: Recorder) -> Self {
        recorder.channel("bytes");
        Self {
            recorder,
            next_offsets: [Some(0); 3],
            previous_offset: String::new(),
            previous_row: Vec::new(),
            width: 0,
            repeats: false,
            has_ended: false,
            has_offset: false,
            is_order_known: false,
            short_rows: 0,
        }
    }

    fn check_offset(&mut self, offset: &Offset<'_>) -> Result<(), String> {
        let values = BASES.map(|base| offset.value(base));
        if !core::mem::replace(&mut self.has_offset, true) {
            self.next_offsets = values;
            for (next, base) in self.next_offsets.iter_mut().zip(BASES) {
                *next = next.filter(|_| offset.may_be(base));
            }
            return Ok(());
        }
        let mut counts = Vec::new();
        let (repeats, width, before) =
            (core::mem::take(&mut self.repeats), self.width, self.previous_row.len() as u64);
        for (next, value) in self.next_offsets.iter_mut().zip(values) {
            let more = next.zip(value).and_then(|(next, value)| value.checked_sub(next));
            let is_right = |more: u64| {
                if repeats { more > 0 && width > 0 && more.is_multiple_of(width) } else { more == 0 }
            };
            *next = if more.is_some_and(is_right) { value } else { None };
            if let (Some(_), Some(more)) = (*next, more) {
                counts.push(more.checked_div(width).unwrap_or(0));
            }
        }
        if counts.is_empty() {
            if !repeats && let Some(start) = self.offset_after_short_row(offset) {
                self.short_rows += 1;
                self.next_offsets = [Some(start), None, None];
                return Ok(());
            }
            return Err(format!(
                "the offset {} does not follow {} and its {before} bytes{}; dump again: rows are missing or damaged",
                quoted(offset.digits),
                quoted(self.previous_offset.as_bytes()),
                if repeats { ", repeated" } else { "" },
            ));
        }
        let first = counts.first().copied().unwrap_or(0);
        if repeats && counts.iter().any(|count| *count != first) {
            return Err(format!(
                "the offset {} after * may be hexadecimal, octal or decimal; dump without *: od -v or hexdump -v",
                quoted(offset.digits)
            ));
        }
        if repeats {
            self.repeat(first)?;
        }
        Ok(())
    }

    /// The offset of a row after a short one: a terminal starts a new row for each block of bytes.
    fn offset_after_short_row(&self, offset: &Offset<'_>) -> Option<u64> {
        let start = offset.value(16).filter(|_| offset.colon && offset.digits.len() < 8)?;
        let previous = Offset::of(self.previous_offset.as_bytes())?.value(16)?;
        let is_width = |width: &u64| {
            self.previous_row.len() < *width as usize
                && previous.is_multiple_of(*width)
                && previous.checked_add(*width) == Some(start)
        };
        WIDTHS.iter().any(is_width).then_some(start)
    }

    fn repeat(&mut self, count: u64) -> Result<(), String> {
        let (max_rows, there) = (self.recorder.max_rows(), self.recorder.capture.bytes.len());
        let more = count.saturating_mul(self.previous_row.len() as u64);
        if more > max_rows.saturating_sub(there) as u64 {
            return Err(format!(
                "* repeats {} bytes, more than the maximum of {}; dump a shorter part",
                grouped(more),
                grouped(max_rows as u64)
            ));
        }
        for _ in 0..count {
            for at in 0..self.previous_row.len() {
                let byte = self.previous_row.get(at).copied().unwrap_or(0);
                push(&mut self.recorder, byte)?;
            }
        }
        Ok(())
    }
}

fn has_words(line: &[u8]) -> String {
    format!(
        "{} contains words, whose byte order depends on the machine; dump single bytes: hexdump -C, xxd -g1, or od -A x \
         -t x1",
        quoted(line)
    )
}

fn push(recorder: &mut Recorder, byte: u8) -> Result<(), String> {
    let tick = recorder.capture.bytes.len() as u64;
    recorder.byte(TimedByte { tick, channel: 0, byte, framing_error: false })
}

struct Offset<'l> {
    digits: &'l [u8],
    colon: bool,
    rest: &'l [u8],
}

impl<'l> Offset<'l> {
    fn of(line: &'l [u8]) -> Option<Self> {
        let line = line.trim_ascii();
        let marked = [&b"0x"[..], b"0X"].iter().find_map(|mark| line.strip_prefix(*mark));
        let text = marked.unwrap_or(line);
        let length = text.iter().take_while(|byte| byte.is_ascii_hexdigit()).count();
        let (digits, rest) = text.split_at(length);
        let rest = rest.strip_prefix(b"h").unwrap_or(rest);
        let (colon, rest) = match rest.strip_prefix(b":") {
            Some(rest) => (true, rest),
            None => (false, rest),
        };
        let is_number = (MIN_DIGITS..=16).contains(&length) && (marked.is_none() || colon);
        let is_apart = rest.first().is_none_or(u8::is_ascii_whitespace);
        (is_number && is_apart).then_some(Self { digits, colon, rest })
    }

    fn value(&self, base: u64) -> Option<u64> {
        self.digits.iter().try_fold(0_u64, |value, digit| {
            let digit = char::from(*digit).to_digit(base as u32)?;
            value.checked_mul(base)?.checked_add(digit.into())
        })
    }

    /// `od` writes seven digits, octal by default.
    fn may_be(&self, base: u64) -> bool {
        match base {
            16 => true,
            10 => self.colon || self.digits.len() == 7,
            _ => !self.colon && self.digits.len() == 7,
        }
    }
}

pub(super) fn is_dump(lines: &[&[u8]]) -> bool {
    let Some(first) = lines.first().and_then(|line| Offset::of(line)) else { return false };
    let mut bytes = Vec::new();
    let is_row = row::parse(first.rest, &mut bytes).is_ok() && !bytes.is_empty();
    let is_zero = first.digits.iter().all(|digit| *digit == b'0');
    // A dump from offset 0 with invalid bytes is still a dump; the reader reports the bytes.
    let words = first.rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let is_words = words.count() > 1;
    if is_zero && first.digits.len() > MIN_DIGITS && (is_row || is_words) || first.colon && is_row {
        return true;
    }
    let next = lines.get(1).and_then(|line| Offset::of(line));
    let follows = |base: &u64| {
        let end = first.value(*base).and_then(|start| start.checked_add(bytes.len() as u64));
        end.is_some() && next.as_ref().and_then(|next| next.value(*base)) == end
    };
    is_row && (BASES.iter().any(follows) || is_zero && lines.get(1).is_none_or(|line| *line == b"*"))
}

impl Reader for HexDump {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.trim_ascii();
        if line.is_empty() {
            return Ok(());
        }
        if self.has_ended {
            return Err(format!(
                "{} follows the last offset of the dump; use one dump per file",
                quoted(line)
            ));
        }
        if line == b"*" {
            if self.previous_row.is_empty() || core::mem::replace(&mut self.repeats, true) {
                return Err("* must follow the row that it repeats; dump again".into());
            }
            return Ok(());
        }
        let offset = Offset::of(line).ok_or_else(|| {
            format!("{} does not begin with an offset like the rows before it; dump again", quoted(line))
        })?;
        self.check_offset(&offset)?;
        if offset.rest.trim_ascii().is_empty() {
            self.has_ended = true;
            return Ok(());
        }
        let mut bytes = Vec::new();
        let shape = row::parse(offset.rest, &mut bytes).map_err(|message| {
            if !offset.colon && self.previous_row.is_empty() { has_words(line) } else { message }
        })?;
        let RowFormat { group, is_order_known, .. } = shape;
        self.is_order_known |= is_order_known;
        // xxd writes pairs in order; longer groups may be reversed (xxd -e).
        if !offset.colon && group > 1 || group > 2 && !self.is_order_known {
            return Err(has_words(line));
        }
        for &byte in &bytes {
            push(&mut self.recorder, byte)?;
        }
        for next in &mut self.next_offsets {
            *next = next.and_then(|next| next.checked_add(bytes.len() as u64));
        }
        self.width = self.width.max(bytes.len() as u64);
        self.previous_row = bytes;
        self.previous_offset = String::from_utf8_lossy(offset.digits).into_owned();
        Ok(())
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        if self.short_rows > 0 {
            self.recorder.note(match self.short_rows {
                1 => "1 row is shorter than its offset indicates; its bytes are used unchanged".into(),
                count => format!(
                    "{} rows are shorter than their offsets indicate; their bytes are used unchanged",
                    grouped(count)
                ),
            });
        }
        let missing = if self.repeats {
            Err("the dump ends with *, so the number of repeated rows is unknown; dump again with its last line".into())
        } else if self.recorder.capture.is_empty() {
            Err("the file has no bytes; record again".into())
        } else {
            Ok(())
        };
        (self.recorder.finish(), missing)
    }
}
