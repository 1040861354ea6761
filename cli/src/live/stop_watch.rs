//! Monotonic time since the start of a session.

use std::time::{Duration, Instant};

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

/// Makes waits end on time: by default, Linux adds up to 50 us to combine wake-ups.
pub(crate) fn wake_on_time() {
    #[cfg(target_os = "linux")]
    {
        // Without it, waits end later, which is harmless.
        let _ = rustix::thread::set_current_timer_slack(std::num::NonZeroU64::new(1));
    }
}
