//! What is on the line, decoded for the rows under RX and TX: bits, bytes and fields, each a span of cycles
//! with texts from the longest to the shortest (DESIGN A4 to A6).
//!
//! RX is decoded as the controller heard it: each byte where its start bit was seen, each bit where the
//! receiver looked. What the host sent there stands beside it where it differs.
//!
//! ```
//! use stepscope_inspect::packets::{line_decoder::LineDecoder, packet_table::PacketTable};
//!
//! # use stepscope_peripheral::trace::{Recording, steps};
//! # use stepscope_sim::Experiment;
//! # let experiment = Experiment::from_json("{}").expect("the default motion");
//! # let mut recording = Recording::default();
//! # let run = experiment.run(&mut recording);
//! let table = PacketTable::new(&experiment, &run, 0, &recording.packets);
//! let first = table.row(0).expect("there are packets");
//! let decoded = LineDecoder::new(table, &recording.trace).decode(first.start_cycle, first.line_end_cycle, 100, 100);
//! assert_eq!(decoded.rx.bytes.len(), 1); // one channel, so one byte a packet
//! assert_eq!(decoded.rx.bits.len(), 10); // start, eight of data, stop
//! ```

use crate::packets::{
    dissector::{Check, Field},
    packet_table::{PacketTable, PlacedByte},
};
use alloc::{borrow::ToOwned, format, string::String, string::ToString, vec, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::{
    config::Config,
    signal::{Levels, Record},
    trace::{PacketLog, RowOutcome, levels_at},
    units::{Cycles, Instant},
    wire::{BitTimes, bit_times::BYTE_BITS},
};

/// One span of a decoder's row.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Span {
    /// First cycle.
    pub start: u64,
    /// First cycle after it.
    pub end: u64,
    /// From the longest to the shortest.
    pub texts: Vec<String>,
    /// Something is wrong with it.
    pub bad: bool,
    /// Row of the packet table that it belongs to.
    pub packet: Option<usize>,
    /// Where the receiver looked at it.
    pub sample: Option<u64>,
}

/// The spans of one line.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Spans {
    /// Start bits, data bits, stop bits.
    pub bits: Vec<Span>,
    /// Bytes, those with a framing error among them.
    pub bytes: Vec<Span>,
    /// Fields of packets, frames and replies.
    pub fields: Vec<Span>,
}

/// What both lines carry.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Decoded {
    /// As the controller heard it.
    pub rx: Spans,
    /// As the controller sent it.
    pub tx: Spans,
    /// More bytes than were asked for: none are listed.
    pub more: bool,
}

/// The decoder of one controller's lines.
#[derive(Clone, Copy)]
pub struct LineDecoder<'a> {
    table: PacketTable<'a>,
    trace: &'a [Record],
}

impl<'a> LineDecoder<'a> {
    /// For the rows of `table` and the signals of the same controller.
    #[must_use]
    pub const fn new(table: PacketTable<'a>, trace: &'a [Record]) -> Self {
        Self { table, trace }
    }

    /// What is on the line in the cycles `start..end`, unless that is more than `most_bytes` bytes; their bits only
    /// where there are at most `most_bits` bytes.
    #[must_use]
    pub fn decode(&self, start: u64, end: u64, most_bytes: usize, most_bits: usize) -> Decoded {
        let (mut rx, mut tx) = (Spans::default(), Spans::default());
        let Some(bytes) = self.bytes_in(start, end, most_bytes) else {
            return Decoded { rx, tx, more: true };
        };
        let with_bits = bytes.len() <= most_bits;
        let mut packet = None;
        for &placed in &bytes {
            let reply = self.table.is_own_reply(placed.packet);
            let spans = if reply { &mut tx } else { &mut rx };
            if packet != Some(placed.packet) {
                packet = Some(placed.packet);
                let fields = self.fields_of(placed.packet);
                spans.fields.extend(fields.into_iter().filter(|span| span.start < end && span.end > start));
            }
            spans.bytes.push(self.byte(placed, reply));
            if with_bits {
                spans.bits.extend(if reply {
                    self.sent_bits(placed)
                } else {
                    self.heard_bits(placed.start, Some(placed.packet))
                });
            }
        }
        self.broken_in(start, end, &mut rx, with_bits);
        Decoded { rx, tx, more: false }
    }

    fn own(&self) -> &'a Config {
        self.table.own()
    }

    fn packets(&self) -> &'a PacketLog {
        self.table.packets()
    }

    /// The bytes that touch a stretch of cycles; `None` if there are more than `most`.
    fn bytes_in(&self, start: u64, end: u64, most: usize) -> Option<Vec<PlacedByte>> {
        let mut bytes = Vec::new();
        for packet in self.packets().touching(Instant(start), Instant(end)) {
            // Of a row of megabytes only what is on show is looked at.
            let seen = self.packets().seen(packet);
            let before =
                if self.table.is_own_reply(packet) { 0 } else { seen.partition_point(|at| at.0 < start) };
            let placed =
                self.table.placed_from(packet, before.saturating_sub(1)).skip_while(|byte| byte.end <= start);
            bytes.extend(placed.take_while(|byte| byte.start < end).take(most + 1));
            if bytes.len() > most {
                return None;
            }
        }
        Some(bytes)
    }

    /// A byte, and what the host sent there where it is another.
    fn byte(&self, placed: PlacedByte, reply: bool) -> Span {
        let PlacedByte { packet, byte, start, end } = placed;
        let sent = if reply { None } else { self.table.sent_at(Instant(start)) };
        let sent = sent.filter(|&sent| sent != byte);
        let hex = format!("{byte:02x}");
        let texts = match sent {
            Some(sent) => vec![format!("{hex}, sent as {sent:02x}"), format!("{hex}\u{2260}{sent:02x}"), hex],
            None => vec![hex],
        };
        Span { start, end, texts, bad: sent.is_some(), packet: Some(packet), sample: None }
    }

    /// The bits of a byte as the receiver looked at them.
    fn heard_bits(&self, seen: u64, packet: Option<usize>) -> Vec<Span> {
        let Cycles(bit) = self.own().bit();
        (0..BYTE_BITS)
            .map(|index| {
                let sample = seen + bit / 2 + index * bit;
                let high = levels_at(self.trace, Instant(sample)).has(Levels::RX);
                Span {
                    start: seen + index * bit,
                    end: seen + (index + 1) * bit,
                    texts: bit_texts(index, high),
                    bad: index == BYTE_BITS - 1 && !high,
                    packet,
                    sample: Some(sample),
                }
            })
            .collect()
    }

    /// The bits of a byte as the controller sends them.
    fn sent_bits(&self, placed: PlacedByte) -> Vec<Span> {
        let PlacedByte { packet, byte, start, .. } = placed;
        let times = BitTimes::new(self.own().clock_hz(), self.own().reply_baud());
        let bits = u16::from(byte) << 1 | 1 << (BYTE_BITS - 1);
        (0..BYTE_BITS)
            .map(|index| Span {
                start: start + times.bit(index).0,
                end: start + times.bit(index + 1).0,
                texts: bit_texts(index, bits >> index & 1 == 1),
                bad: false,
                packet: Some(packet),
                sample: None,
            })
            .collect()
    }

    /// Adds the bytes whose stop bit was low.
    fn broken_in(&self, start: u64, end: u64, rx: &mut Spans, with_bits: bool) {
        let broken = self.packets().broken();
        let length = BYTE_BITS * self.own().bit().0;
        let first = broken.partition_point(|seen| seen.0 + length <= start);
        for &Instant(seen) in broken.iter().skip(first).take_while(|seen| seen.0 < end) {
            let sent = self.table.sent_at(Instant(seen));
            let sent = sent.map_or_else(String::new, |sent| format!(", sent as {sent:02x}"));
            let texts = vec![
                format!("framing error: stop bit low{sent}"),
                "framing error".into(),
                "FE".into(),
                "!".into(),
            ];
            let packet = self.packets().touching(Instant(seen), Instant(seen)).next();
            rx.bytes.push(Span { start: seen, end: seen + length, texts, bad: true, packet, sample: None });
            if with_bits {
                rx.bits.extend(self.heard_bits(seen, packet));
            }
        }
    }
}

fn bit_texts(index: u64, high: bool) -> Vec<String> {
    let level = u8::from(high);
    match index {
        0 => vec!["start".into(), "S".into()],
        9 if high => vec!["stop".into(), "P".into()],
        9 => vec!["stop bit low".into(), "!".into()],
        _ => vec![format!("bit {} = {level}", index - 1), level.to_string()],
    }
}

/// Bytes of the longest row whose fields are told; a frame has at most 600 before COBS.
const MAX_BYTES: usize = 1024;

impl LineDecoder<'_> {
    /// The fields of a row of the packets.
    fn fields_of(&self, packet: usize) -> Vec<Span> {
        let Some(row) = self.packets().rows().get(packet) else { return Vec::new() };
        // No packet and no frame is longer: what is, was ignored or is none.
        if self.packets().bytes(packet).len() > MAX_BYTES {
            return Vec::new();
        }
        let bytes = self.table.placed(packet);
        let Some(meaning) = self.table.meaning(packet) else { return Vec::new() };
        let broken = matches!(meaning.check, Check::Compared { found, expected } if found != expected);
        let span =
            |start, end, texts, bad| Span { start, end, texts, bad, packet: Some(packet), sample: None };
        let mut spans: Vec<Span> = meaning
            .fields
            .iter()
            .filter_map(|field| {
                let carriers: &[PlacedByte] = bytes.get(field.bytes.clone())?;
                let bad = row.outcome == RowOutcome::Ignored
                    || field.name == "reason"
                    || (broken && field.name == "check");
                Some(span(carriers.first()?.start, carriers.last()?.end, texts(field, bad), bad))
            })
            .collect();
        if let (RowOutcome::Short, Some(last)) = (row.outcome, bytes.last()) {
            let why = format!("SHORT_PACKET: {}", self.table.why(packet));
            let texts = vec![why, "SHORT_PACKET".into(), "!".into()];
            spans.push(span(last.end, row.end.0.max(last.end), texts, true));
        }
        spans
    }
}

/// A field from its longest text to its shortest.
fn texts(Field { name, value, .. }: &Field, bad: bool) -> Vec<String> {
    let mut texts = vec![format!("{name}: {value}"), value.clone()];
    texts.extend(value.split([' ', ',']).next().filter(|first| first.len() < value.len()).map(str::to_owned));
    if bad {
        texts.push("!".into());
    }
    texts
}
