//! What each byte of a packet, a frame or a reply means (DESIGN A5, A6): its fields, in the order of
//! the line, each with its place among the bytes.
//!
//! ```text
//! raw    [address]  ch0  ch1  …                                        no check
//! wire   COBS  address  kind  body …  check x 4  end mark
//! ```
//!
//! COBS writes the distance to the next zero where a zero stood, so a decoded byte has one place on the
//! wire, and what COBS adds (the first byte, and one after each 254 bytes without a zero) is its own field.

use alloc::{borrow::Cow, format, string::String, vec::Vec};
use core::ops::Range;
use stepscope_peripheral::trace::RowOutcome;
use stepscope_peripheral::{
    config::Protocol,
    device::Faults,
    protocol::{Kind, Reason, Reply},
    wire::{
        frame::{CHECK, DELIMITER, Frame, Ticks},
        packet::{ALL, ChannelCommand},
    },
};

/// Set in the kind of a frame that is a reply.
const REPLY: u8 = 0x80;
/// Bytes of the check.
const CHECK_LEN: usize = 4;

/// One field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// What it is called, such as `seq`, `ch3` or `tick 0 ch3`.
    pub name: Cow<'static, str>,
    /// Its bytes, counted from the row's first, 0.
    pub bytes: Range<usize>,
    /// What stands there, in words.
    pub value: String,
}

/// The check of a row's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Check {
    /// Raw packets have none.
    None,
    /// The bytes are no frame, or not a whole one.
    Missing,
    /// CRC-32/ISCSI.
    Compared {
        /// The check that came.
        found: u32,
        /// The check of what came before it.
        expected: u32,
    },
}

/// What the bytes of a row mean.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Meaning {
    /// The fields, rising in their places; they do not overlap.
    pub fields: Vec<Field>,
    /// Its check.
    pub check: Check,
}

/// What has to be known of a line to read its bytes.
#[derive(Clone, Copy)]
pub struct Reading<'a> {
    /// How packets are framed.
    pub protocol: Protocol,
    /// Whether raw packets begin with an address.
    pub addressed: bool,
    /// Channels of the controller with an address.
    pub channels: &'a dyn Fn(u8) -> u8,
}

impl Reading<'_> {
    /// The fields of a row with these bytes. A frame whose check fails is read as if it held.
    #[must_use]
    pub fn of(&self, bytes: &[u8], verdict: RowOutcome) -> Meaning {
        match (self.protocol, verdict) {
            (_, RowOutcome::Ignored) => {
                let ignored = (!bytes.is_empty()).then(|| field("ignored", 0..bytes.len(), "until a gap"));
                Meaning { fields: ignored.into_iter().collect(), check: Check::None }
            }
            (Protocol::Raw, _) => Meaning { fields: raw(bytes, self.addressed), check: Check::None },
            (Protocol::Framed, _) => self.framed(bytes),
        }
    }

    fn framed(&self, bytes: &[u8]) -> Meaning {
        let whole =
            bytes.split_last().filter(|(last, _)| **last == DELIMITER).map_or(bytes, |(_, rest)| rest);
        let first = whole.iter().rposition(|&byte| byte == DELIMITER).map_or(0, |mark| mark + 1);
        let mut fields = Vec::new();
        if first > 0 {
            fields.push(field("before it", 0..first, "no part of the frame"));
        }
        let content = Content::of(bytes, first..whole.len());
        let mut check = Check::Missing;
        if content.whole
            && let Some((frame, sum)) = content.decoded.split_last_chunk::<CHECK_LEN>()
            && frame.len() >= 2
        {
            check = Check::Compared { found: u32::from_le_bytes(*sum), expected: CHECK.checksum(frame) };
        }
        let mut told = content.told(check, self.channels);
        for &(at, code) in &content.overhead {
            // What COBS adds within a body goes with the body.
            if !told.iter().any(|field| field.bytes.contains(&at)) {
                told.push(field("COBS", at..at + 1, cobs_in_words(code)));
            }
        }
        told.sort_by_key(|field| field.bytes.start);
        fields.extend(told);
        if whole.len() < bytes.len() {
            fields.push(field("end mark", whole.len()..bytes.len(), "00"));
        }
        Meaning { fields, check }
    }
}

/// What COBS holds, and where on the wire.
struct Content {
    decoded: Vec<u8>,
    /// Of each decoded byte, and of the end.
    places: Vec<usize>,
    /// What COBS added: where, and what stands there.
    overhead: Vec<(usize, u8)>,
    /// Whether the last run is as long as COBS says.
    whole: bool,
}

impl Content {
    /// Reads the bytes in `range`, of which none is a zero.
    fn of(bytes: &[u8], range: Range<usize>) -> Self {
        let mut content = Self { decoded: Vec::new(), places: Vec::new(), overhead: Vec::new(), whole: true };
        let mut code_at = range.start;
        let mut owed = false;
        while code_at < range.end {
            let code = bytes.get(code_at).copied().unwrap_or(DELIMITER);
            if owed {
                content.decoded.push(0);
                content.places.push(code_at);
            } else {
                content.overhead.push((code_at, code));
            }
            let next = code_at + usize::from(code.max(1));
            let run = code_at + 1..next.min(range.end);
            content.decoded.extend(bytes.get(run.clone()).unwrap_or_default());
            content.places.extend(run);
            content.whole = next <= range.end;
            owed = code < u8::MAX;
            code_at = next;
        }
        content.places.push(range.end);
        content
    }

    /// Places on the wire of some decoded bytes.
    fn at(&self, decoded: Range<usize>) -> Range<usize> {
        let last = decoded.end.checked_sub(1).and_then(|last| self.places.get(last));
        let first = self.places.get(decoded.start).copied().unwrap_or_default();
        first..last.map_or(first, |last| last + 1)
    }

    /// The fields but COBS and the end mark.
    fn told(&self, check: Check, channels: &dyn Fn(u8) -> u8) -> Vec<Field> {
        let checked = if check == Check::Missing { 0 } else { CHECK_LEN };
        let end = self.decoded.len() - checked;
        let mut fields = Vec::new();
        let mut add = |name: Cow<'static, str>, place: Range<usize>, value: String| {
            fields.push(Field { name, bytes: self.at(place), value });
        };
        let content = self.decoded.get(..end).unwrap_or_default();
        if let Some(&address) = content.first() {
            add("address".into(), 0..1, address_in_words(address));
        }
        if let [address, kind, body @ ..] = content {
            add("kind".into(), 1..2, kind_in_words(*kind));
            let frame = Frame { address: *address, kind: *kind, body };
            match (Reply::parse(frame), Ticks::parse(body, channels(*address))) {
                (Some(reply), _) => told_reply(&reply, &mut add),
                (None, Some(ticks)) if Kind::parse(*kind) == Some(Kind::Ticks) => {
                    told_ticks(&ticks, channels(*address), &mut add);
                }
                _ if body.is_empty() => {}
                _ => add("body".into(), 2..end, format!("{} bytes", body.len())),
            }
        }
        if let Check::Compared { found, expected } = check {
            let value = if found == expected {
                format!("{found:08x}, holds")
            } else {
                format!("{found:08x} found, {expected:08x} expected")
            };
            add("check".into(), end..end + CHECK_LEN, value);
        }
        fields
    }
}

type Add<'a> = dyn FnMut(Cow<'static, str>, Range<usize>, String) + 'a;

fn told_ticks(ticks: &Ticks<'_>, channels: u8, add: &mut Add<'_>) {
    add("seq".into(), 2..3, format!("{}", ticks.seq));
    add("count".into(), 3..4, format!("{}", ticks.count()));
    let channels = usize::from(channels.max(1));
    for (place, &byte) in ticks.orders().iter().enumerate() {
        let (tick, channel) = (place / channels, place % channels);
        let name = if channels == 1 { format!("tick {tick}") } else { format!("tick {tick} ch{channel}") };
        add(name.into(), 4 + place..5 + place, order_in_words(byte));
    }
}

fn told_reply(reply: &Reply, add: &mut Add<'_>) {
    let mut at = 2;
    if let Err(reason) = reply.answer {
        add("reason".into(), 2..3, reason_in_words(reason));
        at = 3;
    }
    let status = reply.status;
    add("state".into(), at..at + 1, status.state.name().into());
    add("free".into(), at + 1..at + 2, format!("{}", status.free));
    add("expected seq".into(), at + 2..at + 3, format!("{}", status.expected_seq));
    let names: Vec<&str> = Faults::from_bits(status.faults).names().collect();
    let faults = if names.is_empty() { "none".into() } else { names.join(", ") };
    add("faults".into(), at + 3..at + 5, faults);
    add("ticks done".into(), at + 5..at + 9, format!("{}", status.ticks_done));
}

fn raw(bytes: &[u8], addressed: bool) -> Vec<Field> {
    let first = usize::from(addressed);
    let told = |(at, &byte): (usize, &u8)| match at.checked_sub(first) {
        None => field("address", 0..1, address_in_words(byte)),
        Some(channel) => field(format!("ch{channel}"), at..at + 1, order_in_words(byte)),
    };
    bytes.iter().enumerate().map(told).collect()
}

fn field(name: impl Into<Cow<'static, str>>, bytes: Range<usize>, value: impl Into<String>) -> Field {
    Field { name: name.into(), bytes, value: value.into() }
}

fn cobs_in_words(code: u8) -> String {
    match code {
        1..=254 => format!("{} bytes to the next zero or the end", code - 1),
        _ => "254 bytes without a zero".into(),
    }
}

fn address_in_words(address: u8) -> String {
    if address == ALL { "255, all".into() } else { format!("{address}") }
}

fn kind_in_words(kind: u8) -> String {
    match (kind, Kind::parse(kind & !REPLY)) {
        (0xff, _) => "NAK".into(),
        (_, Some(known)) if kind & REPLY != 0 => format!("ACK {}", known.name()),
        (_, Some(known)) => known.name().into(),
        _ => format!("{kind:02x}, unknown"),
    }
}

fn reason_in_words(reason: Reason) -> String {
    format!("{}, {}", reason as u8, reason.name())
}

/// Steps with their direction; right is plus.
fn order_in_words(byte: u8) -> String {
    match ChannelCommand::parse(byte) {
        ChannelCommand { right: true, steps: 0 } => "0, right".into(),
        ChannelCommand { right: false, steps: 0 } => "0, left".into(),
        ChannelCommand { right: true, steps } => format!("+{steps}"),
        ChannelCommand { right: false, steps } => format!("\u{2212}{steps}"),
    }
}

#[cfg(test)]
mod tests;
