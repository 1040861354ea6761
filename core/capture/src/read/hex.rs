//! Bytes of a line in hexadecimal, as terminals, serial sniffers and logs write them, with times or without.
//!
//! ```text
//! 55 AA 0x01,02      # a comment         0.00125: 55 AA 01         t_us,bytes
//! 55AA0102           // another          12.5us RX 55              12.5,55 AA 01
//!
//! 2026-11-26T12:00:00.123456 RX: 55 AA       [12:00:00.123] 55 AA       2006-05-30 13:23:49.461075: /dev/ttyS0
//! 26.11.2026 12:00:00.123 [TX] - 55 AA       [ 12.345678] >> 55 AA      55 AA 01 02        U...
//! ```
//!
//! Bytes of one line of a time have the same tick. Without times a byte's tick is its place. RX and TX are channels.

use super::{
    clock::Stamp,
    decimal::Decimal,
    fields::separator,
    reading::Reader,
    recorder::{Recorder, quoted},
    row,
    times::{TimeUnit, Times},
};
use crate::capture::{Capture, MAX_CHANNELS, TimedByte};

/// The channel of bytes without a direction.
const BYTES: &str = "bytes";
/// Longest name of a port, in bytes.
const MAX_PORT: usize = 60;

/// Bytes that are being read.
pub(super) struct HexText {
    recorder: Recorder,
    times: Times,
    /// Of a table: how its rows are split.
    table: Option<Table>,
    /// Whether the lines have times; not known before the first.
    timed: Option<bool>,
    any: bool,
    bytes: Vec<u8>,
    /// A line with a time and no bytes: those of the lines after it.
    block: Option<Block>,
}

/// How rows of a table are split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Table {
    separator: u8,
    unit: TimeUnit,
    /// Whether a direction is between the time and the bytes.
    has_direction: bool,
}

/// What a line with a time and no bytes gives to the lines after it.
#[derive(Clone)]
struct Block {
    tick: u64,
    port: String,
}

impl HexText {
    /// `table` is what the lines are if they are a table without a head.
    pub(super) fn new(recorder: Recorder, table: Option<Table>) -> Self {
        Self {
            recorder,
            times: Times::new(table.map_or(TimeUnit::Seconds(0), |table| table.unit)),
            table,
            timed: None,
            any: false,
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

    /// Takes a line that begins with neither a number and a unit nor a clock.
    fn plain(&mut self, line: &[u8]) -> Result<(), String> {
        self.bytes.clear();
        // Without times the bytes of two directions have no common order.
        if direction(word(line).0).is_some() {
            return Err(format!(
                "{} has a direction and no time; give each line a time, or the bytes of one direction only",
                quoted(line)
            ));
        }
        parse_bytes(line, &mut self.bytes, false)?;
        if let Some(Block { tick, port }) = self.block.clone() {
            let channel = self.channel(&port)?;
            return self.push(Some(tick), channel);
        }
        if self.timed == Some(true) {
            return Err(format!(
                "{} has no time, and the lines before have one; give each line a time, or none",
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
        if !core::mem::replace(&mut self.any, true)
            && let Some(table) = head(line)
        {
            self.times = Times::new(table.unit);
            self.table = Some(table);
            return Ok(());
        }
        let Some(start) = Start::of(line, self.table)? else { return self.plain(line) };
        if self.timed == Some(false) {
            return Err(format!(
                "{} has a time, and the lines before have none; give each line a time, or none",
                quoted(line)
            ));
        }
        self.timed = Some(true);
        let Start { time, port, rest } = start;
        let tick = match time {
            Time::Number(time) => self.times.tick_of(time, line, &mut self.recorder)?,
            Time::Ticks(text) => self.times.tick(text, &mut self.recorder)?,
            Time::Clock(stamp) => self.times.stamp(stamp, line, &mut self.recorder)?,
        };
        self.recorder.capture.end = tick;
        self.bytes.clear();
        if without_comment(rest).is_empty() {
            self.block = Some(Block { tick, port });
            return Ok(());
        }
        self.block = None;
        parse_bytes(rest, &mut self.bytes, matches!(time, Time::Clock(_)) || port != BYTES)?;
        let channel = self.channel(&port)?;
        self.push(Some(tick), channel)
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        self.times.finish(&mut self.recorder);
        let named = |name: &str| self.recorder.capture.channels.iter().any(|channel| channel.name == name);
        if named("RX") && named("TX") {
            self.recorder.leave_out(
                "RX and TX are named as in the log: in one of the host, TX is what the controller receives; \
                 for such a log, exchange the channels of RX and TX"
                    .into(),
            );
        }
        let capture = self.recorder.finish();
        let missing = if capture.is_empty() { Err("the file has no bytes".into()) } else { Ok(()) };
        (capture, missing)
    }
}

/// What a line begins with.
struct Start<'l> {
    time: Time<'l>,
    /// The direction, or the port: the name of the channel.
    port: String,
    rest: &'l [u8],
}

#[derive(Clone, Copy)]
enum Time<'l> {
    /// In s.
    Number(Decimal),
    /// In the unit of a table.
    Ticks(&'l [u8]),
    Clock(Stamp),
}

impl<'l> Start<'l> {
    /// The time, the direction and the rest; `None` if the line begins with none.
    fn of(line: &'l [u8], table: Option<Table>) -> Result<Option<Self>, String> {
        if let Some(Table { separator, has_direction, .. }) = table {
            let (time, rest) = cut(line, separator);
            let (port, rest) = if has_direction { cut(rest, separator) } else { (&b""[..], rest) };
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
                Some(what) => Err(what),
                None => Ok(None),
            };
        };
        let (port, rest) = port(rest)?;
        let port = before.map_or(port, Into::into);
        Ok(Some(Self { time, port, rest }))
    }
}

/// A field of a table, and the rest.
fn cut(line: &[u8], separator: u8) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(|byte| *byte == separator).unwrap_or(line.len());
    let (field, rest) = line.split_at(end);
    (field.trim_ascii(), rest.get(1..).unwrap_or_default().trim_ascii())
}

/// A word, and the rest.
fn word(text: &[u8]) -> (&[u8], &[u8]) {
    let text = text.trim_ascii_start();
    let is_end = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',' || *byte == b';';
    let end = text.iter().position(is_end).unwrap_or(text.len());
    (text.get(..end).unwrap_or_default(), text.get(end..).unwrap_or_default())
}

/// The time that a text begins with, in brackets or not, and the rest after its mark.
fn time(text: &[u8]) -> Option<(Time<'_>, &[u8])> {
    let text = text.trim_ascii();
    let open = text.first().copied().filter(|mark| b"[(<".contains(mark));
    if let Some(open) = open {
        let close = match open {
            b'[' => b']',
            b'(' => b')',
            _ => b'>',
        };
        let end = text.iter().position(|byte| *byte == close)?;
        let (inner, rest) = (text.get(1..end)?.trim_ascii(), text.get(end + 1..)?);
        if let Some(stamp) = Stamp::parse(inner).filter(|stamp| stamp.length == inner.len()) {
            return Some((Time::Clock(stamp), after_mark(rest)));
        }
        // grabserial adds the time since the line before.
        let (number, unit) = with_unit(word(inner).0);
        if !number.contains(&b'.') && unit.is_none() {
            return None;
        }
        let time = seconds(number, unit.unwrap_or(TimeUnit::Seconds(0)))?;
        return Some((Time::Number(time), after_mark(rest)));
    }
    if let Some(stamp) = Stamp::parse(text) {
        let rest = text.get(stamp.length..)?;
        let is_apart = rest.first().is_none_or(|byte| byte.is_ascii_whitespace() || b",;:|>".contains(byte));
        return is_apart.then(|| (Time::Clock(stamp), after_mark(rest)));
    }
    if let Some(colon) = text.iter().position(|byte| *byte == b':') {
        let (before, rest) = text.split_at(colon);
        let (number, unit) = with_unit(before.trim_ascii());
        // Bytes may have colons between them, too.
        let is_time =
            unit.is_some() || number.contains(&b'.') || rest.get(1).is_none_or(u8::is_ascii_whitespace);
        if let Some(time) = seconds(number, unit.unwrap_or(TimeUnit::Seconds(0))).filter(|_| is_time) {
            return Some((Time::Number(time), rest.get(1..)?));
        }
    }
    // Without a colon it is the unit that makes a time of a number.
    let (before, rest) = word(text);
    if let (number, Some(unit)) = with_unit(before)
        && let Some(time) = seconds(number, unit)
    {
        return Some((Time::Number(time), rest));
    }
    let (unit, rest) = word(rest);
    if let (b"", Some(unit)) = with_unit(unit)
        && let Some(time) = seconds(before, unit)
    {
        return Some((Time::Number(time), rest));
    }
    None
}

/// The rest after the mark that ends a time.
fn after_mark(rest: &[u8]) -> &[u8] {
    let rest = rest.trim_ascii_start();
    match rest {
        [b':' | b',' | b';' | b'|', rest @ ..] => rest,
        rest => rest,
    }
}

/// What is wrong with a line that has a colon, and neither a time before it nor bytes around it.
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
            "{} is not a time; give a number, such as 0.00125 or 12.5us, or a time of day, such as 12:00:00.125",
            quoted(before)
        )
    })
}

/// The channel that a line is of, and its bytes.
fn port(rest: &[u8]) -> Result<(String, &[u8]), String> {
    let (mut name, mut rest) = (None, rest);
    loop {
        let (first, after) = word(rest);
        if first.is_empty() && after.is_empty() {
            break;
        }
        let bare = bare(first);
        if bare.is_empty() && direction(first).is_none() {
            // A mark alone, or none at all.
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
    // A line that only names what comes next, as jpnevulator's.
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

/// A word without the marks around it.
fn bare(word: &[u8]) -> &[u8] {
    let is_mark = |byte: &u8| b":-[]()|".contains(byte);
    let start = word.iter().position(|byte| !is_mark(byte)).unwrap_or(word.len());
    let end = word.iter().rposition(|byte| !is_mark(byte)).map_or(start, |last| last + 1);
    word.get(start..end).unwrap_or_default()
}

/// RX or TX by the words and arrows of logs.
fn direction(word: &[u8]) -> Option<&'static str> {
    let lower = word.to_ascii_lowercase();
    if let b"<" | b"<<" | b"<<<" | b"<-" | b"<--" | b"<---" | b"<=" | b"<==" | b"<:" = &lower[..] {
        return Some("RX");
    }
    if let b">" | b">>" | b">>>" | b"->" | b"-->" | b"--->" | b"=>" | b"==>" | b">:" = &lower[..] {
        return Some("TX");
    }
    match bare(&lower) {
        b"rx" | b"rxd" | b"recv" | b"received" | b"receive" | b"read" | b"in" | b"input" | b"irp_mj_read" => {
            Some("RX")
        }
        b"tx" | b"txd" | b"send" | b"sent" | b"write" | b"written" | b"out" | b"output" | b"irp_mj_write" => {
            Some("TX")
        }
        _ => None,
    }
}

/// Whether a word is the name of a serial port.
fn is_port(word: &[u8]) -> bool {
    let number = |rest: &[u8]| !rest.is_empty() && rest.iter().all(u8::is_ascii_digit);
    let is_name = word.starts_with(b"/dev/")
        || word.starts_with(b"tty")
        || word.strip_prefix(b"COM").or_else(|| word.strip_prefix(b"com")).is_some_and(number);
    // The lines after it each copy the name.
    is_name && word.len() <= MAX_PORT
}

fn port_name(name: &[u8]) -> String {
    let name = String::from_utf8_lossy(bare(name)).into_owned();
    if name.is_empty() { BYTES.to_owned() } else { name }
}

/// The line up to `#` or `//`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let sharp = line.iter().position(|byte| *byte == b'#').unwrap_or(line.len());
    let slashes = line.windows(2).position(|pair| pair == b"//").unwrap_or(line.len());
    line.get(..sharp.min(slashes)).unwrap_or(line).trim_ascii()
}

/// A head such as `t_s,bytes` or `time_us,direction,data`.
pub(super) fn head(line: &[u8]) -> Option<Table> {
    let separator = separator(line);
    let mut names = line.split(|byte| *byte == separator).map(|name| name.trim_ascii().to_ascii_lowercase());
    let unit = TimeUnit::of_column(core::str::from_utf8(&names.next()?).ok()?)?;
    let is_bytes =
        |name: &[u8]| [&b"bytes"[..], b"byte", b"data", b"hex", b"value", b"payload", b"raw"].contains(&name);
    let is_direction = |name: &[u8]| {
        [&b"dir"[..], b"direction", b"port", b"channel", b"line", b"rx/tx", b"source"].contains(&name)
    };
    let (second, third) = (names.next()?, names.next());
    let has_direction = third.is_some();
    let fits = match &third {
        Some(third) => is_direction(&second) && is_bytes(third),
        None => is_bytes(&second),
    };
    (fits && unit != TimeUnit::Cycles && names.next().is_none()).then_some(Table {
        separator,
        unit,
        has_direction,
    })
}

/// The table that lines without a head are: a number that rises, and bytes of two digits. Its times have no unit.
pub(super) fn table(lines: &[&[u8]]) -> Option<Table> {
    let separator = separator(lines.first()?);
    let (mut before, mut is_number, mut is_whole) = (None::<Decimal>, false, true);
    for line in lines {
        let (time, rest) = cut(line, separator);
        let number = Decimal::parse(time).filter(|number| number.mantissa >= 0)?;
        let places = number.places.max(before.map_or(0, |before| before.places));
        let whole = |number: Decimal| number.with_places(places).map(|number| number.mantissa);
        if before.is_some_and(|before| whole(before) > whole(number)) {
            return None;
        }
        before = Some(number);
        is_number |= time.len() != 2;
        is_whole &= number.places == 0 && time.iter().all(u8::is_ascii_digit);
        let mut bytes = Vec::new();
        let is_rest = row::parse(rest, &mut bytes).is_ok_and(|shape| shape.group == 1) && !bytes.is_empty();
        let is_pair = |word: &[u8]| word.is_empty() || word.len() == 2 || word.starts_with(b"0x");
        if !is_rest || !rest.split(|byte| b" ,;\t".contains(byte)).all(is_pair) {
            return None;
        }
    }
    let unit = if is_whole { TimeUnit::Cycles } else { TimeUnit::Seconds(0) };
    (is_number && lines.len() > 1).then_some(Table { separator, unit, has_direction: false })
}

/// Whether a table's bytes are surely no other numbers: one has a letter, `0x` or a zero before it.
pub(super) fn is_hexadecimal(lines: &[&[u8]], table: Table) -> bool {
    lines.iter().any(|line| {
        let (_, rest) = cut(line, table.separator);
        rest.iter().any(u8::is_ascii_alphabetic) || rest.starts_with(b"0") || rest.len() > 2
    })
}

/// Whether a line begins with a time of a clock, or one in brackets.
pub(super) fn is_log(line: &[u8]) -> bool {
    let found = Start::of(line, None);
    found.is_ok_and(|start| {
        start.is_some_and(|start| matches!(start.time, Time::Clock(_)) || line.starts_with(b"["))
    })
}

/// Whether a line can be read.
pub(super) fn is_line(line: &[u8]) -> bool {
    let mut bytes = Vec::new();
    match Start::of(line, None) {
        Ok(Some(start)) => parse_bytes(start.rest, &mut bytes, false).is_ok(),
        Ok(None) => direction(word(line).0).is_some() || parse_bytes(line, &mut bytes, false).is_ok(),
        Err(_) => false,
    }
}

/// A number and the unit after it.
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

/// Bytes of a line, which their text or a comment may follow: `55 AA   U.`, `0x55,0xAA`, `[55;aa]`, `55AA`, `\x55`.
/// A log's have two digits each: a single one may be a number of bytes.
fn parse_bytes(text: &[u8], bytes: &mut Vec<u8>, is_log: bool) -> Result<(), String> {
    let text = text.trim_ascii();
    match row::parse(text, bytes) {
        // A number of many digits beside others is no byte where commas separate them.
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
