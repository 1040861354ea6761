//! Replies that were recorded on TX, as one part of the page hands them to another: of each its first cycle and the first one after
//! it, how many bytes it has, and these.
//!
//! ```
//! use stepscope_inspect::recording::{packets::Packets, replies, report::Report};
//! use stepscope_peripheral::trace::Recording;
//! use stepscope_sim::Experiment;
//!
//! // A framed link, as a logic analyser would have seen it.
//! let mut recording = Recording::default();
//! Experiment::from_json(r#"{"line":{"protocol":"framed"}}"#).expect("the default motion, framed").run(&mut recording);
//! let report = Report::of(&recording.trace, 16_000_000, 1, None);
//! let packets = Packets::of(&report, 16_000_000, 1, false);
//! let found = replies::of(&replies::to_bytes(&packets, 0..u64::MAX));
//! assert_eq!(found.len(), packets.replies());
//! assert!(found.iter().all(|reply| reply.reply.is_some()));
//! ```

use super::{packets::Packets, serial::line_name};
use crate::dissector::reply;
use alloc::vec::Vec;
use core::ops::Range;
use stepscope_peripheral::{signal::Levels, trace::RecordedReply, units::Instant};

/// What TX said within some cycles.
#[must_use]
pub fn to_bytes(packets: &Packets, cycles: Range<u64>) -> Vec<u8> {
    let tx = line_name(Levels::TX);
    let mut bytes = Vec::new();
    let heard = |row: &&super::packets::LinePacket| row.line == tx && !row.bytes.is_empty();
    for row in packets.rows.iter().filter(heard).filter(|row| cycles.contains(&row.start_cycle)) {
        bytes.extend(row.start_cycle.to_le_bytes());
        bytes.extend(row.end_cycle.to_le_bytes());
        bytes.extend((row.bytes.len() as u64).to_le_bytes());
        bytes.extend_from_slice(&row.bytes);
    }
    bytes
}

/// What was handed on, as far as it is whole and in the order of time; of frames, what they say.
#[must_use]
#[inline(never)]
pub fn of(mut bytes: &[u8]) -> Vec<RecordedReply> {
    let mut replies = Vec::new();
    let mut last = 0;
    while let Some(([start, end, length], rest)) = head(bytes) {
        let Some((own, rest)) = usize::try_from(length).ok().and_then(|length| rest.split_at_checked(length))
        else {
            break;
        };
        if start < last || end < start {
            break;
        }
        (bytes, last) = (rest, start);
        let (start, end) = (Instant(start), Instant(end));
        replies.push(RecordedReply { start, end, bytes: own.into(), reply: reply(own) });
    }
    replies
}

/// The three numbers before the bytes of each.
fn head(bytes: &[u8]) -> Option<([u64; 3], &[u8])> {
    let (numbers, rest) = bytes.split_at_checked(24)?;
    let (words, _) = numbers.as_chunks::<8>();
    let &[start, end, length] = words else { return None };
    Some(([start, end, length].map(u64::from_le_bytes), rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{packet_table::PacketTable, recording::report::Report};
    use stepscope_peripheral::trace::Recording;
    use stepscope_sim::Experiment;

    #[test]
    fn recorded_replies_stand_in_the_table_of_packets_with_the_turnaround_that_they_had() {
        let json = r#"{"line":{"protocol":"framed"}}"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let mut recording = Recording::default();
        let run = experiment.run(&mut recording);
        recording.packets.finish();
        let made = recording.packets.clone();
        // The device took 500 cycles more for each than the model does; one reply is spoilt on its way.
        let mut report = Report::of(&recording.trace, 16_000_000, 1, None);
        let tx = report.lines.iter_mut().find(|line| line.name == "TX").expect("it answers");
        tx.heard.bytes.iter_mut().for_each(|byte| byte.start = Instant(byte.start.0 + 500));
        tx.heard.bytes[3].byte ^= 0x40;
        let bytes = to_bytes(&Packets::of(&report, 16_000_000, 1, false), 0..u64::MAX);
        recording.packets.answer(&of(&bytes));

        let own = PacketTable::new(&experiment, &run, 0, &made);
        let table = PacketTable::new(&experiment, &run, 0, &recording.packets);
        assert_eq!(table.len(), own.len());
        let replies: Vec<usize> = (0..own.len())
            .filter(|row| own.kind(*row) == table.kind(*row) && own.is_own_reply(*row))
            .collect();
        assert_eq!(replies.len() * 2, own.len());
        for (nth, &index) in replies.iter().enumerate() {
            let [model, found] = [&own, &table].map(|table| table.detail(index).expect("a row"));
            assert_eq!(found.answers, model.answers, "row {index}");
            let later =
                found.turnaround_cycles.expect("it answers") - model.turnaround_cycles.expect("it answers");
            assert!(later.abs_diff(500) <= 1, "row {index}: {later}");
            assert_eq!(found.drive_cycles, None, "when DE rose is not known");
            assert_eq!(found.row.hex == model.row.hex, nth > 0);
            let text = if nth == 0 { "recorded: no known reply" } else { model.row.outcome.as_str() };
            assert_eq!((found.row.outcome.as_str(), found.row.kind), (text, "reply"));
            assert_eq!(found.check, if nth == 0 { "fails" } else { "holds" });
        }
        // What the model answered is nowhere left, and what is no reply is as it was.
        for index in (0..own.len()).filter(|index| !own.is_own_reply(*index)) {
            assert_eq!(
                own.row(index).map(|row| (row.start_cycle, row.outcome)),
                table.row(index).map(|row| (row.start_cycle, row.outcome))
            );
        }
    }

    #[test]
    fn what_was_handed_on_is_read_as_far_as_it_is_whole_and_in_order() {
        let row = |start: u64, end: u64, bytes: &[u8]| {
            let mut row: Vec<u8> =
                [start, end, bytes.len() as u64].iter().flat_map(|word| word.to_le_bytes()).collect();
            row.extend_from_slice(bytes);
            row
        };
        let two = [row(5, 9, &[1, 2]), row(20, 30, &[3])].concat();
        let starts = |bytes: &[u8]| of(bytes).iter().map(|reply| reply.start.0).collect::<Vec<_>>();
        for (bytes, expected) in [
            (two.clone(), [5, 20].as_slice()),
            (two[..two.len() - 1].to_vec(), &[5]),
            ([row(5, 9, &[1]), row(4, 9, &[1])].concat(), &[5]),
            (row(5, 4, &[1]), &[]),
            ([5_u64, 9, u64::MAX].iter().flat_map(|word| word.to_le_bytes()).collect(), &[]),
            (Vec::new(), &[]),
        ] {
            assert_eq!(starts(&bytes), expected, "{bytes:?}");
        }
        assert!(of(&two).iter().all(|reply| reply.reply.is_none()));
    }
}
