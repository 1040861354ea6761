//! The line decoded into bits, bytes and fields: spans of cycles with texts from the longest to the shortest (DESIGN
//! A4 to A6).
//!
//! RX is decoded as the controller received it; what the host sent is shown where it differs.

use crate::packets::log::{PacketLog, RowOutcome};
use crate::packets::{
    dissector::{Check, Field},
    packet_table::{LineByte, PacketTable},
};
use alloc::{borrow::ToOwned, format, string::String, string::ToString, vec, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::{
    config::Config,
    signal::{Levels, Record},
    trace::levels_at,
    units::{Cycles, Instant},
    wire::{BitTimes, bit_times::BYTE_BITS},
};

#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Span {
    pub start: u64,
    pub end: u64,
    pub texts: Vec<String>,
    pub bad: bool,
    pub packet: Option<usize>,
    pub sample: Option<u64>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Spans {
    pub bits: Vec<Span>,
    pub bytes: Vec<Span>,
    pub fields: Vec<Span>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Decoded {
    pub rx: Spans,
    pub tx: Spans,
    /// More bytes than requested: none are listed.
    pub more: bool,
}

#[derive(Clone, Copy)]
pub struct LineDecoder<'a> {
    table: PacketTable<'a>,
    trace: &'a [Record],
}

impl<'a> LineDecoder<'a> {
    pub const fn new(table: PacketTable<'a>, trace: &'a [Record]) -> Self {
        Self { table, trace }
    }

    /// Decodes the cycles `start..end`, unless they have more than `max_bytes` bytes; bits only for at most
    /// `max_bits` bytes.
    pub fn decode(&self, start: u64, end: u64, max_bytes: usize, max_bits: usize) -> Decoded {
        let (mut rx, mut tx) = (Spans::default(), Spans::default());
        let Some(bytes) = self.bytes_in(start, end, max_bytes) else {
            return Decoded { rx, tx, more: true };
        };
        let with_bits = bytes.len() <= max_bits;
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
                    self.received_bits(placed.start, Some(placed.packet))
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

    fn bytes_in(&self, start: u64, end: u64, max: usize) -> Option<Vec<LineByte>> {
        let mut bytes = Vec::new();
        for packet in self.packets().touching(Instant(start), Instant(end)) {
            // A row may have megabytes: decode only what is visible.
            let seen = self.packets().seen(packet);
            let before =
                if self.table.is_own_reply(packet) { 0 } else { seen.partition_point(|at| at.0 < start) };
            let placed = self
                .table
                .line_bytes_from(packet, before.saturating_sub(1))
                .skip_while(|byte| byte.end <= start);
            bytes.extend(placed.take_while(|byte| byte.start < end).take(max + 1));
            if bytes.len() > max {
                return None;
            }
        }
        Some(bytes)
    }

    fn byte(&self, placed: LineByte, reply: bool) -> Span {
        let LineByte { packet, byte, start, end } = placed;
        let sent = if reply { None } else { self.table.sent_at(Instant(start)) };
        let sent = sent.filter(|&sent| sent != byte);
        let hex = format!("{byte:02x}");
        let texts = match sent {
            Some(sent) => vec![format!("{hex}, sent as {sent:02x}"), format!("{hex}\u{2260}{sent:02x}"), hex],
            None => vec![hex],
        };
        Span { start, end, texts, bad: sent.is_some(), packet: Some(packet), sample: None }
    }

    fn received_bits(&self, seen: u64, packet: Option<usize>) -> Vec<Span> {
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

    fn sent_bits(&self, placed: LineByte) -> Vec<Span> {
        let LineByte { packet, byte, start, .. } = placed;
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
                rx.bits.extend(self.received_bits(seen, packet));
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

/// Maximum bytes of a row with fields; a frame has at most 600 before COBS.
const MAX_BYTES: usize = 1024;

impl LineDecoder<'_> {
    fn fields_of(&self, packet: usize) -> Vec<Span> {
        let Some(row) = self.packets().rows().get(packet) else { return Vec::new() };
        // Longer rows are no packet or frame.
        if self.packets().bytes(packet).len() > MAX_BYTES {
            return Vec::new();
        }
        let bytes = self.table.line_bytes(packet);
        let Some(meaning) = self.table.meaning(packet) else { return Vec::new() };
        let broken = matches!(meaning.check, Check::Compared { found, expected } if found != expected);
        let span =
            |start, end, texts, bad| Span { start, end, texts, bad, packet: Some(packet), sample: None };
        let mut spans: Vec<Span> = meaning
            .fields
            .iter()
            .filter_map(|field| {
                let carriers: &[LineByte] = bytes.get(field.bytes.clone())?;
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

fn texts(Field { name, value, .. }: &Field, bad: bool) -> Vec<String> {
    let mut texts = vec![format!("{name}: {value}"), value.clone()];
    texts.extend(value.split([' ', ',']).next().filter(|first| first.len() < value.len()).map(str::to_owned));
    if bad {
        texts.push("!".into());
    }
    texts
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_packet_is_decoded_to_bits() {
        use crate::packets::{line_decoder::LineDecoder, packet_table::PacketTable};
        use crate::trace::stored_run::Recording;
        use stepscope_sim::Experiment;

        let experiment = Experiment::from_json("{}").expect("the default motion");
        let mut recording = Recording::default();
        let run = experiment.run(&mut recording);
        let table = PacketTable::new(&experiment, &run, 0, &recording.packets);
        let first = table.row(0).expect("there are packets");
        let decoded = LineDecoder::new(table, &recording.trace).decode(
            first.start_cycle,
            first.line_end_cycle,
            100,
            100,
        );
        assert_eq!(decoded.rx.bytes.len(), 1); // one channel, so one byte a packet
        assert_eq!(decoded.rx.bits.len(), 10); // start, eight of data, stop
    }
}
