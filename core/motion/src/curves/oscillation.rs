//! Shared parts of oscillations (DESIGN B5, B6): whole periods from one extreme to the other and back.
//!
//! ```text
//!  0   |\        /\        /   position from the start: the right extreme or, with a negative
//!      |  \    /    \    /     amplitude, the left one
//! -2*A |    \/        \/       4*A steps per period, 0 at the end of each
//! ```

use crate::curves::curve::greater;
use crate::round_half_up;
use crate::timing::{CycleTime, Exact, F106};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oscillation {
    /// Steps from the middle to an extreme.
    pub(crate) amplitude: u64,
    /// False with a negative amplitude.
    pub(crate) starts_right: bool,
    pub(crate) period_s: f64,
    pub(crate) periods: u32,
}

impl Oscillation {
    pub(crate) fn new(amplitude: i64, period_s: f64, periods: u32) -> Self {
        Self { amplitude: amplitude.unsigned_abs(), starts_right: amplitude >= 0, period_s, periods }
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.period_s * f64::from(self.periods)
    }

    pub(crate) fn duration(&self, clock_hz: u32) -> CycleTime {
        let duration = Exact::of(self.period_s).times(self.periods.into());
        CycleTime::exact(&duration.times(clock_hz.into()))
    }

    pub(crate) fn period_cycles(&self, clock_hz: u32) -> F106 {
        Exact::of(self.period_s).times(clock_hz.into()).double()
    }

    pub(crate) fn step_count(&self) -> u64 {
        4 * self.amplitude * u64::from(self.periods)
    }

    /// Whole position at `t` s, where the distance from the start is `from_start`, and the number of steps before it.
    pub(crate) fn due_within(&self, from_start: f64, t: f64) -> (i64, u64) {
        let per_half = 2 * self.amplitude;
        let half = ((2.0 * t / self.period_s) as u64).min(2 * u64::from(self.periods));
        let returns = half % 2 == 1;
        let from_extreme = if returns { per_half as f64 - from_start } else { from_start };
        let due = round_half_up(from_extreme).unsigned_abs().min(per_half);
        let distance = if returns { per_half - due } else { due };
        let distance = distance as i64;
        (if self.starts_right { -distance } else { distance }, half * per_half + due)
    }

    /// Direction of half period `half` (from 0).
    pub(crate) fn goes_right(&self, half: u64) -> bool {
        self.starts_right == (half % 2 == 1)
    }

    /// Elapsed part of the period at `t`, 0 to 1.
    pub(crate) fn part(&self, t: f64) -> f64 {
        let turns = t / self.period_s;
        greater(0.0, turns - libm::floor(turns))
    }

    /// Mirrors a number of an oscillation that starts at the right extreme, if it starts at the left one.
    pub(crate) fn signed(&self, rightwards: f64) -> f64 {
        if self.starts_right { rightwards } else { -rightwards }
    }
}
