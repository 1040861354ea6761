//! Everything that a view needs of a run: its records, their digest, and its packets.

use crate::trace::{Digest, PacketLog};
use crate::{
    signal::{Event, Levels, Record, Sink},
    units::Instant,
};
use alloc::vec::Vec;

/// A run as it is kept for the views.
#[derive(Clone, Default)]
pub struct Recording {
    /// The records.
    pub trace: Vec<Record>,
    /// Their digest.
    pub digest: Digest,
    /// The packets, and what became of them.
    pub packets: PacketLog,
}

impl Sink for Recording {
    #[inline(always)]
    fn record(&mut self, record: Record) {
        self.trace.push(record);
        self.digest.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.packets.event(at, event);
    }
}

impl Recording {
    /// Start of the first tick: where a motion's time 0 is on the device's clock.
    #[must_use]
    pub fn first_tick(&self) -> Option<Instant> {
        self.packets.ticks().first().map(|tick| tick.start)
    }
}

/// The levels in a cycle of a run with these records; those of reset where there are none.
#[must_use]
pub fn levels_at(trace: &[Record], at: Instant) -> Levels {
    let after = trace.partition_point(|record| record.cycle <= at);
    after.checked_sub(1).and_then(|index| trace.get(index)).map_or(Levels::RESET, |record| record.levels)
}
