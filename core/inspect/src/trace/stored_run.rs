//! A run as the views need it: its records, their digest, and its packets.
//!
//! ```
//! use stepscope_inspect::trace::stored_run::Recording;
//! use stepscope_sim::Experiment;
//!
//! let mut recording = Recording::default();
//! Experiment::from_json("{}").expect("no problems").run(&mut recording);
//! assert_eq!(recording.trace.len() as u64, recording.digest.records());
//! ```

use crate::packets::log::PacketLog;
use alloc::vec::Vec;
use stepscope_peripheral::{
    signal::{Event, Record, Sink},
    trace::Digest,
    units::Instant,
};

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
