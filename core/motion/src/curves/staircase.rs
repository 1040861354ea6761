//! Fixed distance by a staircase of rates (DESIGN B3, Zhang 2012): the rows of the [`StaircaseTable`] up, the plateau, and
//! the same rows down. Each step follows the previous one after one period of its rate.
//!
//! ```text
//! rate |       ________          L steps, S in the rows up to f_s
//!      |     _|        |_        f_s <= f_1   all at f_s
//!      |   _|            |_      L > 2S       as drawn
//!      | _|                |_    L = 2S       without the plateau
//!      ||S               S| |    L < 2S       all at f_1 (the paper), or as many rows as fit
//!      +---------------------    up and down, and the other steps at the next rate
//! ```

use crate::curves::curve::{greater, signed};
use crate::curves::stepped::{self, ExactTime};
use crate::curves::{mirrored::Mirrored, staircase_table::StaircaseTable};
use crate::format::{count, grouped};
use crate::timing::{CycleTime, F106, IsDueBefore, MAX_ERROR, ROUNDING, Run, Runs, Schedule};
use crate::{Curve, Peaks, bisection::first_in, moves::ShortMove};
use alloc::{boxed::Box, format, string::String, vec::Vec};

/// A move by a staircase of rates.
#[derive(Clone, Debug, PartialEq)]
pub struct Staircase {
    steps: i64,
    table: StaircaseTable,
    ramp_steps: u64,
    /// Rate between the ramps, in steps/s, even if no step has it.
    plateau_rate: u64,
    /// Start of each row of the ramp, and its end, in s.
    /// Invariant: at least one entry, the first 0, rising.
    starts_s: Vec<f64>,
    duration_s: f64,
}

impl Staircase {
    /// `steps` (left negative, not 0, at most 1e9) to `top_rate` >= 1 whole steps/s.
    /// Errors: the number of rows needed, if it exceeds `max_rows`.
    pub fn new(
        steps: i64,
        table: StaircaseTable,
        top_rate: u64,
        short_move: ShortMove,
        max_rows: u64,
    ) -> Result<Self, u64> {
        let count = steps.unsigned_abs();
        let (to_top, fit) = (table.rows_to(top_rate), StaircaseTable::rows_that_fit(count));
        let (rows, plateau_rate) = if to_top <= fit {
            (to_top, top_rate)
        } else {
            match short_move {
                ShortMove::Document => (0, table.rate(1)),
                ShortMove::Reverse => (fit, table.rate(fit + 1)),
            }
        };
        if rows >= max_rows {
            return Err(rows + 1);
        }
        let mut starts_s = Vec::with_capacity(rows as usize + 1);
        let mut start_s = 0.0;
        starts_s.push(start_s);
        for n in 1..=rows {
            start_s += StaircaseTable::steps_in(n) as f64 / table.rate(n) as f64;
            starts_s.push(start_s);
        }
        debug_assert!(starts_s.is_sorted_by(|a, b| a < b), "a row without a length");
        let ramp_steps = StaircaseTable::steps_after(rows);
        let duration_s = 2.0 * start_s + (count - 2 * ramp_steps) as f64 / plateau_rate as f64;
        Ok(Self { steps, table, ramp_steps, plateau_rate, starts_s, duration_s })
    }

    /// The whole table, including unused rows.
    pub fn table(&self) -> &StaircaseTable {
        &self.table
    }

    /// Rows of each ramp; 0 for a constant rate.
    pub fn ramp_rows(&self) -> u64 {
        self.starts_s.len().saturating_sub(1) as u64
    }

    /// Steps of each ramp, the paper's S.
    pub fn ramp_steps(&self) -> u64 {
        self.ramp_steps
    }

    pub fn ramp_s(&self) -> f64 {
        self.starts_s.last().copied().unwrap_or(0.0)
    }

    /// Steps between the ramps.
    pub fn plateau_steps(&self) -> u64 {
        self.count() - 2 * self.ramp_steps
    }

    /// Rate between the ramps in whole steps/s; `None` without a step there.
    pub fn plateau_rate(&self) -> Option<u64> {
        (self.plateau_steps() > 0).then_some(self.plateau_rate)
    }

    fn count(&self) -> u64 {
        self.steps.unsigned_abs()
    }

    fn row_of_step(&self, k: u64) -> u64 {
        first_in(1, self.ramp_rows(), |row| StaircaseTable::steps_after(row) >= k)
    }

    fn ramp_step_s(&self, k: u64) -> f64 {
        if k == 0 {
            return 0.0;
        }
        let before = self.row_of_step(k) - 1;
        let start_s = self.starts_s.get(before as usize).copied().unwrap_or(0.0);
        start_s + (k - StaircaseTable::steps_after(before)) as f64 / self.table.rate(before + 1) as f64
    }

    /// Time in s of step `k` (from 1; 0 is the start, from the last step on the end).
    pub fn step_s(&self, k: u64) -> f64 {
        let left = self.count().saturating_sub(k);
        if k <= self.ramp_steps {
            self.ramp_step_s(k)
        } else if left >= self.ramp_steps {
            self.ramp_s() + (k - self.ramp_steps) as f64 / self.plateau_rate as f64
        } else {
            self.duration_s - self.ramp_step_s(left)
        }
    }

    fn exact_duration(&self) -> F106 {
        let plateau = F106::from(self.plateau_steps()) / F106::from(self.plateau_rate);
        self.exact_starts().last().copied().unwrap_or_default() * 2.0 + plateau
    }

    fn exact_starts(&self) -> Vec<F106> {
        let row_s = |n| F106::from(StaircaseTable::steps_in(n)) / F106::from(self.table.rate(n));
        let ends = (1..=self.ramp_rows()).scan(F106::default(), |end, n| {
            *end = *end + row_s(n);
            Some(*end)
        });
        core::iter::once(F106::default()).chain(ends).collect()
    }

    fn guess_in_ramp(&self, t: f64) -> u64 {
        let row = self.starts_s.partition_point(|&start_s| start_s <= t).saturating_sub(1);
        let since = t - self.starts_s.get(row).copied().unwrap_or(0.0);
        let row = row as u64;
        StaircaseTable::steps_after(row) + (since * self.table.rate(row + 1) as f64) as u64
    }

    fn steps_due(&self, t: f64) -> u64 {
        let (ramp_s, left_s) = (self.ramp_s(), self.duration_s - t);
        let guess = if t < ramp_s {
            self.guess_in_ramp(t)
        } else if left_s > ramp_s {
            self.ramp_steps + ((t - ramp_s) * self.plateau_rate as f64) as u64
        } else {
            self.count().saturating_sub(self.guess_in_ramp(greater(0.0, left_s)))
        };
        stepped::steps_due(t, guess, self.count(), ExactTime::Included, |k| self.step_s(k))
    }

    /// Rate of interval `i` (from 0), which ends with step i + 1.
    fn rate(&self, i: u64) -> u64 {
        let from_end = self.count().saturating_sub(i).max(1);
        let nearer = from_end.min(i + 1);
        if nearer <= self.ramp_steps { self.table.rate(self.row_of_step(nearer)) } else { self.plateau_rate }
    }
}

impl Schedule for Staircase {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::of(self.exact_duration() * f64::from(clock_hz))
    }

    /// One run per row, which avoids the search for the row of each step.
    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let (clock, max_error) = (f64::from(clock_hz), self.max_error_s() * f64::from(clock_hz));
        let (right, rows) = (self.steps >= 0, self.ramp_rows());
        let row = move |n: u64| {
            let start_s = self.starts_s.get(n as usize - 1).copied().unwrap_or(0.0);
            (self.table.rate(n) as f64, start_s, StaircaseTable::steps_in(n))
        };
        let up = (1..=rows).map(move |n| {
            let (rate, start_s, steps) = row(n);
            Run::new(steps, right, max_error, move |step| (start_s + (step + 1.0) / rate) * clock)
        });
        let (rate, start_s) = (self.plateau_rate as f64, self.ramp_s());
        let plateau = Run::new(self.plateau_steps(), right, max_error, move |step| {
            (start_s + (step + 1.0) / rate) * clock
        });
        let down = (1..=rows).rev().map(move |n| {
            let (rate, start_s, steps) = row(n);
            // The last step of the first ramp begins the second one, whose last step is at the end of the move.
            let steps = steps - u64::from(n == rows) + u64::from(n == 1);
            let (first, duration_s) = (steps as f64 - if n == 1 { 1.0 } else { 0.0 }, self.duration_s);
            Run::new(steps, right, max_error, move |step| {
                (duration_s - (start_s + (first - step) / rate)) * clock
            })
        });
        Box::new(up.chain([plateau]).chain(down))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let (starts, duration) = (self.exact_starts(), self.exact_duration());
        let ramp_s = starts.last().copied().unwrap_or_default();
        let ramp_step_s = move |k: u64| {
            let before = self.row_of_step(k) - 1;
            let since = F106::from(k - StaircaseTable::steps_after(before));
            let start = starts.get(before as usize).copied().unwrap_or_default();
            start + since / F106::from(self.table.rate(before + 1))
        };
        Box::new(move |k, since| {
            let left = self.count().saturating_sub(k);
            let step_s = if k <= self.ramp_steps {
                ramp_step_s(k)
            } else if left >= self.ramp_steps {
                ramp_s + F106::from(k - self.ramp_steps) / F106::from(self.plateau_rate)
            } else {
                duration - ramp_step_s(left)
            };
            since > step_s * f64::from(clock_hz)
        })
    }

    /// Each row adds roundings to the starts of the rows after it.
    fn max_error_s(&self) -> f64 {
        (MAX_ERROR + 2.0 * ROUNDING * self.starts_s.len() as f64) * self.duration_s
    }
}

impl Curve for Staircase {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn steps(&self) -> i64 {
        self.steps
    }

    fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s {
            return self.steps as f64;
        }
        let due = self.steps_due(t);
        signed(self.steps, stepped::position(t, due, self.count(), |k| self.step_s(k)))
    }

    fn speed(&self, t: f64) -> f64 {
        let interval = self.steps_due(t).min(self.count().saturating_sub(1));
        signed(self.steps, self.rate(interval) as f64)
    }

    /// The speed jumps between rows; acceleration and jerk are 0.
    fn peaks(&self) -> Peaks {
        let rates = (1..=self.ramp_rows()).map(|n| self.table.rate(n)).chain(self.plateau_rate());
        Peaks::of_rates(None, rates.map(|rate| rate as f64))
    }

    /// In the first interval the position rises by half a step only, so its end is a breakpoint, too.
    fn breakpoints_s(&self) -> Vec<f64> {
        let rows = self.starts_s.iter().skip(1).copied();
        let halves = Mirrored { steps: self.steps, duration_s: self.duration_s };
        halves.breakpoints_s([self.step_s(1)].into_iter().chain(rows))
    }

    fn detail(&self, _: f64) -> String {
        let plateau = self.plateau_rate().map(|rate| {
            format!("{} at {}/s", count(self.plateau_steps(), "step", "steps"), grouped(rate as f64))
        });
        match (self.ramp_rows(), plateau) {
            (0, plateau) => format!("no ramp: {}", plateau.unwrap_or_default()),
            (rows, plateau) => format!(
                "{} with {} per ramp, {} between",
                count(rows, "row", "rows"),
                count(self.ramp_steps, "step", "steps"),
                plateau.as_deref().unwrap_or("none")
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::round_half_up;

    fn table(level: f64) -> StaircaseTable {
        StaircaseTable::new(1000.0, 20_000.0, 1000.0 * level)
    }

    fn staircase(steps: i64, level: f64, rate: u64, short_move: ShortMove) -> Staircase {
        Staircase::new(steps, table(level), rate, short_move, 1_000_000).unwrap()
    }

    #[test]
    fn has_the_four_cases_of_the_paper() {
        use ShortMove::{Document, Reverse};
        // At level 1 the rows to 1100 steps/s are 1000, 1030, 1058, 1086: S = 120.
        // steps, f_s, rule; rows, S, plateau's steps, its rate
        let rows = [
            ((500, 1000, Document), (0, 0, 500, Some(1000))),
            ((500, 10, Reverse), (0, 0, 500, Some(10))),
            ((500, 1100, Document), (4, 120, 260, Some(1100))),
            ((241, 1100, Reverse), (4, 120, 1, Some(1100))),
            ((240, 1100, Document), (4, 120, 0, None)),
            ((239, 1100, Document), (0, 0, 239, Some(1000))),
            ((239, 1100, Reverse), (3, 90, 59, Some(1086))),
            ((180, 1100, Reverse), (3, 90, 0, None)),
            ((59, 1100, Reverse), (0, 0, 59, Some(1000))),
            ((-60, 1100, Reverse), (1, 30, 0, None)),
        ];
        for ((steps, rate, rule), expected) in rows {
            let made = staircase(steps, 1.0, rate, rule);
            let found = (made.ramp_rows(), made.ramp_steps(), made.plateau_steps(), made.plateau_rate());
            assert_eq!(found, expected, "{steps} steps at {rate}, {rule:?}");
        }
    }

    /// t_r = (f_s - f_1)/a, t_m = (L - (f_1 + f_s)*t_r)/f_s.
    #[test]
    fn times_follow_the_formulas_of_the_paper() {
        // L, level, f_s
        let rows = [(17_233, 3.0, 5000), (17_233, 1.0, 3000), (500_000, 5.0, 20_000), (2000, 2.0, 1500)];
        for (steps, level, rate) in rows {
            let made = staircase(steps, level, rate, ShortMove::Document);
            let (f_s, f_1, a) = (rate as f64, 1000.0, 1000.0 * level);
            let t_r = (f_s - f_1) / a;
            let t_m = (steps as f64 - (f_1 + f_s) * t_r) / f_s;
            // A row has the rate of uniform acceleration at its start, and the last one may exceed f_s; rounding a
            // rate changes it by up to half a step/s.
            let rate = |n: u64| made.table().rate(n) as f64;
            let row_s = |n: u64, rate: f64| StaircaseTable::steps_in(n) as f64 / rate;
            let late: f64 = (1..=made.ramp_rows()).map(|n| row_s(n, rate(n)) - row_s(n, rate(n + 1))).sum();
            let past = row_s(made.ramp_rows(), f_s);
            let ramp_s = made.ramp_s();
            assert!(ramp_s > t_r * 0.9995 && ramp_s < (t_r + late + past) * 1.0005, "{ramp_s} is not {t_r}");
            let t_m_made = made.plateau_steps() as f64 / f_s;
            assert!((made.duration_s() - 2.0 * ramp_s - t_m_made).abs() < 1e-12);
            // The plateau is shorter by the steps of the ramps beyond f_s.
            assert!(t_m_made <= t_m * 1.001 && t_m - t_m_made < 2.0 * past, "{t_m_made} is not {t_m}");
            let all = made.duration_s() / (2.0 * t_r + t_m);
            assert!((0.999..1.05).contains(&all), "{all}");
        }
        // At f_1 or below without ramps: L/f.
        assert_eq!(staircase(1500, 3.0, 5000, ShortMove::Document).duration_s(), 1.5);
        assert_eq!(staircase(1500, 3.0, 500, ShortMove::Document).duration_s(), 3.0);
    }

    #[test]
    fn each_step_follows_the_previous_one_after_a_period_of_its_rate() {
        for (steps, rate, rule) in [
            (1, 900, ShortMove::Document),
            (500, 1100, ShortMove::Document),
            (240, 1100, ShortMove::Document),
            (-239, 1100, ShortMove::Reverse),
            (-5000, 9000, ShortMove::Reverse),
        ] {
            let made = staircase(steps, 2.0, rate, rule);
            let count = steps.unsigned_abs();
            let mut t = 0.0;
            for k in 1..=count {
                t += 1.0 / made.rate(k - 1) as f64;
                assert!((made.step_s(k) - t).abs() < 1e-9, "step {k} of {steps}: {} {t}", made.step_s(k));
                let due = |t: f64| round_half_up(made.position(t)).unsigned_abs();
                let at = made.step_s(k);
                // At its exact time a step to the left is not due yet (B7), except for the end of the move.
                let at_time = if steps < 0 && k < count { k - 1 } else { k };
                assert_eq!(
                    (due(at - 1e-7), due(at), due(at + 1e-7)),
                    (k - 1, at_time, k),
                    "step {k} of {steps}"
                );
            }
            assert_eq!(made.step_s(count), made.duration_s());
            assert_eq!(made.position(made.duration_s()), steps as f64);
            assert!((0..count).all(|i| made.rate(i) == made.rate(count - 1 - i)), "{steps}");
            assert_eq!(made.rate(0), made.rate(0).min(1000));
        }
    }

    #[test]
    fn describes_each_case_of_a_move() {
        let rows = [
            (500, 1100, "4 rows with 120 steps per ramp, 260 steps at 1\u{202f}100/s between"),
            (240, 1100, "4 rows with 120 steps per ramp, none between"),
            (239, 1100, "no ramp: 239 steps at 1\u{202f}000/s"),
            (500, 900, "no ramp: 500 steps at 900/s"),
        ];
        for (steps, top, expected) in rows {
            assert_eq!(staircase(steps, 1.0, top, ShortMove::Document).detail(1e6), expected);
        }
    }

    #[test]
    fn peaks_are_the_maximum_rate_and_the_maximum_jump() {
        let made = staircase(-500, 1.0, 1100, ShortMove::Document);
        assert_eq!(made.peaks(), Peaks { speed: 1100.0, jump: 30.0, ..Peaks::default() });
        assert_eq!((made.speed(0.0), made.speed(made.duration_s())), (-1000.0, -1000.0));
        assert_eq!(made.speed(made.duration_s() / 2.0), -1100.0);
        let made = staircase(240, 1.0, 1100, ShortMove::Document);
        assert_eq!(made.peaks().speed, 1086.0);
        assert_eq!(Staircase::new(500, table(1.0), 1100, ShortMove::Document, 4), Err(5));
    }

    #[test]
    fn each_row_adds_two_roundings_to_the_maximum_error() {
        for (steps, rows) in [(240, 4), (500, 4), (59, 0)] {
            let made = staircase(steps, 1.0, 1100, ShortMove::Reverse);
            assert_eq!(made.ramp_rows(), rows, "{steps}");
            let roundings = made.max_error_s() / made.duration_s() / ROUNDING;
            assert!((roundings - (64 + 2 * (rows + 1)) as f64).abs() < 1e-9, "{steps}: {roundings}");
        }
    }
}
