//! A run as the page makes it: kept for its views, and the pulses checked on the way.

use super::Run;
use crate::{
    analysis::timing::TimingCheck,
    signal::{Event, Record, Sink},
    trace::Recording,
    units::Instant,
};

/// What becomes of one controller's signals.
#[derive(Clone, Default)]
pub struct Watched {
    /// They are kept.
    pub recording: Recording,
    /// The pulses against the scenario's driver, if it names one.
    pub timing: Option<TimingCheck>,
}

impl Sink for Watched {
    #[inline]
    fn record(&mut self, record: Record) {
        self.recording.record(record);
        if let Some(check) = &mut self.timing {
            check.record(record);
        }
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.recording.event(at, event);
    }
}

impl Run {
    /// [`Self::advance_each`] with every controller watched.
    ///
    /// It stands here so that this loop is made for speed, though what calls it, the page's crate, is made
    /// small.
    pub fn advance_watched(&mut self, records: u64, sinks: &mut [Watched]) -> bool {
        self.advance_each(records, sinks)
    }
}
