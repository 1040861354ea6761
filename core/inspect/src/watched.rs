//! A run as the page makes it: kept for its views, and the pulses checked on the way.

use crate::timing::TimingCheck;
use stepscope_peripheral::{
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
    #[inline(always)]
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
