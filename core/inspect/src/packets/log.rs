//! The packets of a run, one row each: time, bytes and outcome.

use alloc::{collections::VecDeque, vec::Vec};
use core::fmt;
use stepscope_peripheral::protocol::{FrameOutcome, Kind, Reply};
use stepscope_peripheral::signal::{Event, PacketOutcome, Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::packet::Tick;

/// What became of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowOutcome {
    Packet(PacketOutcome),
    /// Cut short by a gap (fault SHORT_PACKET).
    Short,
    /// Dropped by a framing error (fault FRAMING); its last byte was not delivered.
    Framing,
    /// Bytes that were ignored after a framing error.
    Ignored,
    /// A frame, or bytes that are not a valid frame.
    Frame(FrameOutcome),
    Reply(Reply),
    /// Recorded on the line of the controller's replies, but not a known reply.
    Recorded,
    /// Two senders at once.
    Collision,
    /// The run ended before the packet was complete.
    Incomplete,
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
            Self::Recorded => "recorded: unknown reply",
            Self::Collision => "collision: the controller and another drive the line",
            Self::Incomplete => "incomplete",
        })
    }
}

/// One row: a packet, frame, reply or collision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedPacket {
    /// Start bit of its first byte.
    pub start: Instant,
    /// When it was complete, or aborted.
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

/// A reply in a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordedReply<'a> {
    pub start: Instant,
    pub end: Instant,
    pub bytes: &'a [u8],
    pub reply: Option<Reply>,
}

/// A tick that the controller executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedTick {
    pub start: Instant,
    pub commands: Tick,
    /// Row of its packet; `None` for a tick that firmware pushed.
    pub row: Option<usize>,
}

/// Collects the packets, replies and ticks of a controller during a run.
#[derive(Clone, Debug, Default)]
pub struct PacketLog {
    rows: Vec<LoggedPacket>,
    bytes: Vec<u8>,
    /// Start bit per byte; the bytes of a reply share the first.
    start_bits: Vec<Instant>,
    framing_errors: Vec<Instant>,
    open: Option<Instant>,
    last: Instant,
    ignoring: bool,
    /// The row per queued tick; `None` if firmware pushed it.
    waiting: VecDeque<Option<usize>>,
    ticks: Vec<LoggedTick>,
    stops: Vec<Instant>,
    underruns: Vec<Instant>,
    has_recorded_replies: bool,
}

impl PacketLog {
    /// In the order of their starts once the log is finished; before that, replies and collisions come too early.
    pub fn rows(&self) -> &[LoggedPacket] {
        &self.rows
    }

    /// All ticks, in the order of their starts.
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
    pub fn start_bits(&self, index: usize) -> &[Instant] {
        let row = self.rows.get(index);
        row.and_then(|row| self.start_bits.get(row.bytes_start..row.bytes_end)).unwrap_or_default()
    }

    /// Start bits of bytes with a framing error, in ascending order.
    pub fn framing_errors(&self) -> &[Instant] {
        &self.framing_errors
    }

    /// Ends of ticks with steps that no tick followed (fault UNDERRUN), in ascending order.
    pub fn underruns(&self) -> &[Instant] {
        &self.underruns
    }

    /// Whether replies come from a recording.
    pub const fn has_recorded_replies(&self) -> bool {
        self.has_recorded_replies
    }

    /// Replaces the rows for which `is_simulated` is true by recorded replies. The log must be finished.
    pub fn replace_replies(&mut self, recorded: &[RecordedReply<'_>], is_simulated: &[bool]) {
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
        self.has_recorded_replies = true;
        self.finish();
    }

    fn push_recorded(&mut self, RecordedReply { start, end, bytes, reply }: &RecordedReply<'_>) {
        let bytes_start = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.start_bits.resize(self.bytes.len(), *start);
        self.push_row(*start, *end, reply.map_or(RowOutcome::Recorded, RowOutcome::Reply), bytes_start);
    }

    /// Adds a row with the bytes from `bytes_start` on.
    fn push_row(&mut self, start: Instant, end: Instant, outcome: RowOutcome, bytes_start: usize) {
        let bytes_end = self.bytes.len();
        debug_assert!(
            bytes_start <= bytes_end && bytes_end <= self.start_bits.len(),
            "a byte has no start bit"
        );
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

    /// Ascending indices of the rows of a finished log that are on the line in the cycles `start..=end`.
    pub fn touching(&self, start: Instant, end: Instant) -> impl Iterator<Item = usize> {
        let first = self.rows.partition_point(|row| row.latest < start);
        let rows = self.rows.iter().enumerate().skip(first).take_while(move |(_, row)| row.start <= end);
        rows.filter(move |(_, row)| row.end >= start).map(|(index, _)| index)
    }

    /// Closes an open row and sorts the rows by their starts.
    pub fn finish(&mut self) {
        debug_assert!(self.framing_errors.is_sorted(), "framing errors are not in order");
        if self.open.is_some() {
            self.close(self.last, if self.ignoring { RowOutcome::Ignored } else { RowOutcome::Incomplete });
        }
        if !self.rows.is_sorted_by_key(|row| row.start) {
            self.sort();
        }
        let mut latest = Instant::default();
        for row in &mut self.rows {
            latest = latest.max(row.end);
            row.latest = latest;
        }
        debug_assert!(self.rows.is_sorted_by_key(|row| row.start), "rows are not in order");
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
        self.push_row(start, end, outcome, bytes_start);
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
                self.start_bits.push(seen);
                self.last = at;
            }
            // On a framed line only this byte is lost, which the CRC detects.
            Event::FramingError { start: seen, is_dropping: false } => self.framing_errors.push(seen),
            Event::FramingError { start: seen, .. } => {
                self.framing_errors.push(seen);
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
                self.start_bits.resize(self.bytes.len(), start);
                self.open = Some(start);
                self.close(end, RowOutcome::Reply(reply));
            }
            Event::Collision => {
                // The bytes so far belong to the packet, not to the collision.
                let (open, received) = (self.open.take(), self.bytes_of_open());
                self.bytes.truncate(self.bytes.len() - received.len());
                self.open = Some(at);
                self.close(at, RowOutcome::Collision);
                self.bytes.extend(received);
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
    fn ticks_pushed_by_firmware_have_no_row() {
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
        assert_eq!(ends, [107, 107], "the first after its length, the second by the stop");
    }

    #[test]
    fn recorded_replies_replace_simulated_rows_but_not_ticks() {
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
        log.replace_replies(&all, &is_simulated);
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
        assert_eq!(log.start_bits(2), [Instant(70), Instant(70)]);
        assert_eq!(log.ticks().iter().map(|tick| tick.row).collect::<Vec<_>>(), [Some(1), Some(3)]);
        assert_eq!(log.touching(Instant(20), Instant(80)).collect::<Vec<_>>(), [0, 2]);
        assert!(log.has_recorded_replies() && !PacketLog::default().has_recorded_replies());
    }

    #[test]
    fn a_tick_stopped_in_its_first_cycle_has_no_duration() {
        let mut log = PacketLog::default();
        log.event(Instant(5), Event::Stopped);
        log.event(Instant(9), Event::TickStart { commands: [0; 16] });
        log.event(Instant(9), Event::Stopped);
        assert_eq!(log.tick_end(&log.ticks()[0], Cycles(100)), Instant(9), "ended by the second stop");
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
        assert_eq!(log.rows()[0].outcome, RowOutcome::Collision, "logged first");
        log.finish();
        let logged: Vec<_> = log.rows().iter().map(|row| (row.start.0, row.outcome)).collect();
        assert_eq!(logged, [(10, RowOutcome::Packet(PacketOutcome::Queued)), (25, RowOutcome::Collision)]);
        assert_eq!((log.bytes(0), log.bytes(1)), ([1, 2].as_slice(), [].as_slice()));
        assert_eq!(log.start_bits(0), [Instant(10), Instant(22)]);
        assert_eq!(
            log.touching(Instant(28), Instant(29)).collect::<Vec<_>>(),
            [0],
            "it began before the collision"
        );
        assert_eq!(log.ticks()[0].row, Some(0));
        assert_eq!(log.rows()[0].tick_start, Some(Instant(31)));
    }
}
