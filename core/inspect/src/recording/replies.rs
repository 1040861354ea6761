//! Recorded replies on TX as bytes for the page's workers: each has start, end, length and controller, then its bytes.

use super::packets::{Found, Line};
use super::{report::Report, serial::line_name};
use crate::packets::dissector::{FrameHead, parse_reply};
use crate::packets::log::{PacketLog, RecordedReply, RowOutcome};
use crate::packets::packet_table::{PacketTable, RowKind};
use alloc::vec::Vec;
use core::ops::Range;
use stepscope_peripheral::{signal::Levels, units::Instant};
use stepscope_sim::{Experiment, Run};

/// Replies encoded for [`decode`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EncodedReplies {
    pub bytes: Vec<u8>,
    /// Number of replies without a known controller; they are assigned to the first one.
    pub unknown: usize,
}

/// Encodes the replies on TX within `cycles`, each assigned to a controller by its address. A reply without an address
/// belongs to the controller that RX addressed last.
pub fn encode(report: &Report, clock_hz: u32, cycles: Range<u64>, addresses: &[u8]) -> EncodedReplies {
    let of = |mask| {
        let line = report.lines.iter().find(|line| line.name == line_name(mask));
        line.map(|line| Line::new(line, clock_hz, 0, false))
    };
    let mut encoded = EncodedReplies::default();
    let Some(tx) = of(Levels::TX) else { return encoded };
    let index_of = |address: u8| addresses.iter().position(|own| *own == address);
    let mut commands: Vec<(u64, usize)> = Vec::new();
    if let Some(rx) = of(Levels::RX).filter(|_| addresses.len() > 1) {
        rx.each(|Found { end_cycle, bytes, outcome, .. }| {
            let head = outcome.and_then(|outcome| FrameHead::of(&bytes, RowOutcome::Frame(outcome)));
            // RX may carry replies of other controllers.
            let to = head.filter(|head| !head.is_reply()).and_then(|head| index_of(head.address));
            commands.extend(to.map(|to| (end_cycle, to)));
        });
    }
    tx.each(|Found { start_cycle, end_cycle, bytes, .. }| {
        if !cycles.contains(&start_cycle) {
            return;
        }
        let named = parse_reply(&bytes).and_then(|reply| index_of(reply.address));
        let last = || commands.get(commands.partition_point(|(end, _)| *end <= start_cycle).checked_sub(1)?);
        let controller = named.or_else(|| last().map(|(_, index_of)| *index_of));
        encoded.unknown += usize::from(controller.is_none() && addresses.len() > 1);
        let length = bytes.len() as u64 | (controller.unwrap_or(0) as u64) << CONTROLLER_SHIFT;
        for word in [start_cycle, end_cycle, length] {
            encoded.bytes.extend(word.to_le_bytes());
        }
        encoded.bytes.extend(bytes);
    });
    encoded
}

const CONTROLLER_SHIFT: u32 = 32;

/// The replies of one controller, up to the first invalid one.
pub fn decode(mut bytes: &[u8], controller: usize) -> Vec<RecordedReply<'_>> {
    let mut replies = Vec::new();
    let mut last = 0;
    while let Some(([start, end, length], rest)) = parse_head(bytes) {
        let Some((own, rest)) = rest.split_at_checked(length as u32 as usize) else { break };
        if start < last || end < start {
            break;
        }
        (bytes, last) = (rest, start);
        if length >> CONTROLLER_SHIFT != controller as u64 {
            continue;
        }
        let (start, end) = (Instant(start), Instant(end));
        replies.push(RecordedReply { start, end, bytes: own, reply: parse_reply(own) });
    }
    replies
}

/// Replaces the replies in a controller's finished log by recorded ones: its own, and those received from others.
pub fn replace(bytes: &[u8], experiment: &Experiment, run: &Run, controller: usize, log: &mut PacketLog) {
    let table = PacketTable::new(experiment, run, controller, log);
    let is_simulated: Vec<bool> =
        (0..table.len()).map(|row| table.kind(row) == Some(RowKind::Reply)).collect();
    log.replace_replies(&decode(bytes, controller), &is_simulated);
}

fn parse_head(bytes: &[u8]) -> Option<([u64; 3], &[u8])> {
    let (numbers, rest) = bytes.split_at_checked(24)?;
    let (words, _) = numbers.as_chunks::<8>();
    let &[start, end, length] = words else { return None };
    Some(([start, end, length].map(u64::from_le_bytes), rest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use crate::{packets::packet_table::PacketTable, recording::report::Report};
    use stepscope_sim::Experiment;

    #[test]
    fn recorded_replies_are_rows_with_their_turnaround() {
        let json = r#"{"line":{"protocol":"framed"}}"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let mut recording = StoredRun::default();
        let run = experiment.run(&mut recording);
        recording.packets.finish();
        let simulated = recording.packets.clone();
        // The device replies 500 cycles later than the model, and one reply is damaged.
        let mut report = Report::from_records(&recording.trace, 16_000_000, 1, None);
        let tx = report.lines.iter_mut().find(|line| line.name == "TX").expect("it has TX");
        tx.decoded.bytes.iter_mut().for_each(|byte| byte.start = Instant(byte.start.0 + 500));
        tx.decoded.bytes[3].byte ^= 0x40;
        let EncodedReplies { bytes, unknown } = encode(&report, 16_000_000, 0..u64::MAX, &[0]);
        assert_eq!(unknown, 0, "there is only one controller");
        replace(&bytes, &experiment, &run, 0, &mut recording.packets);

        let own = PacketTable::new(&experiment, &run, 0, &simulated);
        let table = PacketTable::new(&experiment, &run, 0, &recording.packets);
        assert_eq!(table.len(), own.len());
        let replies: Vec<usize> = (0..own.len())
            .filter(|row| own.kind(*row) == table.kind(*row) && own.is_own_reply(*row))
            .collect();
        assert_eq!(replies.len() * 2, own.len());
        for (nth, &index) in replies.iter().enumerate() {
            let [model, found] = [&own, &table].map(|table| table.detail(index).expect("a row"));
            assert_eq!(found.answers, model.answers, "row {index}");
            let later = found.turnaround_cycles.expect("it is a reply")
                - model.turnaround_cycles.expect("it is a reply");
            assert!(later.abs_diff(500) <= 1, "row {index}: {later}");
            assert_eq!(found.drive_cycles, None, "the rise of DE is not recorded");
            assert_eq!(found.row.hex == model.row.hex, nth > 0);
            let text = if nth == 0 { "recorded: unknown reply" } else { model.row.outcome.as_str() };
            assert_eq!((found.row.outcome.as_str(), found.row.kind), (text, "reply"));
            assert_eq!(found.check, if nth == 0 { "fails" } else { "holds" });
        }
        // No simulated reply is left, and other rows are unchanged.
        for index in (0..own.len()).filter(|index| !own.is_own_reply(*index)) {
            assert_eq!(
                own.row(index).map(|row| (row.start_cycle, row.outcome)),
                table.row(index).map(|row| (row.start_cycle, row.outcome))
            );
        }
    }

    #[test]
    fn replies_belong_to_their_address_or_the_last_addressed_controller() {
        let json = r#"{"line":{"protocol":"framed","address":3},"controllers":[{"address":7,"axes":[{"moves":[{"cosine":{"distance":{"steps":200}}}]}]}]}"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let mut recordings = [StoredRun::default(), StoredRun::default()];
        let run = experiment.run_each(&mut recordings);
        recordings.iter_mut().for_each(|one| one.packets.finish());
        let simulated = recordings.each_ref().map(|one| one.packets.clone());
        // One analyzer at the line: TX is low where one of both sends.
        let mut report = Report::from_records(&recordings[0].trace, 16_000_000, 1, None);
        let others = Report::from_records(&recordings[1].trace, 16_000_000, 1, None).lines;
        let others = others.into_iter().find(|line| line.name == "TX").expect("it has TX");
        let line = report.lines.iter_mut().find(|line| line.name == "TX").expect("it has TX");
        let first = others.decoded.bytes[0].start;
        line.decoded.bytes.extend(others.decoded.bytes);
        line.decoded.bytes.sort_by_key(|byte| byte.start);
        // The first reply of the other controller is damaged.
        let damaged = line.decoded.bytes.iter_mut().find(|byte| byte.start == first).expect("it is there");
        damaged.byte ^= 0x40;
        let all = 0..u64::MAX;
        let EncodedReplies { bytes, unknown } = encode(&report, 16_000_000, all.clone(), &[3, 7]);
        assert_eq!(unknown, 0);
        let addresses = [3, 7];
        for (index, one) in recordings.iter_mut().enumerate() {
            replace(&bytes, &experiment, &run, index, &mut one.packets);
            let own = PacketTable::new(&experiment, &run, index, &simulated[index]);
            let table = PacketTable::new(&experiment, &run, index, &one.packets);
            let replies = |table: &PacketTable<'_>| -> Vec<_> {
                (0..table.len())
                    .filter(|row| table.is_own_reply(*row))
                    .map(|row| table.bytes(row).to_vec())
                    .collect()
            };
            assert_eq!(replies(&table).len(), replies(&own).len());
            assert_eq!(replies(&table)[1..], replies(&own)[1..]);
            // No simulated reply is left, not even a received one.
            for row in (0..table.len()).filter(|row| table.kind(*row) == Some(RowKind::Reply)) {
                assert!(table.is_own_reply(row), "{row}");
                assert!(table.address(row).is_none_or(|address| address == addresses[index]), "{row}");
            }
        }
        // No host sent commands: replies without an address count for the first controller and as unknown.
        report.lines.retain(|line| line.name == "TX");
        let without_rx = encode(&report, 16_000_000, all.clone(), &addresses);
        assert_eq!((without_rx.unknown, without_rx.bytes.len()), (1, bytes.len()));
        assert_eq!(decode(&without_rx.bytes, 0).len(), decode(&bytes, 0).len() + 1);
        // With one controller none is unknown; a part has the replies that begin in it.
        assert_eq!(encode(&report, 16_000_000, all, &[3]).unknown, 0);
        let part = encode(&report, 16_000_000, first.0..first.0 + 1, &addresses);
        assert_eq!((part.unknown, decode(&part.bytes, 0).len()), (1, 1));
        report.lines.clear();
        assert_eq!(encode(&report, 16_000_000, 0..u64::MAX, &addresses), EncodedReplies::default());
    }

    #[test]
    fn transferred_replies_are_read_while_valid_and_in_order() {
        let row = |start: u64, end: u64, bytes: &[u8]| {
            let mut row: Vec<u8> =
                [start, end, bytes.len() as u64].iter().flat_map(|word| word.to_le_bytes()).collect();
            row.extend_from_slice(bytes);
            row
        };
        let mut others = row(7, 8, &[4]);
        others[20] = 1;
        let two = [row(5, 9, &[1, 2]), row(20, 30, &[3])].concat();
        let starts = |bytes: &[u8]| decode(bytes, 0).iter().map(|reply| reply.start.0).collect::<Vec<_>>();
        for (bytes, expected) in [
            (two.clone(), [5, 20].as_slice()),
            (two[..two.len() - 1].to_vec(), &[5]),
            ([row(5, 9, &[1]), row(4, 9, &[1])].concat(), &[5]),
            (row(5, 4, &[1]), &[]),
            // Replies of another controller are skipped.
            ([row(5, 9, &[1]), others, row(20, 30, &[3])].concat(), &[5, 20]),
            ([5_u64, 9, u64::MAX].iter().flat_map(|word| word.to_le_bytes()).collect(), &[]),
            (Vec::new(), &[]),
        ] {
            assert_eq!(starts(&bytes), expected, "{bytes:?}");
        }
        assert!(decode(&two, 0).iter().all(|reply| reply.reply.is_none()));
    }
}
