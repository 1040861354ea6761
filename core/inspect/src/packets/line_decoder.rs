//! Decodes the serial line into bits, bytes and fields (DESIGN A4 to A6), each with texts of several lengths.
//!
//! RX is decoded as the controller received it. Where a byte differs from the byte that the host sent, both are shown.

use crate::packets::dissector::{CrcCheck, Field};
use crate::packets::log::{PacketLog, RowOutcome};
use crate::packets::packet_table::{LineByte, PacketTable};
use alloc::{borrow::ToOwned, format, string::String, string::ToString, vec, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::{BitTimes, bit_times::BYTE_BITS};
use stepscope_peripheral::{config::Config, trace::levels_at};

/// A bit, byte or field on the line, in cycles.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Span {
    pub start: u64,
    pub end: u64,
    pub texts: Vec<String>,
    pub bad: bool,
    pub packet: Option<usize>,
    pub sample: Option<u64>,
}

/// Decoded bits, bytes and fields of one line, in order of time.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Spans {
    pub bits: Vec<Span>,
    pub bytes: Vec<Span>,
    pub fields: Vec<Span>,
}

/// Decoded RX and TX in a window.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Decoded {
    pub rx: Spans,
    pub tx: Spans,
    /// There are more bytes than requested, and none is listed.
    pub more: bool,
}

/// Decodes RX and TX of a run for the logic view.
#[derive(Clone, Copy)]
pub struct LineDecoder<'a> {
    table: PacketTable<'a>,
    trace: &'a [Record],
}

impl<'a> LineDecoder<'a> {
    /// A decoder of the packets of `table`, whose run has the records `trace`.
    pub const fn new(table: PacketTable<'a>, trace: &'a [Record]) -> Self {
        Self { table, trace }
    }

    /// Decodes the cycles `start..end`, if they have at most `max_bytes` bytes; bits only for up to `max_bits` bytes.
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
        self.framing_errors_in(start, end, &mut rx, with_bits);
        Decoded { rx, tx, more: false }
    }

    fn config(&self) -> &'a Config {
        self.table.config()
    }

    fn packets(&self) -> &'a PacketLog {
        self.table.packets()
    }

    fn bytes_in(&self, start: u64, end: u64, max: usize) -> Option<Vec<LineByte>> {
        let mut bytes = Vec::new();
        for packet in self.packets().touching(Instant(start), Instant(end)) {
            // A row may have megabytes, so only visible bytes are decoded.
            let start_bits = self.packets().start_bits(packet);
            let before = if self.table.is_own_reply(packet) {
                0
            } else {
                start_bits.partition_point(|at| at.0 < start)
            };
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

    fn received_bits(&self, first: u64, packet: Option<usize>) -> Vec<Span> {
        let Cycles(bit) = self.config().bit();
        (0..BYTE_BITS)
            .map(|index| {
                let sample = first + bit / 2 + index * bit;
                let high = levels_at(self.trace, Instant(sample)).has(Levels::RX);
                Span {
                    start: first + index * bit,
                    end: first + (index + 1) * bit,
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
        let times = BitTimes::new(self.config().clock_hz(), self.config().reply_baud());
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

    fn framing_errors_in(&self, start: u64, end: u64, rx: &mut Spans, with_bits: bool) {
        let errors = self.packets().framing_errors();
        let length = BYTE_BITS * self.config().bit().0;
        let first = errors.partition_point(|seen| seen.0 + length <= start);
        for &Instant(seen) in errors.iter().skip(first).take_while(|seen| seen.0 < end) {
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

/// Maximum bytes of a row whose fields are shown; a frame has at most 600 before COBS.
const MAX_BYTES: usize = 1024;

impl LineDecoder<'_> {
    fn fields_of(&self, packet: usize) -> Vec<Span> {
        let Some(row) = self.packets().rows().get(packet) else { return Vec::new() };
        // A longer row is not a packet or frame.
        if self.packets().bytes(packet).len() > MAX_BYTES {
            return Vec::new();
        }
        let bytes = self.table.line_bytes(packet);
        let Some(dissection) = self.table.dissect(packet) else { return Vec::new() };
        let is_crc_wrong =
            matches!(dissection.crc, CrcCheck::Compared { found, expected } if found != expected);
        let span =
            |start, end, texts, bad| Span { start, end, texts, bad, packet: Some(packet), sample: None };
        let mut spans: Vec<Span> = dissection
            .fields
            .iter()
            .filter_map(|field| {
                let on_line: &[LineByte] = bytes.get(field.bytes.clone())?;
                let bad = row.outcome == RowOutcome::Ignored
                    || field.name == "reason"
                    || (is_crc_wrong && field.name == "CRC");
                Some(span(on_line.first()?.start, on_line.last()?.end, texts(field, bad), bad))
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
        use crate::trace::stored_run::StoredRun;
        use stepscope_sim::Experiment;

        let experiment = Experiment::from_json("{}").expect("the default motion");
        let mut recording = StoredRun::default();
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
