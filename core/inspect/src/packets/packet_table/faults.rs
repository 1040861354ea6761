//! Why a packet was dropped or refused, and the first row of each fault flag.

use super::PacketTable;
use crate::packets::dissector::decoded;
use crate::packets::log::{LoggedPacket, RowOutcome};
use alloc::{format, string::String, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::protocol::{FrameOutcome, Reason, Reply};
use stepscope_peripheral::wire::frame::{CRC_LEN, MAX_DECODED, MIN_DECODED, Ticks};
use stepscope_peripheral::wire::packet::{ChannelCommand, GAP_BITS};
use stepscope_peripheral::{device::Faults, signal::PacketOutcome};

/// Maximum rows from a frame to its reply.
const NEAR: usize = 64;

/// A fault flag, with the first row that set it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct FirstFault {
    pub name: &'static str,
    pub times: u64,
    pub cycle: u64,
    pub row: Option<usize>,
}

impl PacketTable<'_> {
    /// Such as `3 of 4 bytes, then 45 bit times of silence`; empty if [`Row::outcome`](super::Row::outcome) says it all.
    pub fn why(&self, index: usize) -> String {
        let Some(row) = self.logged(index) else { return String::new() };
        let bytes = self.bytes(index);
        let of_packet = count(self.config.packet_len(), "byte");
        match row.outcome {
            RowOutcome::Short => {
                format!("{} of {of_packet}, then {GAP_BITS} bit times of silence", bytes.len())
            }
            RowOutcome::Framing => format!(
                "the stop bit of byte {} of {} was low; all bytes are ignored until {GAP_BITS} bit times of silence",
                bytes.len() + 1,
                self.config.packet_len()
            ),
            RowOutcome::Ignored => format!(
                "{} after a framing error, before {GAP_BITS} bit times of silence",
                count(bytes.len(), "byte")
            ),
            RowOutcome::Packet(PacketOutcome::TooManySteps) => {
                let first = usize::from(self.config.packet_address().is_some());
                self.too_many(bytes.get(first..).unwrap_or_default())
            }
            RowOutcome::Packet(PacketOutcome::QueueFull) => match self.config.queue_depth() {
                1 => "the queue (1 entry) was full".into(),
                depth => format!("the queue ({depth} entries) was full"),
            },
            RowOutcome::Packet(PacketOutcome::Booting) => "the controller was still in its self-test".into(),
            RowOutcome::Frame(FrameOutcome::Short) => short_frame(bytes),
            RowOutcome::Frame(FrameOutcome::Overlong) => {
                format!("more than {MAX_DECODED} bytes before a delimiter")
            }
            RowOutcome::Frame(FrameOutcome::Refused(reason)) => self.why_refused(index, reason),
            _ => String::new(),
        }
    }

    /// All fault flags that were set, in the order of their bits.
    pub fn first_faults(&self) -> Vec<FirstFault> {
        let mut first: Vec<FirstFault> = Vec::new();
        let mut raise = |fault: Faults, cycle: u64, row: Option<usize>| {
            for name in fault.names() {
                match first.iter_mut().find(|fault| fault.name == name) {
                    Some(fault) => {
                        fault.times += 1;
                        if cycle < fault.cycle {
                            (fault.cycle, fault.row) = (cycle, row);
                        }
                    }
                    None => first.push(FirstFault { name, times: 1, cycle, row }),
                }
            }
        };
        for (index, row) in self.log.rows().iter().enumerate() {
            raise(fault_of(row), row.end.0, Some(index));
        }
        for &seen in self.log.framing_errors() {
            let row = self.log.touching(seen, seen).next();
            raise(Faults::FRAMING, seen.0, row);
        }
        for at in self.log.underruns() {
            raise(Faults::UNDERRUN, at.0, None);
        }
        let fault = |name| first.iter().find(|fault| fault.name == name).copied();
        Faults::ALL.names().filter_map(fault).collect()
    }

    /// The first command of a tick that exceeds the tick's slots.
    fn too_many(&self, commands: &[u8]) -> String {
        let (slots, channels) = (self.config.slots(), usize::from(self.config.channels().max(1)));
        let moves =
            commands.iter().enumerate().map(|(index, &byte)| (index, ChannelCommand::parse(byte).steps));
        let Some((index, steps)) = moves.into_iter().find(|(_, steps)| *steps > slots) else {
            return String::new();
        };
        let tick = match index / channels {
            0 if commands.len() <= channels => String::new(),
            tick => format!("tick {tick}, "),
        };
        format!("{tick}channel {}: {steps} steps do not fit in {slots} slots", index % channels)
    }

    fn why_refused(&self, index: usize, reason: Reason) -> String {
        let (content, _) = decoded(self.bytes(index));
        let body = content.get(2..content.len().saturating_sub(CRC_LEN)).unwrap_or_default();
        let ticks = Ticks::parse(body, self.config.channels());
        let status = self.reply_to(index).map(|reply| reply.status);
        match (reason, ticks, status) {
            (Reason::BadSeq, Some(ticks), Some(status)) => {
                format!("sequence number {} instead of {}", ticks.seq, status.expected_seq)
            }
            (Reason::QueueFull, Some(ticks), Some(status)) => {
                format!(
                    "{} for {} in the queue",
                    count(ticks.count(), "tick"),
                    count(status.free.into(), "free entry")
                )
            }
            (Reason::TooManySteps, Some(ticks), _) => self.too_many(ticks.commands()),
            (Reason::Busy, _, Some(status)) => format!("the controller was {}", status.state.name()),
            (Reason::Stopped, ..) => "stopped; send ENABLE first".into(),
            (Reason::BadBody, ..) => {
                format!("a body of {} does not match this kind of frame", count(body.len(), "byte"))
            }
            (Reason::UnknownKind, ..) => "unknown kind of frame".into(),
            _ => String::new(),
        }
    }

    fn reply_to(&self, index: usize) -> Option<Reply> {
        (index + 1..index + NEAR).find_map(|after| match self.logged(after)?.outcome {
            RowOutcome::Reply(reply) if self.answered(after) == Some(index) => Some(reply),
            _ => None,
        })
    }
}

fn fault_of(row: &LoggedPacket) -> Faults {
    match row.outcome {
        RowOutcome::Short | RowOutcome::Frame(FrameOutcome::Short) => Faults::SHORT_PACKET,
        RowOutcome::Frame(FrameOutcome::BadCrc { .. }) => Faults::CRC,
        RowOutcome::Frame(FrameOutcome::Overlong) => Faults::OVERLONG,
        RowOutcome::Packet(PacketOutcome::QueueFull)
        | RowOutcome::Frame(FrameOutcome::Refused(Reason::QueueFull)) => Faults::QUEUE_OVERFLOW,
        RowOutcome::Packet(PacketOutcome::TooManySteps)
        | RowOutcome::Frame(FrameOutcome::Refused(Reason::TooManySteps)) => Faults::TOO_MANY_STEPS,
        RowOutcome::Frame(FrameOutcome::Refused(Reason::BadSeq)) => Faults::BAD_SEQ,
        _ => Faults::default(),
    }
}

fn short_frame(bytes: &[u8]) -> String {
    let (content, is_complete) = decoded(bytes);
    let bytes = count(content.len(), "byte");
    if is_complete {
        format!("{bytes} without COBS; a frame has at least {MIN_DECODED}")
    } else {
        format!("the delimiter came after {bytes}, before the end that COBS gives")
    }
}

fn count(number: usize, one: &str) -> String {
    match one.strip_suffix('y') {
        _ if number == 1 => format!("1 {one}"),
        Some(stem) => format!("{number} {stem}ies"),
        None => format!("{number} {one}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use stepscope_peripheral::wire::frame::emit;
    use stepscope_sim::Experiment;

    /// The reason of each row, and the flags: name, times, row.
    type Reported = (Vec<String>, Vec<(&'static str, u64, Option<usize>)>);

    fn reported(json: &str) -> Reported {
        let experiment = Experiment::from_json(json).expect("no problems");
        let mut recording = StoredRun::default();
        let run = experiment.run(&mut recording);
        let table = PacketTable::new(&experiment, &run, 0, &recording.packets);
        let first = table.first_faults();
        let names: Vec<&str> = first.iter().map(|fault| fault.name).collect();
        assert_eq!(names, run.faults().names().collect::<Vec<_>>(), "{json}");
        let why = (0..table.len()).map(|index| table.why(index)).collect();
        (why, first.iter().map(|fault| (fault.name, fault.times, fault.row)).collect())
    }

    fn raw(line: &str, sends: &[(u64, &str)]) -> Reported {
        let sends =
            sends.iter().map(|(start, bytes)| format!(r#"{{"start_cycle":{start},"bytes":"{bytes}"}}"#));
        let sends = sends.collect::<Vec<_>>().join(",");
        reported(&format!(
            r#"{{"bus":{{"channels":2,"slots":10,"step_period_cycles":800,"queue_depth":1}},"line":{line},"source":{{"line":{{"sends":[{sends}]}}}}}}"#
        ))
    }

    #[test]
    fn dropped_raw_packets_have_a_reason() {
        let address = r#"{"address":7}"#;
        let (why, first) = raw(address, &[(2000, "078a05"), (12_000, "078b00"), (32_000, "0781")]);
        let expected =
            ["", "channel 0: 11 steps do not fit in 10 slots", "2 of 3 bytes, then 45 bit times of silence"];
        assert_eq!(why, expected);
        assert_eq!(first, [("SHORT_PACKET", 1, Some(2)), ("TOO_MANY_STEPS", 1, Some(1))]);

        let (why, first) = raw("{}", &[(2000, "8a8a8a8a8a8a8a8a")]);
        assert_eq!(why, ["", "", "the queue (1 entry) was full", ""]);
        assert_eq!(first, [("QUEUE_OVERFLOW", 1, Some(2))]);

        // The stop bit of the second byte is forced low: bit 19 of 139 cycles.
        let glitch = r#"{"glitches":[{"start_cycle":4641,"length_cycles":139,"level":0}]}"#;
        let (why, first) = raw(glitch, &[(2000, "8a8a"), (6000, "05")]);
        let framing =
            "the stop bit of byte 2 of 2 was low; all bytes are ignored until 45 bit times of silence";
        assert_eq!(why, [framing, "1 byte after a framing error, before 45 bit times of silence"]);
        assert_eq!(first, [("FRAMING", 1, Some(0))]);
    }

    #[test]
    fn dropped_and_refused_frames_have_a_reason() {
        let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
        let ticks = |seq, commands: &[u8]| emit(0, 1, &Ticks::emit(seq, 1, commands));
        let frames = [
            (vec![3, 1, 2, 0], "2 bytes without COBS; a frame has at least 6"),
            (vec![9, 1, 2, 0], "the delimiter came after 2 bytes, before the end that COBS gives"),
            (ticks(3, &[0x81]), "sequence number 3 instead of 0"),
            (ticks(0, &[0x81; 20]), "20 ticks for 4 free entries in the queue"),
            (ticks(0, &[0x81, 0x8b]), "tick 1, channel 0: 11 steps do not fit in 10 slots"),
            (emit(0, 1, &[0]), "a body of 1 byte does not match this kind of frame"),
            (emit(0, 99, &[]), "unknown kind of frame"),
            (ticks(0, &[0x81]), ""),
        ];
        let sends: Vec<String> = (1..)
            .zip(&frames)
            .map(|(fault, (bytes, _))| {
                format!(r#"{{"start_cycle":{},"bytes":"{}"}}"#, fault * 120_000, hex(bytes))
            })
            .collect();
        let (why, first) = reported(&format!(
            r#"{{"bus":{{"channels":1,"slots":10,"step_period_cycles":800,"queue_depth":4}},"line":{{"protocol":"framed"}},"source":{{"line":{{"sends":[{}]}}}}}}"#,
            sends.join(",")
        ));
        // The replies between them have no reason.
        let reasons: Vec<&str> = why.iter().map(String::as_str).filter(|text| !text.is_empty()).collect();
        let expected: Vec<&str> =
            frames.iter().map(|(_, text)| *text).filter(|text| !text.is_empty()).collect();
        assert_eq!(reasons, expected);
        let names: Vec<_> = first.iter().map(|(name, times, _)| (*name, *times)).collect();
        let flags = ["SHORT_PACKET", "QUEUE_OVERFLOW", "TOO_MANY_STEPS", "BAD_SEQ"];
        assert_eq!(names[..4], [(flags[0], 2), (flags[1], 1), (flags[2], 1), (flags[3], 1)]);
        assert_eq!(names.get(4), Some(&("UNDERRUN", 1)), "the one tick has steps, and none follows");
    }
}
