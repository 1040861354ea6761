//! What is on the line, decoded for the rows under RX and TX: bits, bytes and fields, each a span of cycles
//! with texts from the longest to the shortest (DESIGN A4 to A6).
//!
//! RX is decoded as the controller heard it: each byte where its start bit was seen, each bit where the
//! receiver looked. What the host sent there stands beside it where it differs.

mod fields;

use crate::{
    convert::object,
    simulation::{Simulation, config},
};
use serde::Serialize;
use stepscope_core::peripheral::{
    config::Config,
    trace::{PacketLog, RowOutcome},
    units::Instant,
};
use wasm_bindgen::prelude::*;

/// Bit of RX among the signals (A3).
const RX: u8 = 33;
/// Bits of a byte on the line: start, eight data bits, stop.
const BITS: u64 = 10;

/// One span of a decoder's row.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Span {
    start: u64,
    end: u64,
    /// From the longest to the shortest.
    texts: Vec<String>,
    /// Something is wrong with it.
    bad: bool,
    /// Row of the packets that it belongs to.
    packet: Option<usize>,
    /// Where the receiver looked at it.
    sample: Option<u64>,
}

#[derive(Default, Serialize)]
struct Lane {
    bits: Vec<Span>,
    bytes: Vec<Span>,
    fields: Vec<Span>,
}

#[derive(Serialize)]
struct Decoded {
    rx: Lane,
    tx: Lane,
    /// More bytes than were asked for: none are listed.
    more: bool,
}

/// A byte on the line: its row, its place in the row, and its cycles.
#[derive(Clone, Copy)]
pub(crate) struct Placed {
    packet: usize,
    byte: u8,
    pub(crate) start: u64,
    pub(crate) end: u64,
}

#[wasm_bindgen]
impl Simulation {
    /// What is on the line in a stretch of cycles, unless that is more than `most_bytes` bytes; their bits only
    /// where there are at most `most_bits` bytes: `{rx: {bits, bytes, fields}, tx: {…}, more}`, each of spans
    /// `{start, end, texts, bad, packet, sample}` in cycles.
    ///
    /// # Errors
    /// Never in practice.
    pub fn decoded(
        &self,
        start_cycle: f64,
        end_cycle: f64,
        most_bytes: u32,
        most_bits: u32,
    ) -> Result<JsValue, JsError> {
        let (start, end) = (start_cycle.max(0.0) as u64, end_cycle.max(0.0) as u64);
        let (mut rx, mut tx) = (Lane::default(), Lane::default());
        let Some(bytes) = self.bytes_in(start, end, most_bytes as usize) else {
            return object(&Decoded { rx, tx, more: true });
        };
        let with_bits = bytes.len() <= most_bits as usize;
        let log = &self.looked_at().recording.packets;
        let mut packet = None;
        for &placed in &bytes {
            let reply = is_reply(log, placed.packet);
            let lane = if reply { &mut tx } else { &mut rx };
            if packet != Some(placed.packet) {
                packet = Some(placed.packet);
                let fields = self.fields_of(placed.packet);
                lane.fields.extend(fields.into_iter().filter(|span| span.start < end && span.end > start));
            }
            let hex = format!("{:02x}", placed.byte);
            let sent =
                if reply { None } else { self.sent_at(placed.start).filter(|&sent| sent != placed.byte) };
            let texts = match sent {
                Some(sent) => {
                    vec![format!("{hex}, sent as {sent:02x}"), format!("{hex}\u{2260}{sent:02x}"), hex]
                }
                None => vec![hex],
            };
            let Placed { start, end, packet, .. } = placed;
            lane.bytes.push(Span {
                start,
                end,
                texts,
                bad: sent.is_some(),
                packet: Some(packet),
                sample: None,
            });
            if with_bits {
                lane.bits.extend(if reply {
                    self.sent_bits(placed)
                } else {
                    self.heard_bits(start, Some(packet))
                });
            }
        }
        self.broken_in(start, end, &mut rx, with_bits);
        object(&Decoded { rx, tx, more: false })
    }
}

fn is_reply(log: &PacketLog, row: usize) -> bool {
    log.rows().get(row).is_some_and(|row| matches!(row.verdict, RowOutcome::Reply(_)))
}

impl Simulation {
    fn own(&self) -> &Config {
        config(&self.experiment, self.looked_at)
    }

    /// Where byte `index` of bytes back to back begins, in cycles after the first one (A4).
    fn offset(&self, index: usize, baud: u32) -> u64 {
        BITS * index as u64 * u64::from(self.own().clock_hz()) / u64::from(baud.max(1))
    }

    /// The bytes that touch a stretch of cycles; `None` if there are more than `most`.
    fn bytes_in(&self, start: u64, end: u64, most: usize) -> Option<Vec<Placed>> {
        let log = &self.looked_at().recording.packets;
        let mut bytes = Vec::new();
        for packet in log.touching(Instant(start), Instant(end)) {
            // Of a row of megabytes only what is on show is looked at.
            let seen = log.seen(packet);
            let before = if is_reply(log, packet) { 0 } else { seen.partition_point(|at| at.0 < start) };
            let placed =
                self.placed_from(packet, before.saturating_sub(1)).skip_while(|byte| byte.end <= start);
            bytes.extend(placed.take_while(|byte| byte.start < end).take(most + 1));
            if bytes.len() > most {
                return None;
            }
        }
        Some(bytes)
    }

    /// The bytes of a row with their places.
    pub(crate) fn placed(&self, packet: usize) -> Vec<Placed> {
        self.placed_from(packet, 0).collect()
    }

    /// The bytes of a row from the one of this index on.
    fn placed_from(&self, packet: usize, first: usize) -> impl Iterator<Item = Placed> {
        let log = &self.looked_at().recording.packets;
        let reply = is_reply(log, packet);
        let seen = log.seen(packet);
        let length = BITS * self.own().bit().0;
        log.bytes(packet).iter().zip(seen).enumerate().skip(first).map(move |(index, (&byte, seen))| {
            let (start, end) = if reply {
                let baud = self.own().reply_baud();
                (seen.0 + self.offset(index, baud), seen.0 + self.offset(index + 1, baud))
            } else {
                let next = seen.0 + length;
                (seen.0, seen_after(log.seen(packet), index).map_or(next, |after| next.min(after)))
            };
            Placed { packet, byte, start, end }
        })
    }

    /// The bits of a byte as the receiver looked at them.
    fn heard_bits(&self, seen: u64, packet: Option<usize>) -> Vec<Span> {
        let bit = self.own().bit().0;
        (0..BITS)
            .map(|index| {
                let sample = seen + bit / 2 + index * bit;
                let high = self.level(RX, sample);
                let (start, end) = (seen + index * bit, seen + (index + 1) * bit);
                Span {
                    start,
                    end,
                    texts: bit_in_words(index, high),
                    bad: index == BITS - 1 && !high,
                    packet,
                    sample: Some(sample),
                }
            })
            .collect()
    }

    /// The bits of a byte as the controller sends them.
    fn sent_bits(&self, placed: Placed) -> Vec<Span> {
        let Placed { packet, byte, start, .. } = placed;
        let (clock, baud) = (u64::from(self.own().clock_hz()), u64::from(self.own().reply_baud().max(1)));
        let frame = u16::from(byte) << 1 | 1 << (BITS - 1);
        let at = |index: u64| start + index * clock / baud;
        (0..BITS)
            .map(|index| Span {
                start: at(index),
                end: at(index + 1),
                texts: bit_in_words(index, frame >> index & 1 == 1),
                bad: false,
                packet: Some(packet),
                sample: None,
            })
            .collect()
    }

    /// Adds the bytes whose stop bit was low.
    fn broken_in(&self, start: u64, end: u64, rx: &mut Lane, with_bits: bool) {
        let broken = self.looked_at().recording.packets.broken();
        let length = BITS * self.own().bit().0;
        let first = broken.partition_point(|seen| seen.0 + length <= start);
        for &Instant(seen) in broken.iter().skip(first).take_while(|seen| seen.0 < end) {
            let sent = self.sent_at(seen).map_or_else(String::new, |sent| format!(", sent as {sent:02x}"));
            let texts = vec![
                format!("framing error: stop bit low{sent}"),
                "framing error".into(),
                "FE".into(),
                "!".into(),
            ];
            let packet = self.looked_at().recording.packets.touching(Instant(seen), Instant(seen)).next();
            rx.bytes.push(Span { start: seen, end: seen + length, texts, bad: true, packet, sample: None });
            if with_bits {
                rx.bits.extend(self.heard_bits(seen, packet));
            }
        }
    }

    /// The byte that the host sent where the receiver saw a start bit: within a bit of it.
    fn sent_at(&self, seen: u64) -> Option<u8> {
        let schedule = self.run.schedule();
        let reach = self.own().bit().0;
        let baud = self.scenario.line.baud;
        let (mut low, mut high) = (0, schedule.len());
        while low < high {
            let middle = low.midpoint(high);
            if schedule.get(middle).is_some_and(|send| send.start.0 <= seen + reach) {
                low = middle + 1
            } else {
                high = middle
            }
        }
        let send = schedule.get(low.checked_sub(1)?)?;
        let bit_tenths =
            u64::from(baud) * seen.saturating_sub(send.start.0) / u64::from(self.own().clock_hz());
        // The nearest byte begins a whole number of ten bits after the first.
        let index = ((bit_tenths + BITS / 2) / BITS) as usize;
        let begins = send.start.0 + self.offset(index, baud);
        send.bytes.get(index).copied().filter(|_| begins.abs_diff(seen) <= reach)
    }
}

fn seen_after(seen: &[Instant], index: usize) -> Option<u64> {
    seen.get(index + 1).map(|after| after.0)
}

fn bit_in_words(index: u64, high: bool) -> Vec<String> {
    let level = u8::from(high);
    match index {
        0 => vec!["start".into(), "S".into()],
        9 if high => vec!["stop".into(), "P".into()],
        9 => vec!["stop bit low".into(), "!".into()],
        _ => vec![format!("bit {} = {level}", index - 1), level.to_string()],
    }
}
