//! The acceleration table (DESIGN B2, Sonobe 2011): one integer pulse rate per step, and a timer's reload for each.
//!
//! ```text
//! rate[k]   = round_half_up(sqrt(v0^2 + 2*a*k))     k = 0 .. top - 1
//! rate[top] = round_half_up(v1)                     top = first k with v0^2 + 2*a*k >= v1^2
//! reload[k] = floor(timer_hz/rate[k])
//! ```

use crate::{curves::climb::Climb, timing::Exact};

/// Pulse rates and timer reloads of a ramp.
#[derive(Clone, Debug, PartialEq)]
pub struct AccelerationTable {
    climb: Climb,
    top_rate: u64,
    timer_hz: u32,
    top: u64,
}

impl AccelerationTable {
    /// From `start_speed` >= 1/2 to `top_speed` >= `start_speed` steps/s with `acceleration` > 0 steps/s^2; a timer of
    /// `timer_hz` counts the reloads. Each number means its shortest decimal.
    pub fn new(start_speed: f64, top_speed: f64, acceleration: f64, timer_hz: u32) -> Self {
        let [start_speed, top_speed, acceleration] = [start_speed, top_speed, acceleration].map(Exact::of);
        Self::exact([&start_speed, &top_speed], &acceleration, timer_hz)
    }

    pub(crate) fn exact([start, top]: [&Exact; 2], acceleration: &Exact, timer_hz: u32) -> Self {
        let climb = Climb::new(start, acceleration);
        Self { top: climb.steps_to(top), climb, top_rate: top.rounded().unsigned_abs(), timer_hz }
    }

    pub fn timer_hz(&self) -> u32 {
        self.timer_hz
    }

    /// Index of the last row, which has the top speed.
    pub fn top(&self) -> u64 {
        self.top
    }

    /// Pulse rate of a row in steps/s, not decreasing; rows after the last have its rate.
    pub fn rate(&self, row: u64) -> u64 {
        if row < self.top { self.climb.rate(row) } else { self.top_rate }
    }

    /// Timer reload of a row; 0 if the timer is slower than the rate.
    pub fn reload(&self, row: u64) -> u64 {
        u64::from(self.timer_hz).checked_div(self.rate(row)).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_the_rates_of_the_paper() {
        let step_mm = 0.393;
        let table = AccelerationTable::new(100.0 / step_mm, 1000.0 / step_mm, 3500.0 / step_mm, 1_000_000);
        for (row, rate) in (0..).zip([254, 287, 317, 344, 369, 392, 414, 435]) {
            assert_eq!(table.rate(row), rate, "row {row}");
        }
        assert_eq!(table.reload(0), 3937);
        // The first row at or above the top speed has the top speed itself.
        assert_eq!((table.top(), table.rate(359), table.rate(360)), (360, 2541, 2545));
        assert_eq!(AccelerationTable::new(600.0, 600.0, 1.0, 599).reload(0), 0);
        // Row 1 is at a half exactly, and the top speed at another.
        let table = AccelerationTable::new(6.1, 10.5, 9.52, 1_000_000);
        assert_eq!([0, 1, 2, 3, 4, 5].map(|row| table.rate(row)), [6, 8, 9, 10, 11, 11]);
        assert_eq!(table.top(), 4);
    }
}
