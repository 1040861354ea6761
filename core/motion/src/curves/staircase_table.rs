//! The staircase table (DESIGN B3, Zhang 2012): each row has a rate and the number of steps at this rate.
//!
//! ```text
//! row n (from 1)   dS_n = 30*(1 + floor((n - 1)/5))      steps
//!                  S_n  = dS_1 + … + dS_n
//!                  f_n  = round_half_up(sqrt(f_1^2 + 2*a*S_(n-1)))
//! ```
//!
//! The paper lists S_n with the next rate f_(n+1), up to the first rate above f_max. Every row has a closed form, so none
//! is stored.

use crate::curves::climb::{Climb, quick_rate};
use crate::{bisection::first_from_zero, timing::Exact};

const FIRST_STEPS: u64 = 30;
const EQUAL_ROWS: u64 = 5;

/// Rates and steps of the rows of a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaircaseTable {
    start_speed: f64,
    max_speed: f64,
    acceleration: f64,
}

impl StaircaseTable {
    /// From `start_speed` >= 1/2 up to the first rate above `max_speed` >= `start_speed`, with `acceleration` > 0, in steps
    /// and s.
    pub fn new(start_speed: f64, max_speed: f64, acceleration: f64) -> Self {
        Self { start_speed, max_speed, acceleration }
    }

    /// Rate of row `n` (from 1) in whole steps/s, not decreasing.
    pub fn rate(&self, n: u64) -> u64 {
        let steps = Self::steps_after(n.saturating_sub(1));
        quick_rate(self.start_speed, self.acceleration, steps).unwrap_or_else(|| {
            Climb::new(&Exact::of(self.start_speed), &Exact::of(self.acceleration)).rate(steps)
        })
    }

    /// Steps of row `n` (from 1).
    pub fn steps_in(n: u64) -> u64 {
        FIRST_STEPS * (1 + n.saturating_sub(1) / EQUAL_ROWS)
    }

    /// Total steps of the rows 1 to `n`.
    pub fn steps_after(n: u64) -> u64 {
        let (blocks, rows_left) = (n / EQUAL_ROWS, n % EQUAL_ROWS);
        FIRST_STEPS * (EQUAL_ROWS * blocks * (blocks + 1) / 2 + rows_left * (blocks + 1))
    }

    /// Number of rows before the rate is at least `rate`: the rows of a ramp to it.
    pub fn rows_to(&self, rate: u64) -> u64 {
        first_from_zero(|rows| self.rate(rows + 1) >= rate)
    }

    /// Maximum number of rows that fit into `steps` up and down.
    pub fn rows_that_fit(steps: u64) -> u64 {
        first_from_zero(|rows| 2 * Self::steps_after(rows + 1) > steps)
    }

    /// Number of rows, up to the one before the first rate above the maximum speed.
    pub fn rows(&self) -> u64 {
        first_from_zero(|rows| rows > 0 && self.rate(rows + 1) as f64 > self.max_speed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_the_rows_of_the_paper() {
        let table = StaircaseTable::new(1000.0, 20_000.0, 1000.0);
        // n, dS_n, S_n, the rate after it
        let rows = [
            (1, 30, 30, 1030),
            (2, 30, 60, 1058),
            (3, 30, 90, 1086),
            (255, 1530, 198_900, 19_970),
            (256, 1560, 200_460, 20_048),
        ];
        for (n, steps, all, rate) in rows {
            let found = (StaircaseTable::steps_in(n), StaircaseTable::steps_after(n), table.rate(n + 1));
            assert_eq!(found, (steps, all, rate), "row {n}");
        }
        assert_eq!((table.rate(1), table.rows()), (1000, 256));
        // The other levels end earlier.
        let rows = [2000.0, 3000.0, 4000.0, 5000.0].map(|a| StaircaseTable::new(1000.0, 20_000.0, a).rows());
        assert_eq!(rows, [180, 147, 127, 113]);
    }

    #[test]
    fn adds_up_the_steps_of_rows() {
        let mut sum = 0;
        for n in 1..1000 {
            sum += StaircaseTable::steps_in(n);
            assert_eq!(StaircaseTable::steps_after(n), sum, "row {n}");
            for (steps, fit) in [(2 * sum - 1, n - 1), (2 * sum, n), (2 * sum + 1, n)] {
                assert_eq!(StaircaseTable::rows_that_fit(steps), fit, "{steps} steps");
            }
        }
    }

    #[test]
    fn counts_the_rows_below_a_rate() {
        let table = StaircaseTable::new(1000.0, 20_000.0, 1000.0);
        let rows = [(1, 0), (1000, 0), (1001, 1), (1030, 1), (1031, 2), (19_970, 255), (20_000, 256)];
        for (rate, expected) in rows {
            assert_eq!(table.rows_to(rate), expected, "{rate} steps/s");
        }
    }
}
