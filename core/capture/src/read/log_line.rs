//! Reads the beginning of a log's line: time, direction or port, and byte count.

use super::decimal::{Decimal, whole};
use super::{clock::Stamp, hex_table::Table, recorder::quoted, row, times::TimeUnit};

pub(super) const BYTES: &str = "bytes";
const MAX_PORT: usize = 60;

pub(super) struct LinePrefix<'l> {
    pub(super) time: Time<'l>,
    pub(super) port: String,
    pub(super) rest: &'l [u8],
}

#[derive(Clone, Copy)]
pub(super) enum Time<'l> {
    Number(Decimal),
    Ticks(&'l [u8]),
    Clock(Stamp),
}

impl<'l> LinePrefix<'l> {
    pub(super) fn parse(line: &'l [u8], table: Option<Table>) -> Result<Option<Self>, String> {
        if let Some(table) = table {
            let (time, port, rest) = table.split(line);
            let port = direction(port).map_or_else(|| port_name(port), Into::into);
            return Ok(Some(Self { time: Time::Ticks(time), port, rest }));
        }
        // A direction may come before the time.
        let (first, after) = word(line);
        let (before, text) = match direction(first) {
            Some(port) if time(after).is_some() => (Some(port), after),
            _ => (None, line),
        };
        let Some((time, rest)) = time(text) else {
            if direction(first).is_some() {
                return Ok(None);
            }
            return match not_a_time(line) {
                Some(message) => Err(message),
                None => Ok(None),
            };
        };
        let (port, rest) = port(rest)?;
        let port = before.map_or(port, Into::into);
        Ok(Some(Self { time, port, rest }))
    }
}

pub(super) fn word(text: &[u8]) -> (&[u8], &[u8]) {
    let text = text.trim_ascii_start();
    let is_end = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',' || *byte == b';';
    let end = text.iter().position(is_end).unwrap_or(text.len());
    (text.get(..end).unwrap_or_default(), text.get(end..).unwrap_or_default())
}

/// Splits a time off the beginning of a line.
fn time(text: &[u8]) -> Option<(Time<'_>, &[u8])> {
    let text = text.trim_ascii();
    if text.first().is_some_and(|mark| b"[(<".contains(mark)) {
        return time_in_brackets(text);
    }
    if let Some(stamp) = Stamp::parse(text) {
        let rest = text.get(stamp.length..)?;
        let is_apart = match rest {
            // Bytes with colons in between: 01:02:03:04.
            [b':', digit, ..] => !digit.is_ascii_hexdigit(),
            [] => true,
            [byte, ..] => byte.is_ascii_whitespace() || b",;:|>".contains(byte),
        };
        return is_apart.then(|| (Time::Clock(stamp), after_mark(rest)));
    }
    if let Some(stamp) = Stamp::without_seconds(text)
        && let Some(rest) = text.get(stamp.length..).filter(|rest| is_time_without_seconds(rest))
    {
        return Some((Time::Clock(stamp), after_mark(rest)));
    }
    time_before_colon(text).or_else(|| time_without_colon(text))
}

fn time_in_brackets(text: &[u8]) -> Option<(Time<'_>, &[u8])> {
    let close = match text.first()? {
        b'[' => b']',
        b'(' => b')',
        _ => b'>',
    };
    let end = text.iter().position(|byte| *byte == close)?;
    let (inner, rest) = (text.get(1..end)?.trim_ascii(), text.get(end + 1..)?);
    let has_more = !without_comment(rest).is_empty();
    let stamp = Stamp::parse(inner).or_else(|| Stamp::without_seconds(inner).filter(|_| has_more));
    if let Some(stamp) = stamp.filter(|stamp| stamp.length == inner.len()) {
        return Some((Time::Clock(stamp), after_mark(rest)));
    }
    // grabserial also prints the time since the previous line.
    let (number, unit) = with_unit(word(inner).0);
    if !number.contains(&b'.') && unit.is_none() {
        return None;
    }
    let time = seconds(number, unit.unwrap_or(TimeUnit::Seconds(0)))?;
    Some((Time::Number(time), after_mark(rest)))
}

fn time_before_colon(text: &[u8]) -> Option<(Time<'_>, &[u8])> {
    let (before, rest) = text.split_at(text.iter().position(|byte| *byte == b':')?);
    let (number, unit) = with_unit(before.trim_ascii());
    // Colons may also separate bytes.
    let is_time = unit.is_some() || number.contains(&b'.') || rest.get(1).is_none_or(u8::is_ascii_whitespace);
    let time = seconds(number, unit.unwrap_or(TimeUnit::Seconds(0))).filter(|_| is_time)?;
    Some((Time::Number(time), rest.get(1..)?))
}

/// A number with a unit, or a decimal number before a direction.
fn time_without_colon(text: &[u8]) -> Option<(Time<'_>, &[u8])> {
    let (before, rest) = word(text);
    if let (number, Some(unit)) = with_unit(before)
        && let Some(time) = seconds(number, unit)
    {
        return Some((Time::Number(time), rest));
    }
    let (next, after) = word(rest);
    if let (b"", Some(unit)) = with_unit(next)
        && let Some(time) = seconds(before, unit)
    {
        return Some((Time::Number(time), after));
    }
    let time = seconds(before, TimeUnit::Seconds(0)).filter(|_| before.contains(&b'.'));
    time.filter(|_| direction(next).is_some()).map(|time| (Time::Number(time), rest))
}

/// Whether `12:00` is a time: the words after it have no colons.
fn is_time_without_seconds(rest: &[u8]) -> bool {
    let rest = rest.strip_prefix(b":").unwrap_or(rest);
    let text = without_comment(rest);
    rest.first().is_some_and(u8::is_ascii_whitespace) && !text.is_empty() && !text.contains(&b':')
        || text.contains(&b':') && direction(word(rest).0).is_some()
}

/// Splits off a direction at the end, `55 AA <-`, unless it belongs to the text column of the bytes.
pub(super) fn trailing_direction(rest: &[u8]) -> Option<(&'static str, &[u8])> {
    let text = without_comment(rest);
    let at = text.iter().rposition(u8::is_ascii_whitespace)?;
    let (before, last) = text.split_at(at);
    let found = direction(last.trim_ascii())?;
    let has_text = row::parse(text, &mut Vec::new()).is_ok_and(|shape| shape.has_text);
    (!has_text).then_some((found, before))
}

/// A byte count: `(04) 41 42 43 44`, `[4 bytes] 41 …`, `04: 41 …`.
pub(super) struct ByteCount<'l> {
    pub(super) text: &'l [u8],
    pub(super) rest: &'l [u8],
    values: [Option<u64>; 2],
}

impl<'l> ByteCount<'l> {
    pub(super) fn parse(rest: &'l [u8]) -> Option<Self> {
        let rest = rest.trim_ascii_start();
        let close = match rest.first()? {
            b'(' => Some(b')'),
            b'[' => Some(b']'),
            b'{' => Some(b'}'),
            b'<' => Some(b'>'),
            _ => None,
        };
        let end = match close {
            Some(close) => rest.iter().position(|byte| *byte == close)?,
            None => rest.iter().position(|byte| *byte == b':')?,
        };
        let (text, after) = (rest.get(..=end)?, rest.get(end + 1..)?);
        let inner = rest.get(usize::from(close.is_some())..end)?.to_ascii_lowercase();
        let inner = inner.trim_ascii();
        let unnamed =
            ["len", "length", "n", "size"].iter().find_map(|name| inner.strip_prefix(name.as_bytes()));
        let inner = unnamed.map_or(inner, |rest| after_equals(rest));
        let (number, unit) = word(inner);
        let is_decimal = number.iter().all(u8::is_ascii_digit);
        let is_number = (1..=5).contains(&number.len()) && number.iter().all(u8::is_ascii_hexdigit);
        let is_unit = [&b""[..], b"b", b"byte", b"bytes"].contains(&unit.trim_ascii());
        let is_apart = close.is_some() || after.first().is_some_and(u8::is_ascii_whitespace);
        // Each byte may be in brackets or before a colon.
        let next = without_comment(after);
        let has_bytes = !next.is_empty()
            && if close.is_some() { next.first() != rest.first() } else { !next.contains(&b':') };
        let hex = core::str::from_utf8(number).ok().and_then(|text| u64::from_str_radix(text, 16).ok());
        (is_number && is_unit && is_apart && has_bytes).then_some(Self {
            text,
            rest: after_mark(after),
            values: [whole(number).filter(|_| is_decimal), hex],
        })
    }

    pub(super) const fn is_decimal(&self) -> bool {
        let [decimal, _] = self.values;
        decimal.is_some()
    }

    /// Accepts decimal or hexadecimal counts.
    pub(super) fn matches(&self, bytes: usize) -> bool {
        self.values.contains(&Some(bytes as u64))
    }
}

fn after_equals(rest: &[u8]) -> &[u8] {
    let rest = rest.trim_ascii_start();
    rest.strip_prefix(b"=").or_else(|| rest.strip_prefix(b":")).unwrap_or(rest).trim_ascii()
}

fn after_mark(rest: &[u8]) -> &[u8] {
    let rest = rest.trim_ascii_start();
    match rest {
        [b':' | b',' | b';' | b'|', rest @ ..] => rest,
        rest => rest,
    }
}

/// For a line with a colon that is neither part of a time nor between bytes.
fn not_a_time(line: &[u8]) -> Option<String> {
    let colon = line.iter().position(|byte| *byte == b':')?;
    let before = line.get(..colon)?.trim_ascii();
    let is_byte = before.split(u8::is_ascii_whitespace).all(|word| {
        let word = word.strip_prefix(b"0x").unwrap_or(word);
        word.len() <= 2 && word.iter().all(u8::is_ascii_hexdigit)
    });
    let is_apart = line.get(colon + 1).is_none_or(u8::is_ascii_whitespace);
    (!is_byte || is_apart).then(|| {
        format!(
            "{} is not a time; use a number such as 0.00125 or 12.5us, or a time of day such as 12:00:00.125",
            quoted(before)
        )
    })
}

fn port(rest: &[u8]) -> Result<(String, &[u8]), String> {
    let (mut name, mut rest) = (None, rest);
    loop {
        let (first, after) = word(rest);
        if first.is_empty() && after.is_empty() {
            break;
        }
        let bare = without_marks(first);
        if bare.is_empty() && direction(first).is_none() {
            // Skip a separator or a word of marks only.
            rest = after.get(usize::from(first.is_empty())..).unwrap_or_default();
            continue;
        }
        if let Some(found) = direction(first) {
            name = Some(found.to_owned());
        } else if is_port(bare) && name.is_none() {
            name = Some(port_name(bare));
        } else {
            break;
        }
        rest = after;
    }
    // jpnevulator names the port on a separate line.
    let mut bytes = Vec::new();
    let label = rest.trim_ascii();
    let is_label = !label.is_empty() && !label.contains(&b' ') && row::parse(label, &mut bytes).is_err();
    if name.is_none()
        && is_label
        && label.first().is_some_and(u8::is_ascii_alphabetic)
        && label.len() <= MAX_PORT
    {
        return Ok((port_name(label), &[]));
    }
    Ok((name.unwrap_or_else(|| BYTES.to_owned()), rest))
}

fn without_marks(word: &[u8]) -> &[u8] {
    let is_mark = |byte: &u8| b":-[]()|".contains(byte);
    let start = word.iter().position(|byte| !is_mark(byte)).unwrap_or(word.len());
    let end = word.iter().rposition(|byte| !is_mark(byte)).map_or(start, |last| last + 1);
    word.get(start..end).unwrap_or_default()
}

pub(super) fn direction(word: &[u8]) -> Option<&'static str> {
    let lower = word.to_ascii_lowercase();
    if let b"<" | b"<<" | b"<<<" | b"<-" | b"<--" | b"<---" | b"<=" | b"<==" | b"<:" = &lower[..] {
        return Some("RX");
    }
    if let b">" | b">>" | b">>>" | b"->" | b"-->" | b"--->" | b"=>" | b"==>" | b">:" = &lower[..] {
        return Some("TX");
    }
    match without_marks(&lower) {
        b"rx" | b"rxd" | b"recv" | b"received" | b"receive" | b"read" | b"in" | b"input" | b"irp_mj_read" => {
            Some("RX")
        }
        b"tx" | b"txd" | b"send" | b"sent" | b"write" | b"written" | b"out" | b"output" | b"irp_mj_write" => {
            Some("TX")
        }
        _ => None,
    }
}

fn is_port(word: &[u8]) -> bool {
    let number = |rest: &[u8]| !rest.is_empty() && rest.iter().all(u8::is_ascii_digit);
    let is_name = word.starts_with(b"/dev/")
        || word.starts_with(b"tty")
        || word.strip_prefix(b"COM").or_else(|| word.strip_prefix(b"com")).is_some_and(number);
    // Every later line copies the name, so its length is limited.
    is_name && word.len() <= MAX_PORT
}

fn port_name(name: &[u8]) -> String {
    let name = String::from_utf8_lossy(without_marks(name)).into_owned();
    if name.is_empty() { BYTES.to_owned() } else { name }
}

pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let sharp = line.iter().position(|byte| *byte == b'#').unwrap_or(line.len());
    let slashes = line.windows(2).position(|pair| pair == b"//").unwrap_or(line.len());
    line.get(..sharp.min(slashes)).unwrap_or(line).trim_ascii()
}

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
