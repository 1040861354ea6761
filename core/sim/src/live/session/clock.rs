//! The clock of a session: converts monotonic time to cycles, and is set back if the computer is too slow (LIVE H1).
//!
//! ```text
//! cycle(t) = floor(t*clock_hz*pace) - cycles that it was set back
//! ```

use core::{fmt, str::FromStr};
use stepscope_peripheral::units::{Cycles, Instant};

/// Speed of a session: 0.001 to 100 times real time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    /// Invariant: 1000 to 100 000 000.
    millionths: u64,
}

impl Pace {
    pub const REAL_TIME: Self = Self { millionths: 1_000_000 };

    /// A pace in millionths of real time; `None` outside 0.001 to 100.
    pub fn new(millionths: u64) -> Option<Self> {
        (1000..=100_000_000).contains(&millionths).then_some(Self { millionths })
    }
}

impl FromStr for Pace {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let pace = text.parse::<f64>().ok().filter(|pace| (0.001..=100.0).contains(pace));
        // Half a millionth rounds.
        pace.and_then(|pace| Self::new((pace * 1e6 + 0.5) as u64)).ok_or("use 0.001 to 100, or `max`")
    }
}

impl fmt::Display for Pace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.millionths as f64 / 1e6)
    }
}

/// How often and how far a clock was set back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Setbacks {
    /// Consecutive setbacks count once.
    pub count: u64,
    /// Their sum.
    pub cycles: Cycles,
}

/// Converts wall-clock time to cycles of a session, and sets itself back after a lag.
#[derive(Clone, Debug)]
pub struct SessionClock {
    clock_hz: u32,
    pace: Pace,
    lag_ns: u64,
    setbacks: Setbacks,
    /// Whether the last call set the clock back; a setback in the next call belongs to the same lag.
    behind: bool,
}

impl SessionClock {
    /// A clock at cycle 0 and time 0 that may be `lag_ns` nanoseconds ahead of the model.
    pub fn new(clock_hz: u32, pace: Pace, lag_ns: u64) -> Self {
        Self { clock_hz, pace, lag_ns, setbacks: Setbacks::default(), behind: false }
    }

    fn cycles(&self, ns: u64) -> u64 {
        let cycles = u128::from(ns) * u128::from(self.clock_hz) * u128::from(self.pace.millionths);
        u64::try_from(cycles / 1_000_000_000_000_000).unwrap_or(u64::MAX)
    }

    /// Nanoseconds that cycles of the model take, rounded up.
    pub fn nanos(&self, cycles: Cycles) -> u64 {
        let rate = u128::from(self.clock_hz.max(1)) * u128::from(self.pace.millionths);
        let ns = (u128::from(cycles.0) * 1_000_000_000_000_000).div_ceil(rate);
        u64::try_from(ns).unwrap_or(u64::MAX)
    }

    /// Delay of an event behind its cycle.
    pub fn late_ns(&self, elapsed_ns: u64, cycle: Instant) -> u64 {
        elapsed_ns.saturating_sub(self.nanos(Cycles(cycle.0 + self.setbacks.cycles.0)))
    }

    /// The cycle up to which the model, which has reached `reached`, may run. A lag beyond the allowed one sets the clock back.
    pub fn target(&mut self, elapsed_ns: u64, reached: Instant) -> Instant {
        let now = self.cycles(elapsed_ns).saturating_sub(self.setbacks.cycles.0);
        let excess = now.saturating_sub(reached.0).saturating_sub(self.cycles(self.lag_ns));
        if excess > 0 {
            self.setbacks.count += u64::from(!self.behind);
            self.setbacks.cycles = Cycles(self.setbacks.cycles.0 + excess);
        }
        self.behind = excess > 0;
        Instant(now - excess)
    }

    pub const fn setbacks(&self) -> Setbacks {
        self.setbacks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_are_rounded_down_and_times_up() {
        // Clock, pace, nanoseconds, cycle.
        for (clock_hz, pace, ns, cycle) in [
            (16_000_000, "1", 62, 0),
            (16_000_000, "1", 63, 1),
            (3, "0.5", 1_000_000_000, 1),
            (7, "100", 1, 0),
        ] {
            let clock = SessionClock::new(clock_hz, pace.parse().expect("a pace"), 0);
            assert_eq!(clock.cycles(ns), cycle, "{clock_hz} {pace} {ns}");
            let least = clock.nanos(Cycles(cycle + 1));
            assert!(clock.cycles(least) > cycle && clock.cycles(least - 1) <= cycle, "{clock_hz} {pace}");
        }
        for wrong in ["0", "101", "-1", "fast", "NaN", ""] {
            assert!(wrong.parse::<Pace>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn consecutive_setbacks_are_one_and_the_clock_never_runs_backward() {
        let mut clock = SessionClock::new(1000, Pace::REAL_TIME, 10_000_000);
        let mut reached = Instant(0);
        // Milliseconds, how far the model comes, stretches and their cycles afterwards.
        for (ms, count, cycles) in [(5, 0, 0), (100, 1, 85), (200, 1, 175), (205, 1, 175), (300, 2, 260)] {
            let target = clock.target(ms * 1_000_000, reached);
            assert!(target >= reached, "{ms}");
            reached = target;
            assert_eq!(clock.setbacks(), Setbacks { count, cycles: Cycles(cycles) }, "{ms}");
        }
    }

    #[test]
    fn a_late_clock_is_set_back() {
        use crate::session::{Pace, SessionClock};
        use stepscope_peripheral::units::{Cycles, Instant};

        // 1 MHz in real time, up to 50 ms late.
        let mut clock = SessionClock::new(1_000_000, Pace::REAL_TIME, 50_000_000);
        assert_eq!(clock.target(2_000_000, Instant(0)), Instant(2000));
        // 200 ms later nothing has been run: 150 of them are left out.
        assert_eq!(clock.target(202_000_000, Instant(2000)), Instant(52_000));
        assert_eq!((clock.setbacks().count, clock.setbacks().cycles), (1, Cycles(150_000)));
    }
}
