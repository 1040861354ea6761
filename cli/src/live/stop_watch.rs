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

/// From now on a wait ends when its time is over, and not up to 50 us later, which the system may otherwise add to join
/// wake-ups.
pub(crate) fn wake_on_time() {
    #[cfg(target_os = "linux")]
    {
        // A system that does not have it wakes later.
        let _ = rustix::thread::set_current_timer_slack(std::num::NonZeroU64::new(1));
    }
}
