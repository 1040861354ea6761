//! Monotonic time since a session began.

use std::time::{Duration, Instant};

/// Time since it was made.
#[derive(Clone, Copy)]
pub(crate) struct StopWatch(Instant);

impl StopWatch {
    pub(crate) fn start() -> Self {
        Self(Instant::now())
    }

    pub(crate) fn nanos(self) -> u64 {
        u64::try_from(self.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    pub(crate) fn elapsed(self) -> Duration {
        self.0.elapsed()
    }
}
