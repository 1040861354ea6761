//! Everything that a view needs of a run: its records, their digest, and its packets.

use crate::trace::{Digest, PacketLog};
use crate::{
    signal::{Event, Levels, Record, Sink},
    units::Instant,
};
use alloc::vec::Vec;

/// A run for the views.
#[derive(Clone, Default)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Recording {
    pub trace: Vec<Record>,
    pub digest: Digest,
    pub packets: PacketLog,
}

impl Sink for Recording {
    fn record(&mut self, record: Record) {
        self.trace.push(record);
        self.digest.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.packets.event(at, event);
    }
}

impl Recording {
    /// Start of the first tick: time 0 of a motion.
    #[must_use]
    pub fn first_tick(&self) -> Option<Instant> {
        self.packets.ticks().first().map(|tick| tick.start)
    }
}

/// The levels in a cycle.
#[must_use]
pub fn levels_at(trace: &[Record], at: Instant) -> Levels {
    let after = trace.partition_point(|record| record.cycle <= at);
    after.checked_sub(1).and_then(|index| trace.get(index)).map_or(Levels::RESET, |record| record.levels)
}
