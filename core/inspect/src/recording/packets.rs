//! Packets on recorded lines. Frames (DESIGN A6) end at their delimiter and have a CRC; others end at a gap (A5).

use super::report::{LineReport, Report};
use super::serial::{GAP_BITS, Guess, line_name};
use crate::packets::dissector::{Dissector, FrameHead};
use crate::{packets::log::RowOutcome, packets::packet_table::write_fields};
use alloc::string::{String, ToString};
use alloc::{borrow::ToOwned, vec::Vec};
use core::fmt::{self, Write};
use serde::Serialize;
use stepscope_peripheral::signal::{Levels, PacketOutcome};
use stepscope_peripheral::wire::bit_times::BYTE_BITS;
use stepscope_peripheral::wire::frame::{DELIMITER, Deframed, Deframer};
use stepscope_peripheral::{config::Protocol, protocol::FrameOutcome, units::Instant};

/// A packet on RX or TX of a recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LinePacket {
    pub line: &'static str,
    /// `packet`, `frame`, `reply`, or `byte` for a framing error.
    pub kind: &'static str,
    pub start_cycle: u64,
    pub end_cycle: u64,
    pub bytes: Vec<u8>,
    pub meaning: String,
    /// `CRC valid`, or the problem; empty for raw packets.
    pub outcome: String,
}

/// The packets of a recording, in order of time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packets {
    pub rows: Vec<LinePacket>,
    clock_hz: u32,
}

impl Packets {
    /// `addressed`: raw packets begin with an address.
    pub fn of(report: &Report, clock_hz: u32, channels: u8, addressed: bool) -> Self {
        let mut rows = Vec::new();
        for line in &report.lines {
            Line::new(line, clock_hz, channels, addressed).rows(&mut rows);
        }
        rows.sort_by_key(|row| row.start_cycle);
        Self { rows, clock_hz }
    }

    /// Number of replies with a valid CRC.
    pub fn replies(&self) -> usize {
        let tx = line_name(Levels::TX);
        self.rows.iter().filter(|row| row.line == tx && row.outcome == CRC_VALID).count()
    }

    /// Writes CSV with the column names of `stepscope run --packets`, so that the file can be opened and sent.
    pub fn write_csv(&self, out: &mut impl Write) -> fmt::Result {
        out.write_str("start_cycle,end_cycle,bytes,outcome,kind,line,number,start_s,end_s,gap_s,meaning\n")?;
        let seconds = |cycle: u64| Instant(cycle).seconds(self.clock_hz);
        let mut last = None::<u64>;
        for (number, row) in self.rows.iter().enumerate() {
            let LinePacket { line, kind, start_cycle, end_cycle, bytes, meaning, outcome } = row;
            write!(out, "{start_cycle},{end_cycle},")?;
            bytes.iter().try_for_each(|byte| write!(out, "{byte:02x}"))?;
            write_fields(out, &[outcome])?;
            write!(out, ",{kind},{line},{number},{},{},", seconds(*start_cycle), seconds(*end_cycle))?;
            // Counts from the last byte on either line.
            if let Some(last) = last {
                write!(out, "{}", seconds(start_cycle.saturating_sub(last)))?;
            }
            last = last.max(Some(*end_cycle));
            write_fields(out, &[meaning])?;
            out.write_char('\n')?;
        }
        Ok(())
    }
}

const CRC_VALID: &str = "CRC valid";

pub(super) struct Found {
    pub(super) start_cycle: u64,
    pub(super) end_cycle: u64,
    pub(super) bytes: Vec<u8>,
    pub(super) outcome: Option<FrameOutcome>,
}

/// Splits the bytes of a line into packets.
pub(super) struct Line<'a> {
    line: &'a LineReport,
    is_framed: bool,
    channels: u8,
    addressed: bool,
    byte: u64,
    /// Cycles between bytes that end a raw packet.
    gap: u64,
}

impl<'a> Line<'a> {
    pub(super) fn new(line: &'a LineReport, clock_hz: u32, channels: u8, addressed: bool) -> Self {
        let bit = u64::from(clock_hz) / u64::from(line.baud.max(1));
        let known = if let Guess::Framed { channels, .. } = line.guess { channels } else { None };
        Self {
            line,
            is_framed: matches!(line.guess, Guess::Framed { .. }),
            channels: known.unwrap_or(channels),
            addressed,
            byte: BYTE_BITS * bit,
            gap: (GAP_BITS + BYTE_BITS) * bit,
        }
    }

    fn rows(&self, rows: &mut Vec<LinePacket>) {
        self.each(|found| rows.push(self.packet(found)));
        rows.extend(self.line.decoded.framing_errors.iter().map(|seen| LinePacket {
            line: self.line.name,
            kind: "byte",
            start_cycle: seen.0,
            end_cycle: seen.0 + self.byte,
            bytes: Vec::new(),
            meaning: String::new(),
            outcome: RowOutcome::Framing.to_string(),
        }));
    }

    pub(super) fn each(&self, mut take: impl FnMut(Found)) {
        let (mut deframer, mut outcome) = (Deframer::default(), None);
        let (mut bytes, mut start_cycle, mut last) = (Vec::new(), 0, 0);
        let found = |start_cycle, last: u64, bytes: &mut Vec<u8>, outcome| Found {
            start_cycle,
            end_cycle: last + self.byte,
            bytes: core::mem::take(bytes),
            outcome,
        };
        for decoded in &self.line.decoded.bytes {
            let at = decoded.start.0;
            if !self.is_framed && !bytes.is_empty() && at.saturating_sub(last) > self.gap {
                take(found(start_cycle, last, &mut bytes, None));
            }
            if bytes.is_empty() {
                start_cycle = at;
            }
            bytes.push(decoded.byte);
            last = at;
            if !self.is_framed {
                continue;
            }
            outcome = match deframer.byte(decoded.byte) {
                // Its outcome at the controller is unknown.
                Some(Deframed::Frame(_)) => Some(FrameOutcome::OtherAddress),
                Some(Deframed::Short) => Some(FrameOutcome::Short),
                Some(Deframed::BadCrc { found, expected }) => Some(FrameOutcome::BadCrc { found, expected }),
                Some(Deframed::Overlong) => Some(FrameOutcome::Overlong),
                None => outcome,
            };
            // Single delimiters belong to the next frame.
            if decoded.byte == DELIMITER && outcome.is_some() {
                take(found(start_cycle, last, &mut bytes, outcome.take()));
            }
        }
        if !bytes.is_empty() {
            take(found(start_cycle, last, &mut bytes, None));
        }
    }

    fn packet(&self, Found { start_cycle, end_cycle, bytes, outcome }: Found) -> LinePacket {
        let is_tx = self.line.name == line_name(Levels::TX);
        let is_known = self.is_framed || matches!(self.line.guess, Guess::Raw { .. }) && !is_tx;
        let row = match outcome {
            Some(outcome) => RowOutcome::Frame(outcome),
            None if self.is_framed => RowOutcome::Incomplete,
            None => RowOutcome::Packet(PacketOutcome::Queued),
        };
        let protocol = if self.is_framed { Protocol::Framed } else { Protocol::Raw };
        let dissector = Dissector { protocol, addressed: self.addressed, channels: &|_| self.channels };
        let mut meaning = String::new();
        if is_known {
            dissector.summary(&bytes, row, &mut meaning);
        }
        let is_reply = is_tx || self.is_framed && FrameHead::of(&bytes, row).is_some_and(FrameHead::is_reply);
        LinePacket {
            line: self.line.name,
            kind: if is_reply {
                "reply"
            } else if self.is_framed {
                "frame"
            } else {
                "packet"
            },
            start_cycle,
            end_cycle,
            bytes,
            meaning,
            outcome: match outcome {
                Some(FrameOutcome::OtherAddress) => CRC_VALID.to_owned(),
                None if !self.is_framed => String::new(),
                _ => row.to_string(),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::serial::{DecodedByte, DecodedLine};
    use crate::trace::stored_run::StoredRun;
    use stepscope_sim::Experiment;

    fn run(json: &str) -> (StoredRun, u8) {
        let experiment = Experiment::from_json(json).expect("no problems");
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        recording.packets.finish();
        (recording, experiment.config().channels())
    }

    #[test]
    fn packets_of_a_framed_run_equal_the_log_of_its_controller() {
        for json in [
            r#"{"line":{"protocol":"framed"}}"#,
            r#"{"bus":{"channels":3},"line":{"protocol":"framed","baud":250000},"source":{"motion":{"axes":[{},{},{}]}}}"#,
        ] {
            let (recording, channels) = run(json);
            let report = Report::from_records(&recording.trace, 16_000_000, channels, None);
            let packets = Packets::of(&report, 16_000_000, channels, false);
            let log = &recording.packets;
            assert_eq!(packets.rows.len(), log.rows().len(), "{json}");
            assert!(packets.replies() > 5 && packets.replies() * 2 == packets.rows.len(), "{json}");
            for (index, (found, logged)) in packets.rows.iter().zip(log.rows()).enumerate() {
                let is_reply = matches!(logged.outcome, RowOutcome::Reply(_));
                let (line, kind) = if is_reply { ("TX", "reply") } else { ("RX", "frame") };
                assert_eq!((found.line, found.kind), (line, kind), "{index}");
                assert_eq!(found.bytes, log.bytes(index), "{index}");
                assert_eq!(found.outcome, CRC_VALID);
                assert!(found.start_cycle.abs_diff(logged.start.0) <= 139, "{found:?} {logged:?}");
                assert!(found.end_cycle.abs_diff(logged.end.0) <= 2 * 139, "{found:?} {logged:?}");
            }
        }
    }

    #[test]
    fn raw_packets_end_at_a_gap_and_broken_replies_are_marked() {
        let (recording, channels) = run(
            r#"{"bus":{"channels":2},"line":{"address":7},"source":{"packets":{"packets":["078a05","070203"]}}}"#,
        );
        let report = Report::from_records(&recording.trace, 16_000_000, channels, None);
        let packets = Packets::of(&report, 16_000_000, channels, true);
        let rows: Vec<_> =
            packets.rows.iter().map(|row| (row.kind, row.bytes.as_slice(), row.meaning.as_str())).collect();
        assert_eq!(rows[0], ("packet", [7, 0x8a, 5].as_slice(), "to 7, ch0 +10, ch1 \u{2212}5"));
        assert_eq!(rows[1].1, [7, 2, 3]);

        // Of the replies of a framed run one is spoiled, one is cut off, and a stop bit is low.
        let (recording, _) = run(r#"{"line":{"protocol":"framed"}}"#);
        let mut report = Report::from_records(&recording.trace, 16_000_000, 1, None);
        let tx = report.lines.iter_mut().find(|line| line.name == "TX").expect("it has TX");
        tx.decoded.bytes[3].byte ^= 0x40;
        tx.decoded.bytes.pop();
        tx.decoded.framing_errors.push(Instant(5));
        let packets = Packets::of(&report, 16_000_000, 1, false);
        let tx: Vec<_> = packets.rows.iter().filter(|row| row.line == "TX").collect();
        assert_eq!((tx[0].kind, tx[0].start_cycle, tx[0].bytes.len()), ("byte", 5, 0));
        assert!(tx[1].outcome.contains("CRC") && tx[1].meaning.is_empty(), "{:?}", tx[1]);
        assert_eq!(tx.last().map(|row| (row.kind, row.outcome.as_str())), Some(("reply", "incomplete")));
        let mut table = String::new();
        packets.write_csv(&mut table).expect("a string takes it");
        assert_eq!(table.lines().count(), packets.rows.len() + 1);
        assert!(table.lines().all(|row| row.split(',').count() >= 11), "{table}");
    }

    #[test]
    fn bytes_of_unknown_protocols_are_split_at_gaps() {
        let bytes =
            (0..40).map(|k| DecodedByte { start: Instant(1 + 10 * k + 500 * (k / 30)), byte: k as u8 });
        let decoded = DecodedLine { bytes: bytes.collect(), ..DecodedLine::default() };
        let report = Report {
            channels: Vec::new(),
            lines: Vec::from([LineReport::of_decoded(Levels::RX, decoded, 1000, 1000)]),
        };
        let rows = Packets::of(&report, 1000, 1, false).rows;
        assert_eq!(rows.iter().map(|row| row.bytes.len()).collect::<Vec<_>>(), [30, 10], "{rows:?}");
        assert!(rows.iter().all(|row| row.meaning.is_empty() && row.outcome.is_empty()), "{rows:?}");
    }
}
