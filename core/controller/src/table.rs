//! The acceleration table in integers (CONTROLLER G3; the staircase of Zhang 2012).
//!
//! ```text
//! row n (from 1)   dS_n = 30*(1 + floor((n - 1)/5))                 steps
//!                  S_n  = dS_1 + … + dS_n
//!                  f_n  = round_half_up(sqrt(f_1^2 + 2*a*S_(n-1)))  Hz
//! ```
//!
//! Five rows of equal length form a block; the blocks before block b have 75*b*(b + 1) steps. So each row has a closed form,
//! and no row is stored.

/// Steps of the first row, and the increment per block.
const FIRST_STEPS: u64 = 30;
const EQUAL_ROWS: u64 = 5;
/// Half the steps of block b, divided by b.
const HALF_BLOCK: u64 = FIRST_STEPS * EQUAL_ROWS / 2;
/// Binary digits of the row at which every table exceeds every speed: 10^7 Hz from 10 Hz with 1 Hz/s.
const ROW_BITS: u32 = 24;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Table {
    pub(crate) start_speed_hz: u32,
    pub(crate) acceleration_hz_s: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) first: u64,
    pub(crate) last: u64,
    pub(crate) rate_hz: u64,
}

/// Steps of the first `n` rows.
const fn steps_after(n: u64) -> u64 {
    let (blocks, rest) = (n / EQUAL_ROWS, n % EQUAL_ROWS);
    HALF_BLOCK * blocks * (blocks + 1) + FIRST_STEPS * rest * (blocks + 1)
}

/// The row (from 1) of a ramp step (from 1).
fn row_of(step: u64) -> u64 {
    let before = step.saturating_sub(1);
    // The maximum b with 75*b*(b + 1) <= before.
    let block = ((1 + 4 * u128::from(before / HALF_BLOCK)).isqrt() as u64 - 1) / 2;
    let rest = before - HALF_BLOCK * block * (block + 1);
    EQUAL_ROWS * block + rest / (FIRST_STEPS * (block + 1)) + 1
}

impl Table {
    fn rate_hz(self, n: u64) -> u64 {
        let start = u128::from(self.start_speed_hz);
        let steps = u128::from(steps_after(n.saturating_sub(1)));
        let square = start * start + 2 * u128::from(self.acceleration_hz_s) * steps;
        let root = square.isqrt();
        // Round up from root + 1/2 on, whose square is root^2 + root + 1/4.
        (root + u128::from(square > root * root + root)) as u64
    }

    pub(crate) fn row(self, step: u64) -> Row {
        let n = row_of(step);
        Row { first: steps_after(n - 1) + 1, last: steps_after(n), rate_hz: self.rate_hz(n) }
    }

    /// Steps of the rows before the first one of at least `rate_hz`.
    pub(crate) fn steps_to(self, rate_hz: u32) -> u64 {
        let mut rows = 0;
        for bit in (0..ROW_BITS).rev() {
            let more = rows + (1 << bit);
            if self.rate_hz(more) < u64::from(rate_hz) {
                rows = more;
            }
        }
        steps_after(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_those_of_the_paper() {
        let table = Table { start_speed_hz: 1000, acceleration_hz_s: 1000 };
        // Ramp step, rate of its row.
        let rows = [
            (1, 1000),
            (30, 1000),
            (31, 1030),
            (60, 1030),
            (61, 1058),
            (90, 1058),
            (91, 1086),
            (198_900, 19_893),
            (198_901, 19_970),
            (200_460, 19_970),
            (200_461, 20_048),
        ];
        for (step, rate_hz) in rows {
            assert_eq!(table.row(step).rate_hz, rate_hz, "step {step}");
        }
        // Speed, steps to reach it.
        for (rate_hz, steps) in [(10, 0), (1000, 0), (1001, 30), (1030, 30), (1031, 60), (20_000, 200_460)] {
            assert_eq!(table.steps_to(rate_hz), steps, "{rate_hz} Hz");
        }
    }

    #[test]
    fn closed_forms_equal_the_sums_of_rows() {
        let (mut sum, table) = (0, Table { start_speed_hz: 10, acceleration_hz_s: 5_000_000 });
        for n in 1..2000 {
            let first = sum + 1;
            sum += FIRST_STEPS * (1 + (n - 1) / EQUAL_ROWS);
            assert_eq!(steps_after(n), sum, "row {n}");
            assert_eq!((row_of(first), row_of(sum)), (n, n), "row {n}");
            let row = table.row(sum);
            assert_eq!((row.first, row.last), (first, sum));
        }
    }

    #[test]
    fn the_longest_ramp_ends() {
        let table = Table { start_speed_hz: 10, acceleration_hz_s: 1 };
        let steps = table.steps_to(10_000_000);
        assert!(table.row(steps).rate_hz < 10_000_000 && table.row(steps + 1).rate_hz >= 10_000_000);
    }
}
