//! The packets of a run, one row each: time, bytes and outcome.

use alloc::{collections::VecDeque, vec::Vec};
use core::fmt;
use stepscope_peripheral::{
    protocol::{FrameOutcome, Kind, Reply},
    signal::{Event, PacketOutcome, Record, Sink},
    units::{Cycles, Instant},
    wire::packet::Tick,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowOutcome {
    Packet(PacketOutcome),
    /// Cut short by a gap (fault SHORT_PACKET).
    Short,
    /// Dropped by a framing error (fault FRAMING); its last byte was not delivered.
    Framing,
    /// Bytes that were ignored after a framing error.
    Ignored,
    /// A frame, or bytes that are none.
    Frame(FrameOutcome),
    Reply(Reply),
    /// Recorded on the controller's own line, but no known reply.
    Recorded,
    /// Two senders at once.
    Collision,
    Open,
}

impl fmt::Display for RowOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Packet(PacketOutcome::Queued) => "queued",
            Self::Packet(PacketOutcome::OtherAddress) => "another address",
            Self::Packet(PacketOutcome::Booting) => "dropped: self-test after reset",
            Self::Packet(PacketOutcome::Stopped) => "dropped: stopped",
            Self::Packet(PacketOutcome::TooManySteps) => "dropped: TOO_MANY_STEPS",
            Self::Packet(PacketOutcome::QueueFull) => "dropped: QUEUE_OVERFLOW",
            Self::Short => "dropped: SHORT_PACKET",
            Self::Framing => "dropped: FRAMING",
            Self::Ignored => "ignored until a gap",
            Self::Frame(frame) => return frame.fmt(f),
            Self::Reply(reply) => return reply.fmt(f),
            Self::Recorded => "recorded: no known reply",
            Self::Collision => "collision: the controller and another drive the line",
            Self::Open => "not complete",
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedPacket {
    /// Start bit of its first byte.
    pub start: Instant,
    /// Complete or aborted.
    pub end: Instant,
    pub outcome: RowOutcome,
    /// First cycle of its first tick.
    pub tick_start: Option<Instant>,
    /// First cycle after its last tick that has ended.
    pub tick_end: Option<Instant>,
    bytes_start: usize,
    bytes_end: usize,
    /// The latest end of all rows up to this one; a long row may end after later ones.
    latest: Instant,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedReply<'a> {
    /// First start bit.
    pub start: Instant,
    pub end: Instant,
    pub bytes: &'a [u8],
    pub reply: Option<Reply>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedTick {
    pub start: Instant,
    pub commands: Tick,
    /// `None` for a tick that firmware pushed.
    pub row: Option<usize>,
}

/// The packets of a run.
#[derive(Clone, Debug, Default)]
pub struct PacketLog {
    rows: Vec<LoggedPacket>,
    bytes: Vec<u8>,
    /// Start bit per byte; the bytes of a reply share the first.
    seen: Vec<Instant>,
    broken: Vec<Instant>,
    open: Option<Instant>,
    last: Instant,
    ignoring: bool,
    /// The row per queued tick; `None` if firmware pushed it.
    waiting: VecDeque<Option<usize>>,
    ticks: Vec<LoggedTick>,
    stops: Vec<Instant>,
    underruns: Vec<Instant>,
    is_answered: bool,
}

impl PacketLog {
    /// In the order of their starts once the log is finished; before, a reply precedes its start, and a collision its
    /// packet.
    pub fn rows(&self) -> &[LoggedPacket] {
        &self.rows
    }

    pub fn ticks(&self) -> &[LoggedTick] {
        &self.ticks
    }

    /// First cycle after a tick of `length`, unless STOP ends it early.
    pub fn tick_end(&self, tick: &LoggedTick, length: Cycles) -> Instant {
        let stop = self.stops.get(self.stops.partition_point(|stop| *stop < tick.start));
        stop.map_or(tick.start + length, |stop| (tick.start + length).min(*stop))
    }

    pub fn bytes(&self, index: usize) -> &[u8] {
        let row = self.rows.get(index);
        row.and_then(|row| self.bytes.get(row.bytes_start..row.bytes_end)).unwrap_or_default()
    }

    /// Start bits of a row's bytes; those of a reply share the first.
    pub fn seen(&self, index: usize) -> &[Instant] {
        let row = self.rows.get(index);
        row.and_then(|row| self.seen.get(row.bytes_start..row.bytes_end)).unwrap_or_default()
    }

    /// Start bits of bytes with a framing error, rising.
    pub fn broken(&self) -> &[Instant] {
        &self.broken
    }

    /// Ends of ticks with steps that none followed (fault UNDERRUN), rising.
    pub fn underruns(&self) -> &[Instant] {
        &self.underruns
    }

    /// Whether replies come from a recording.
    pub const fn is_answered(&self) -> bool {
        self.is_answered
    }

    /// Replaces the rows of `is_simulated` by recorded replies, in the order of their starts. The log must be finished.
    pub fn answer(&mut self, recorded: &[RecordedReply<'_>], is_simulated: &[bool]) {
        let rows = core::mem::take(&mut self.rows);
        let mut new_index = alloc::vec![None; rows.len()];
        for ((row, new_index), is_simulated) in rows.into_iter().zip(&mut new_index).zip(is_simulated) {
            if !is_simulated {
                *new_index = Some(self.rows.len());
                self.rows.push(row);
            }
        }
        recorded.iter().for_each(|reply| self.push_recorded(reply));
        for tick in &mut self.ticks {
            tick.row = tick.row.and_then(|row| new_index.get(row).copied().flatten());
        }
        self.is_answered = true;
        self.finish();
    }

    fn push_recorded(&mut self, RecordedReply { start, end, bytes, reply }: &RecordedReply<'_>) {
        let bytes_start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.seen.resize(self.bytes.len(), *start);
        self.rows.push(LoggedPacket {
            start: *start,
            end: *end,
            outcome: reply.map_or(RowOutcome::Recorded, RowOutcome::Reply),
            tick_start: None,
            tick_end: None,
            bytes_start,
            bytes_end: self.bytes.len(),
            latest: *end,
        });
    }

    /// Indices of the rows of a finished log whose time on the line touches the cycles `start..=end`, rising.
    pub fn touching(&self, start: Instant, end: Instant) -> impl Iterator<Item = usize> {
        let first = self.rows.partition_point(|row| row.latest < start);
        let rows = self.rows.iter().enumerate().skip(first).take_while(move |(_, row)| row.start <= end);
        rows.filter(move |(_, row)| row.end >= start).map(|(index, _)| index)
    }

    /// Closes an open row and sorts the rows by their starts.
    pub fn finish(&mut self) {
        debug_assert!(self.broken.is_sorted(), "framing errors go back in time");
        if self.open.is_some() {
            self.close(self.last, if self.ignoring { RowOutcome::Ignored } else { RowOutcome::Open });
        }
        if !self.rows.is_sorted_by_key(|row| row.start) {
            self.sort();
        }
        let mut latest = Instant::default();
        for row in &mut self.rows {
            latest = latest.max(row.end);
            row.latest = latest;
        }
        debug_assert!(
            self.rows.is_sorted_by_key(|row| row.start),
            "rows are not in the order of their starts"
        );
    }

    fn sort(&mut self) {
        let mut order: Vec<usize> = (0..self.rows.len()).collect();
        order.sort_by_key(|&row| self.rows.get(row).map(|row| row.start));
        let mut new_index = alloc::vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            new_index[old] = new;
        }
        self.rows = order.iter().filter_map(|&old| self.rows.get(old).copied()).collect();
        for tick in &mut self.ticks {
            tick.row = tick.row.and_then(|row| new_index.get(row).copied());
        }
    }

    fn bytes_of_open(&self) -> Vec<u8> {
        let first = self.rows.last().map_or(0, |row| row.bytes_end);
        self.bytes.get(first..).unwrap_or_default().to_vec()
    }

    fn close(&mut self, end: Instant, outcome: RowOutcome) {
        let start = self.open.take().unwrap_or(end);
        let queued = match outcome {
            RowOutcome::Packet(PacketOutcome::Queued) => 1,
            RowOutcome::Frame(FrameOutcome::Queued(ticks)) => ticks.into(),
            _ => 0,
        };
        self.waiting.extend(core::iter::repeat_n(Some(self.rows.len()), queued));
        if outcome == RowOutcome::Frame(FrameOutcome::Executed(Kind::Stop)) {
            self.stop(end);
        }
        let bytes_start = self.rows.last().map_or(0, |row| row.bytes_end);
        let bytes_end = self.bytes.len();
        debug_assert!(bytes_start <= bytes_end && bytes_end <= self.seen.len(), "a byte has no start bit");
        let (tick_start, tick_end) = (None, None);
        self.rows.push(LoggedPacket {
            start,
            end,
            outcome,
            tick_start,
            tick_end,
            bytes_start,
            bytes_end,
            latest: end,
        });
    }

    fn stop(&mut self, at: Instant) {
        self.waiting.clear();
        self.stops.push(at);
    }
}

impl Sink for PacketLog {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, at: Instant, event: Event) {
        match event {
            Event::Byte { start: seen, byte } => {
                self.open.get_or_insert(seen);
                self.bytes.push(byte);
                self.seen.push(seen);
                self.last = at;
            }
            // On a framed line only the byte is missing, and the CRC detects that.
            Event::FramingError { start: seen, is_dropping: false } => self.broken.push(seen),
            Event::FramingError { start: seen, .. } => {
                self.broken.push(seen);
                self.open.get_or_insert(seen);
                self.close(at, RowOutcome::Framing);
                self.ignoring = true;
            }
            Event::Gap { cuts_packet: short } => {
                if self.open.is_some() {
                    self.close(at, if short { RowOutcome::Short } else { RowOutcome::Ignored });
                }
                self.ignoring = false;
            }
            Event::Packet(outcome) => self.close(at, RowOutcome::Packet(outcome)),
            Event::Frame(outcome) => self.close(at, RowOutcome::Frame(outcome)),
            Event::Reply { start, end, reply, positions } => {
                self.bytes.extend(reply.emit(positions.as_ref()));
                self.seen.resize(self.bytes.len(), start);
                self.open = Some(start);
                self.close(end, RowOutcome::Reply(reply));
            }
            Event::Collision => {
                // Bytes of the incomplete packet stay with it.
                let (open, coming) = (self.open.take(), self.bytes_of_open());
                self.bytes.truncate(self.bytes.len() - coming.len());
                self.open = Some(at);
                self.close(at, RowOutcome::Collision);
                self.bytes.extend(coming);
                self.open = open;
            }
            Event::Underrun => self.underruns.push(at),
            Event::Pushed => self.waiting.push_back(None),
            Event::Stopped => self.stop(at),
            Event::TickStart { commands } => {
                let row = self.waiting.pop_front().flatten();
                if let Some(row) = row.and_then(|index| self.rows.get_mut(index)) {
                    row.tick_start.get_or_insert(at);
                }
                self.ticks.push(LoggedTick { start: at, commands, row });
            }
            Event::TickEnd => {
                let row = self.ticks.last().and_then(|tick| tick.row);
                if let Some(row) = row.and_then(|index| self.rows.get_mut(index)) {
                    row.tick_end = Some(at);
                }
            }
            // Controllers without a serial line have no packets.
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_that_firmware_pushed_have_no_row_and_those_around_them_their_own() {
        let packet =
            |seen| [Event::Byte { start: Instant(seen), byte: 1 }, Event::Packet(PacketOutcome::Queued)];
        let [start, pushed] = [Event::TickStart { commands: [0; 16] }, Event::Pushed];
        let (first, second) = (packet(10), packet(20));
        let events = [first[0], first[1], pushed, second[0], second[1], start, start, Event::Stopped];
        let after = [pushed, start];
        let mut log = PacketLog::default();
        for (at, event) in events.into_iter().chain(after).enumerate() {
            log.event(Instant(100 + at as u64), event);
        }
        let rows: Vec<_> = log.ticks().iter().map(|tick| tick.row).collect();
        assert_eq!(rows, [Some(0), None, None], "the second packet's tick was stopped before it began");
        assert_eq!(log.rows()[1].tick_start, None);
        let ends = [0, 1].map(|tick| log.tick_end(&log.ticks()[tick], Cycles(2)).0);
        assert_eq!(ends, [107, 107], "the first by itself, the second by the stop");
    }

    #[test]
    fn recorded_replies_replace_simulated_rows_and_ticks_keep_theirs() {
        let status = stepscope_peripheral::protocol::Status {
            state: stepscope_peripheral::protocol::State::Ready,
            free: 1,
            expected_seq: 2,
            faults: 0,
            ticks_done: 3,
        };
        let reply = Reply { address: 1, result: Ok(Kind::Ticks), status };
        let mut log = PacketLog::default();
        for seen in [10, 200] {
            log.event(Instant(seen + 5), Event::Byte { start: Instant(seen), byte: seen as u8 });
            log.event(Instant(seen + 6), Event::Frame(FrameOutcome::Queued(1)));
            let (start, end) = (Instant(seen + 50), Instant(seen + 90));
            log.event(Instant(seen + 6), Event::Reply { start, end, reply, positions: None });
            log.event(Instant(seen + 7), Event::TickStart { commands: [0; 16] });
        }
        log.finish();
        assert_eq!(log.rows().len(), 4);
        let recorded = |start, bytes, reply| RecordedReply {
            start: Instant(start),
            end: Instant(start + 30),
            bytes,
            reply,
        };
        let is_simulated = [false, true, false, true];
        let all =
            [recorded(5, &[5; 2], None), recorded(70, &[70; 2], Some(reply)), recorded(900, &[132; 2], None)];
        log.answer(&all, &is_simulated);
        let rows: Vec<_> = log
            .rows()
            .iter()
            .enumerate()
            .map(|(row, logged)| (logged.start.0, logged.outcome, log.bytes(row)))
            .collect();
        let queued = RowOutcome::Frame(FrameOutcome::Queued(1));
        assert_eq!(
            rows,
            [
                (5, RowOutcome::Recorded, [5, 5].as_slice()),
                (10, queued, &[10]),
                (70, RowOutcome::Reply(reply), &[70, 70]),
                (200, queued, &[200]),
                (900, RowOutcome::Recorded, &[132, 132]),
            ]
        );
        assert_eq!(log.seen(2), [Instant(70), Instant(70)]);
        assert_eq!(log.ticks().iter().map(|tick| tick.row).collect::<Vec<_>>(), [Some(1), Some(3)]);
        assert_eq!(log.touching(Instant(20), Instant(80)).collect::<Vec<_>>(), [0, 2]);
        assert!(log.is_answered() && !PacketLog::default().is_answered());
    }

    #[test]
    fn a_tick_that_is_stopped_in_the_cycle_of_its_start_lasts_no_time() {
        let mut log = PacketLog::default();
        log.event(Instant(5), Event::Stopped);
        log.event(Instant(9), Event::TickStart { commands: [0; 16] });
        log.event(Instant(9), Event::Stopped);
        assert_eq!(
            log.tick_end(&log.ticks()[0], Cycles(100)),
            Instant(9),
            "not the stop before, nor by itself"
        );
    }

    #[test]
    fn finished_rows_are_sorted_with_their_bytes_and_ticks() {
        let mut log = PacketLog::default();
        let events = [
            (20, Event::Byte { start: Instant(10), byte: 1 }),
            (25, Event::Collision),
            (30, Event::Byte { start: Instant(22), byte: 2 }),
            (30, Event::Packet(PacketOutcome::Queued)),
            (31, Event::TickStart { commands: [0; 16] }),
        ];
        for (at, event) in events {
            log.event(Instant(at), event);
        }
        assert_eq!(log.rows()[0].outcome, RowOutcome::Collision, "known first");
        log.finish();
        let logged: Vec<_> = log.rows().iter().map(|row| (row.start.0, row.outcome)).collect();
        assert_eq!(logged, [(10, RowOutcome::Packet(PacketOutcome::Queued)), (25, RowOutcome::Collision)]);
        assert_eq!((log.bytes(0), log.bytes(1)), ([1, 2].as_slice(), [].as_slice()));
        assert_eq!(log.seen(0), [Instant(10), Instant(22)]);
        assert_eq!(
            log.touching(Instant(28), Instant(29)).collect::<Vec<_>>(),
            [0],
            "it began before the collision"
        );
        assert_eq!(log.ticks()[0].row, Some(0));
        assert_eq!(log.rows()[0].tick_start, Some(Instant(31)));
    }

    #[test]
    fn a_packet_is_logged_with_its_bytes() {
        use crate::packets::log::{PacketLog, RowOutcome};
        use stepscope_peripheral::{
            signal::{Event, PacketOutcome, Sink},
            units::Instant,
        };

        let mut log = PacketLog::default();
        log.event(Instant(15), Event::Byte { start: Instant(10), byte: 0x85 });
        log.event(Instant(15), Event::Packet(PacketOutcome::Queued));
        assert_eq!(
            (log.rows()[0].outcome, log.bytes(0)),
            (RowOutcome::Packet(PacketOutcome::Queued), &[0x85][..])
        );
    }
}
