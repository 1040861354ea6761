//! Dissects packets, frames and replies (DESIGN A5, A6) into fields with their bytes, and into a one-line summary.
//!
//! COBS replaces each zero, so every decoded byte is one byte on the line. The bytes that COBS adds are fields, too.

mod summary;

pub use summary::write_steps;

use crate::packets::log::RowOutcome;
use alloc::{borrow::Cow, format, string::String, vec::Vec};
use core::ops::Range;
use serde::Serialize;
use stepscope_peripheral::protocol::{FrameOutcome, Kind, Reason, Reply};
use stepscope_peripheral::wire::cobs::CobsDecoder;
use stepscope_peripheral::wire::frame::{
    ACK, CRC, CRC_LEN, DELIMITER, Frame, NAK, POSITION_LEN, STATUS_LEN, Ticks,
};
use stepscope_peripheral::wire::packet::{ALL, ChannelCommand};
use stepscope_peripheral::{config::Protocol, device::Faults, signal::Positions};

/// A decoded field of a packet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    pub name: Cow<'static, str>,
    /// Its bytes, counted from the start of the packet.
    pub bytes: Range<usize>,
    pub value: String,
    /// What its bits mean; empty for a plain number.
    pub bits: Vec<BitGroup>,
}

/// Neighboring bits of a field with one meaning. Bit 0 is the least significant bit of the first byte.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BitGroup {
    pub high: u8,
    pub low: u8,
    /// The bits from `high` to `low` as 0 and 1.
    pub levels: String,
    pub name: &'static str,
    pub value: String,
}

/// A field's value as text, and what its bits mean.
struct Value {
    text: String,
    bits: Vec<BitGroup>,
}

impl<T: Into<String>> From<T> for Value {
    fn from(text: T) -> Self {
        Self { text: text.into(), bits: Vec::new() }
    }
}

/// Result of checking the CRC of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrcCheck {
    None,
    Missing,
    Compared { found: u32, expected: u32 },
}

/// The fields of a packet, in ascending order of bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dissection {
    pub fields: Vec<Field>,
    pub crc: CrcCheck,
}

/// Decodes packets of one line to fields.
#[derive(Clone, Copy)]
pub struct Dissector<'a> {
    pub protocol: Protocol,
    /// Whether raw packets begin with an address.
    pub addressed: bool,
    pub channels: &'a dyn Fn(u8) -> u8,
}

/// Address and kind of a frame with a valid CRC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameHead {
    pub address: u8,
    pub kind: u8,
}

impl FrameHead {
    /// `None` if the bytes are not a valid frame.
    pub fn of(bytes: &[u8], outcome: RowOutcome) -> Option<Self> {
        match outcome {
            RowOutcome::Reply(reply) => {
                let kind = reply.result.map_or(NAK, |kind| kind as u8 | ACK);
                return Some(Self { address: reply.address, kind });
            }
            RowOutcome::Frame(FrameOutcome::BadCrc { .. } | FrameOutcome::Short | FrameOutcome::Overlong) => {
                return None;
            }
            RowOutcome::Frame(_) => {}
            _ => return None,
        }
        let mut decoder = CobsDecoder::default();
        let mut content =
            bytes.get(last_frame(bytes))?.iter().filter_map(|&byte| decoder.byte(byte).content(byte));
        Some(Self { address: content.next()?, kind: content.next()? })
    }

    /// Whether a controller sent it.
    pub const fn is_reply(self) -> bool {
        self.kind & ACK != 0
    }

    /// Name of its kind, the same for a frame and its acknowledgment; `NAK` for a refusal.
    pub fn name(self) -> Option<&'static str> {
        if self.kind == NAK { Some("NAK") } else { Kind::parse(self.kind & !ACK).map(Kind::name) }
    }
}

/// The frame within its row, without delimiters.
fn last_frame(bytes: &[u8]) -> Range<usize> {
    let end = bytes.len() - usize::from(bytes.last() == Some(&DELIMITER));
    let before = bytes.get(..end).and_then(|bytes| bytes.iter().rposition(|&byte| byte == DELIMITER));
    before.map_or(0, |mark| mark + 1)..end
}

impl Dissector<'_> {
    /// Dissects a row. A frame with a wrong CRC is dissected as if it were valid.
    pub fn dissect(&self, bytes: &[u8], outcome: RowOutcome) -> Dissection {
        match (self.protocol, outcome) {
            (_, RowOutcome::Ignored) => {
                let ignored = (!bytes.is_empty()).then(|| field("ignored", 0..bytes.len(), "until a gap"));
                Dissection { fields: ignored.into_iter().collect(), crc: CrcCheck::None }
            }
            // A raw line may have a recorded reply.
            (Protocol::Framed, _) | (_, RowOutcome::Reply(_)) => self.framed(bytes),
            (_, RowOutcome::Recorded) => Dissection { fields: Vec::new(), crc: CrcCheck::None },
            (Protocol::Raw, _) => {
                Dissection { fields: raw_fields(bytes, self.addressed), crc: CrcCheck::None }
            }
        }
    }

    fn framed(&self, bytes: &[u8]) -> Dissection {
        let range = last_frame(bytes);
        let mut fields = Vec::new();
        if range.start > 0 {
            fields.push(field("preceding bytes", 0..range.start, "not part of the frame"));
        }
        let content = Content::of(bytes, range.clone());
        let crc = content.crc();
        let mut content_fields = content.fields(crc, self.channels);
        for &(at, code) in &content.overhead {
            // COBS bytes within a body belong to the body.
            if !content_fields.iter().any(|field| field.bytes.contains(&at)) {
                let index = content_fields.partition_point(|field| field.bytes.start < at);
                content_fields.insert(index, field("COBS", at..at + 1, cobs_to_text(code)));
            }
        }
        fields.extend(content_fields);
        if range.end < bytes.len() {
            fields.push(field("delimiter", range.end..bytes.len(), "00"));
        }
        Dissection { fields, crc }
    }
}

/// The reply in a row, if its CRC is valid.
#[cfg(feature = "std")]
pub(crate) fn parse_reply(bytes: &[u8]) -> Option<Reply> {
    let content = Content::of(bytes, last_frame(bytes));
    let crc @ CrcCheck::Compared { found, expected } = content.crc() else { return None };
    let [address, kind, body @ ..] = content.without_crc(crc) else { return None };
    if found == expected { Reply::parse(Frame { address: *address, kind: *kind, body }) } else { None }
}

/// The decoded frame, and whether its COBS is complete.
pub(crate) fn decoded(bytes: &[u8]) -> (Vec<u8>, bool) {
    let Content { decoded, is_complete, .. } = Content::of(bytes, last_frame(bytes));
    (decoded, is_complete)
}

/// A frame without COBS.
struct Content {
    decoded: Vec<u8>,
    offsets: Vec<usize>,
    /// Bytes that COBS added, with their positions.
    overhead: Vec<(usize, u8)>,
    is_complete: bool,
}

impl Content {
    fn of(bytes: &[u8], range: Range<usize>) -> Self {
        let mut content =
            Self { decoded: Vec::new(), offsets: Vec::new(), overhead: Vec::new(), is_complete: true };
        let mut decoder = CobsDecoder::default();
        for at in range.clone() {
            let byte = bytes.get(at).copied().unwrap_or(DELIMITER);
            match decoder.byte(byte).content(byte) {
                Some(decoded) => {
                    content.decoded.push(decoded);
                    content.offsets.push(at);
                }
                None => content.overhead.push((at, byte)),
            }
        }
        content.is_complete = range.is_empty() || decoder.is_complete();
        content.offsets.push(range.end);
        content
    }

    fn crc(&self) -> CrcCheck {
        match self.decoded.split_last_chunk::<CRC_LEN>() {
            Some((frame, sum)) if self.is_complete && frame.len() >= 2 => {
                CrcCheck::Compared { found: u32::from_le_bytes(*sum), expected: CRC.checksum(frame) }
            }
            _ => CrcCheck::Missing,
        }
    }

    fn without_crc(&self, crc: CrcCheck) -> &[u8] {
        let checked = if crc == CrcCheck::Missing { 0 } else { CRC_LEN };
        self.decoded.get(..self.decoded.len() - checked).unwrap_or_default()
    }

    fn line_range(&self, decoded: Range<usize>) -> Range<usize> {
        let last = decoded.end.checked_sub(1).and_then(|last| self.offsets.get(last));
        let first = self.offsets.get(decoded.start).copied().unwrap_or_default();
        first..last.map_or(first, |last| last + 1)
    }

    fn fields(&self, crc: CrcCheck, channels: &dyn Fn(u8) -> u8) -> Vec<Field> {
        let content = self.without_crc(crc);
        let end = content.len();
        let mut fields = Fields { content: self, found: Vec::new() };
        if let Some(&address) = content.first() {
            fields.add("address", 0..1, address_to_text(address));
        }
        if let [address, kind, body @ ..] = content {
            fields.add("kind", 1..2, kind_value(*kind));
            let frame = Frame { address: *address, kind: *kind, body };
            match (Reply::parse(frame), Ticks::parse(body, channels(*address))) {
                (Some(reply), _) => reply_fields(&reply, frame.positions().as_ref(), &mut fields),
                (None, Some(ticks)) if Kind::parse(*kind) == Some(Kind::Ticks) => {
                    ticks_fields(&ticks, channels(*address), &mut fields);
                }
                _ if body.is_empty() => {}
                _ => fields.add("body", 2..end, format!("{} bytes", body.len())),
            }
        }
        if let CrcCheck::Compared { found, expected } = crc {
            let value = if found == expected {
                format!("{found:08x}, valid")
            } else {
                format!("{found:08x}, expected {expected:08x}")
            };
            fields.add("CRC", end..end + CRC_LEN, value);
        }
        fields.found
    }
}

/// Collects the fields of a frame's content.
struct Fields<'a> {
    content: &'a Content,
    found: Vec<Field>,
}

impl Fields<'_> {
    fn add(&mut self, name: impl Into<Cow<'static, str>>, decoded: Range<usize>, value: impl Into<Value>) {
        self.found.push(field(name, self.content.line_range(decoded), value));
    }
}

fn ticks_fields(ticks: &Ticks<'_>, channels: u8, fields: &mut Fields<'_>) {
    fields.add("seq", 2..3, format!("{}", ticks.seq));
    fields.add("count", 3..4, format!("{}", ticks.count()));
    let channels = usize::from(channels.max(1));
    for (index, &byte) in ticks.commands().iter().enumerate() {
        let (tick, channel) = (index / channels, index % channels);
        let name = if channels == 1 { format!("tick {tick}") } else { format!("tick {tick} ch{channel}") };
        fields.add(name, 4 + index..5 + index, command_value(byte));
    }
}

fn reply_fields(reply: &Reply, positions: Option<&Positions>, fields: &mut Fields<'_>) {
    let mut at = 2;
    if let Err(reason) = reply.result {
        fields.add("reason", 2..3, reason_to_text(reason));
        at = 3;
    }
    let status = reply.status;
    fields.add("state", at..at + 1, status.state.name());
    fields.add("free", at + 1..at + 2, format!("{}", status.free));
    fields.add("expected seq", at + 2..at + 3, format!("{}", status.expected_seq));
    let names: Vec<&str> = Faults::from_bits(status.faults).names().collect();
    let faults = if names.is_empty() { "none".into() } else { names.join(", ") };
    fields.add("faults", at + 3..at + 5, Value { text: faults, bits: fault_bits(status.faults) });
    fields.add("ticks done", at + 5..at + 9, format!("{}", status.ticks_done));
    let counters = positions.map(Positions::as_slice).unwrap_or_default();
    for (channel, &counter) in counters.iter().enumerate() {
        let from = at + STATUS_LEN + channel * POSITION_LEN;
        let name = if counters.len() == 1 { "position".into() } else { format!("position ch{channel}") };
        fields.add(name, from..from + POSITION_LEN, position_to_text(counter));
    }
}

fn raw_fields(bytes: &[u8], addressed: bool) -> Vec<Field> {
    let first = usize::from(addressed);
    let each = |(at, &byte): (usize, &u8)| match at.checked_sub(first) {
        None => field("address", 0..1, address_to_text(byte)),
        Some(channel) => field(format!("ch{channel}"), at..at + 1, command_value(byte)),
    };
    bytes.iter().enumerate().map(each).collect()
}

fn field(name: impl Into<Cow<'static, str>>, bytes: Range<usize>, value: impl Into<Value>) -> Field {
    let Value { text, bits } = value.into();
    Field { name: name.into(), bytes, value: text, bits }
}

/// Bits `high` to `low` of `bits`.
fn bit_group(bits: u16, high: u8, low: u8, name: &'static str, value: impl Into<String>) -> BitGroup {
    let width = usize::from(high - low) + 1;
    let levels = format!("{:0width$b}", (bits >> low) & ((1 << width) - 1));
    BitGroup { high, low, levels, name, value: value.into() }
}

fn command_value(byte: u8) -> Value {
    let ChannelCommand { right, steps } = ChannelCommand::parse(byte);
    let direction = bit_group(byte.into(), 7, 7, "direction", if right { "right" } else { "left" });
    let count = bit_group(byte.into(), 6, 0, "steps", format!("{steps}"));
    Value { text: command_to_text(byte), bits: Vec::from([direction, count]) }
}

fn kind_value(kind: u8) -> Value {
    let text = kind_to_text(kind);
    let Some(known) = Kind::parse(kind & !ACK).filter(|_| kind != NAK) else { return text.into() };
    let reply = if kind & ACK == 0 { "no" } else { "yes" };
    let bits =
        [bit_group(kind.into(), 7, 7, "reply", reply), bit_group(kind.into(), 6, 0, "kind", known.name())];
    Value { text, bits: bits.into() }
}

/// The raised faults, each a bit.
fn fault_bits(faults: u16) -> Vec<BitGroup> {
    let raised = (0..16).filter(|bit| faults >> bit & 1 == 1);
    let name = |bit: u8| Faults::from_bits(1 << bit).names().next().unwrap_or("unknown");
    raised.map(|bit| bit_group(faults, bit, bit, "fault", name(bit))).collect()
}

fn cobs_to_text(code: u8) -> String {
    match code {
        1..=254 => format!("{} bytes to the next zero or the end", code - 1),
        _ => "254 bytes without a zero".into(),
    }
}

fn address_to_text(address: u8) -> String {
    if address == ALL { "255, all".into() } else { format!("{address}") }
}

fn kind_to_text(kind: u8) -> String {
    match (kind, Kind::parse(kind & !ACK)) {
        (NAK, _) => "NAK".into(),
        (_, Some(known)) if kind & ACK != 0 => format!("ACK {}", known.name()),
        (_, Some(known)) => known.name().into(),
        _ => format!("{kind:02x}, unknown"),
    }
}

fn reason_to_text(reason: Reason) -> String {
    format!("{}, {}", reason as u8, reason.name())
}

fn position_to_text(counter: i32) -> String {
    match counter {
        0 => "0".into(),
        1.. => format!("+{counter}"),
        _ => format!("\u{2212}{}", counter.unsigned_abs()),
    }
}

fn command_to_text(byte: u8) -> String {
    match ChannelCommand::parse(byte) {
        ChannelCommand { right: true, steps: 0 } => "0, right".into(),
        ChannelCommand { right: false, steps: 0 } => "0, left".into(),
        ChannelCommand { right: true, steps } => format!("+{steps}"),
        ChannelCommand { right: false, steps } => format!("\u{2212}{steps}"),
    }
}

#[cfg(test)]
mod tests;
