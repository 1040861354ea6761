//! The packets of a run, one row each: when, which bytes, what the controller did with it.

use crate::{
    signal::{Event, Fate, Record, Sink},
    units::Instant,
};
use alloc::{collections::VecDeque, vec::Vec};
use core::fmt;

/// How a row came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A whole packet.
    Packet(Fate),
    /// Cut short by a gap (fault SHORT_PACKET).
    Short,
    /// Dropped by a framing error (fault FRAMING); its last byte was not delivered.
    Framing,
    /// Bytes that were ignored after a framing error.
    Ignored,
    /// The run ended within it.
    Open,
}

impl fmt::Display for Verdict {
    /// What became of the packet, as the page and the command's tables say it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Packet(Fate::Queued) => "queued",
            Self::Packet(Fate::Foreign) => "another address",
            Self::Packet(Fate::Booting) => "dropped: self-test after reset",
            Self::Packet(Fate::TooManySteps) => "dropped: TOO_MANY_STEPS",
            Self::Packet(Fate::QueueFull) => "dropped: QUEUE_OVERFLOW",
            Self::Short => "dropped: SHORT_PACKET",
            Self::Framing => "dropped: FRAMING",
            Self::Ignored => "ignored until a gap",
            Self::Open => "not complete",
        })
    }
}

/// One row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoggedPacket {
    /// Where the start bit of its first byte was seen.
    pub start: Instant,
    /// Where it was complete or given up.
    pub end: Instant,
    /// What became of it.
    pub verdict: Verdict,
    /// Its tick's first cycle, if it has begun.
    pub tick_start: Option<Instant>,
    /// First cycle after its tick, if it has ended.
    pub tick_end: Option<Instant>,
    bytes_end: usize,
}

/// All packets of a run.
#[derive(Clone, Debug, Default)]
pub struct PacketLog {
    rows: Vec<LoggedPacket>,
    bytes: Vec<u8>,
    /// Where the packet that is coming began.
    open: Option<Instant>,
    last: Instant,
    ignoring: bool,
    /// Rows whose tick waits, and those whose tick has begun, in the order of the ticks.
    waiting: VecDeque<usize>,
    begun: Vec<usize>,
}

impl PacketLog {
    /// Rows so far, in the order of their ends.
    #[must_use]
    pub fn rows(&self) -> &[LoggedPacket] {
        &self.rows
    }

    /// Indices of the rows whose tick has begun, in the order of the ticks.
    #[must_use]
    pub fn ticks(&self) -> &[usize] {
        &self.begun
    }

    /// Bytes of a row.
    #[must_use]
    pub fn bytes(&self, index: usize) -> &[u8] {
        let first = index.checked_sub(1).and_then(|i| self.rows.get(i)).map_or(0, |row| row.bytes_end);
        self.rows.get(index).and_then(|row| self.bytes.get(first..row.bytes_end)).unwrap_or_default()
    }

    /// The run is over: what is still open becomes a row.
    pub fn finish(&mut self) {
        if self.open.is_some() {
            self.close(self.last, if self.ignoring { Verdict::Ignored } else { Verdict::Open });
        }
    }

    fn close(&mut self, end: Instant, verdict: Verdict) {
        let start = self.open.take().unwrap_or(end);
        if verdict == Verdict::Packet(Fate::Queued) {
            self.waiting.push_back(self.rows.len());
        }
        let bytes_end = self.bytes.len();
        self.rows.push(LoggedPacket { start, end, verdict, tick_start: None, tick_end: None, bytes_end });
    }
}

impl Sink for PacketLog {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, at: Instant, event: Event) {
        match event {
            Event::Byte { seen, byte } => {
                self.open.get_or_insert(seen);
                self.bytes.push(byte);
                self.last = at;
            }
            Event::FramingError { seen } => {
                self.open.get_or_insert(seen);
                self.close(at, Verdict::Framing);
                self.ignoring = true;
            }
            Event::Gap { short } => {
                if self.open.is_some() {
                    self.close(at, if short { Verdict::Short } else { Verdict::Ignored });
                }
                self.ignoring = false;
            }
            Event::Packet(fate) => self.close(at, Verdict::Packet(fate)),
            Event::TickStart => {
                if let Some(index) = self.waiting.pop_front()
                    && let Some(row) = self.rows.get_mut(index)
                {
                    row.tick_start = Some(at);
                    self.begun.push(index);
                }
            }
            Event::TickEnd => {
                if let Some(row) = self.begun.last().and_then(|&index| self.rows.get_mut(index)) {
                    row.tick_end = Some(at);
                }
            }
        }
    }
}
