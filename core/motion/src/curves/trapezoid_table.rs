//! Trapezoid by acceleration table (DESIGN B2, Sonobe 2011).
//!
//! A timer interrupt makes one step and loads the timer with the next interval from the [`AccelerationTable`]. Interval i
//! (from 0) of n has row min(i, n - 1 - i, top), so a short move is a triangle. Step k is due at the sum of the first k
//! reloads, and the move ends with its last step:
//!
//! ```text
//! rate |    _|```|_
//!      |  _|       |_
//!      +-------------- steps
//! ```
//!
//! The paper does not define the steps needed to stop. Here the last interval is row 0 like the first; the two middle
//! intervals of a triangle with an even count share the highest row.

use crate::curves::acceleration_table::AccelerationTable;
use crate::curves::curve::{greater, signed};
use crate::curves::stepped::{self, ExactTime};
use crate::timing::{CycleTime, F106, IsDueBefore, Run, Runs, Schedule};
use crate::{Curve, Peaks, bisection::first_near, format::grouped};
use alloc::{boxed::Box, format, string::String, vec::Vec};

/// A trapezoid by an acceleration table.
#[derive(Clone, Debug, PartialEq)]
pub struct TrapezoidTable {
    steps: i64,
    table: AccelerationTable,
    /// Intervals of each ramp, and the highest row used; at least one interval is between the ramps.
    ramp: u64,
    /// Timer ticks from the start to step k, k = 0 ..= ramp + 1.
    /// Invariant: at least two entries, rising.
    sums: Vec<u64>,
}

/// Why a move cannot have a table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoTable {
    /// It needs more rows than allowed.
    Rows { needed: u64 },
    /// The timer is slower than the maximum rate in steps/s.
    Timer { rate: f64 },
}

impl TrapezoidTable {
    /// `steps` (left negative, not 0, at most 1e9) by the table.
    /// Errors: [`NoTable`] if the move needs more than `max_rows` rows or a rate above the timer's.
    pub fn new(steps: i64, table: AccelerationTable, max_rows: u64) -> Result<Self, NoTable> {
        let ramp = table.top().min(steps.unsigned_abs().saturating_sub(1) / 2);
        if ramp >= max_rows {
            return Err(NoTable::Rows { needed: ramp.saturating_add(1) });
        }
        let max_rate = table.rate(ramp);
        if max_rate > table.timer_hz().into() {
            return Err(NoTable::Timer { rate: max_rate as f64 });
        }
        let mut sums = Vec::with_capacity(ramp as usize + 2);
        let mut sum = 0;
        sums.push(0);
        for row in 0..=ramp {
            sum += table.reload(row);
            sums.push(sum);
        }
        debug_assert!(sums.len() >= 2 && sums.is_sorted_by(|a, b| a < b), "a row without a reload");
        debug_assert!(steps.unsigned_abs() > 2 * ramp, "no interval between the ramps");
        Ok(Self { steps, table, ramp, sums })
    }

    /// The whole table, including unused rows.
    pub fn table(&self) -> &AccelerationTable {
        &self.table
    }

    pub fn rows(&self) -> u64 {
        self.table.top().saturating_add(1)
    }

    /// Rows of the table that this move uses.
    pub fn used_rows(&self) -> u64 {
        self.ramp + 1
    }

    fn count(&self) -> u64 {
        self.steps.unsigned_abs()
    }

    fn plateau_reload(&self) -> u64 {
        match self.sums.as_slice() {
            [.., before, last] => last - before,
            _ => 0,
        }
    }

    fn sum(&self, steps: u64) -> u64 {
        self.sums.get(steps as usize).copied().unwrap_or(0)
    }

    /// Timer ticks to step `k` (from 1; 0 is the start, from the last step on the end).
    pub fn step_ticks(&self, k: u64) -> u64 {
        let count = self.count();
        let k = if k > count { count } else { k };
        let plateau = count - 2 * self.ramp;
        if k <= self.ramp {
            self.sum(k)
        } else if k - self.ramp <= plateau {
            self.sum(self.ramp) + (k - self.ramp) * self.plateau_reload()
        } else {
            2 * self.sum(self.ramp) + plateau * self.plateau_reload() - self.sum(count - k)
        }
    }

    pub(crate) fn step_s(&self, k: u64) -> f64 {
        self.step_ticks(k) as f64 / f64::from(self.table.timer_hz())
    }

    fn step_time(&self, k: u64, clock_hz: u32) -> CycleTime {
        let timer_hz = u128::from(self.table.timer_hz().max(1));
        let product = u128::from(self.step_ticks(k)) * u128::from(clock_hz);
        let (whole, remainder) = (product / timer_hz, product % timer_hz);
        CycleTime { whole: whole as u64, part: F106::from(remainder as u64) / F106::from(timer_hz as u64) }
    }

    fn first_sum(&self, ticks: u64, near: u64) -> u64 {
        first_near(near, self.sums.len() as u64, |steps| self.sum(steps) >= ticks)
    }

    /// Number of steps due by `t`; the search begins at `near`, which only affects its duration.
    fn steps_without_sign(&self, t: f64, near: u64, exact_time: ExactTime) -> u64 {
        let count = self.count();
        // Timer ticks in f64 give a guess that may be wrong by one.
        let ticks = (t * f64::from(self.table.timer_hz())) as u64;
        let (up, all) = (self.sum(self.ramp), self.step_ticks(count));
        let guess = if ticks < up {
            self.first_sum(ticks.saturating_add(1), near).saturating_sub(1)
        } else if ticks < all - up {
            self.ramp + (ticks - up).checked_div(self.plateau_reload()).unwrap_or(0)
        } else {
            let left = all.saturating_sub(ticks);
            count - self.first_sum(left, count.saturating_sub(near))
        };
        stepped::steps_due(t, guess, count, exact_time, |k| self.step_s(k))
    }

    /// Steps due by `t`; the search begins at `before`, an earlier result.
    pub(crate) fn steps_due(&self, t: f64, before: i64) -> i64 {
        let due = self.steps_without_sign(t, before.unsigned_abs(), ExactTime::of(self.steps)) as i64;
        if self.steps < 0 { -due } else { due }
    }

    fn row(&self, i: u64) -> u64 {
        let from_end = self.count().saturating_sub(1).saturating_sub(i);
        i.min(from_end).min(self.ramp)
    }

    fn interval_speed(&self, i: u64) -> f64 {
        let row = self.row(i);
        let reload = self.sum(row + 1) - self.sum(row);
        if reload == 0 { 0.0 } else { f64::from(self.table.timer_hz()) / reload as f64 }
    }

    /// Difference of the speeds of interval `i` and the previous one, divided by the time between their middles.
    fn acceleration_into(&self, i: u64) -> f64 {
        let (before, after) = (self.interval_speed(i.saturating_sub(1)), self.interval_speed(i));
        let between = (1.0 / before + 1.0 / after) / 2.0;
        if after == before { 0.0 } else { (after - before) / between }
    }

    fn interval(&self, t: f64) -> u64 {
        self.steps_without_sign(t, 0, ExactTime::Included).min(self.count().saturating_sub(1))
    }
}

impl Schedule for TrapezoidTable {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        self.step_time(self.count(), clock_hz)
    }

    /// Three runs, because the plateau needs no table of sums.
    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let per_tick = f64::from(clock_hz) / f64::from(self.table.timer_hz());
        let (max_error, right) = (self.max_error_s() * f64::from(clock_hz), self.steps >= 0);
        let by_sums = move |steps_before: u64| {
            move |step: f64| self.step_ticks(steps_before + step as u64 + 1) as f64 * per_tick
        };
        let (start, reload) = (self.sum(self.ramp) as f64, self.plateau_reload() as f64);
        let plateau = self.count() - 2 * self.ramp;
        Box::new(
            [
                Run::new(self.ramp, right, max_error, by_sums(0)),
                Run::new(plateau, right, max_error, move |step| (start + (step + 1.0) * reload) * per_tick),
                Run::new(self.ramp, right, max_error, by_sums(self.ramp + plateau)),
            ]
            .into_iter(),
        )
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        Box::new(move |k, since| since > self.step_time(k, clock_hz).double())
    }
}

impl Curve for TrapezoidTable {
    fn duration_s(&self) -> f64 {
        self.step_s(self.count())
    }

    fn steps(&self) -> i64 {
        self.steps
    }

    fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s() {
            return self.steps as f64;
        }
        let due = self.steps_without_sign(t, 0, ExactTime::Included);
        signed(self.steps, stepped::position(t, due, self.count(), |k| self.step_s(k)))
    }

    fn speed(&self, t: f64) -> f64 {
        signed(self.steps, self.interval_speed(self.interval(t)))
    }

    /// The slope from the middle of this interval to that of the next, which shows the effect of the table's rounding.
    fn acceleration(&self, t: f64) -> f64 {
        let i = self.interval(t);
        signed(self.steps, if i + 1 < self.count() { self.acceleration_into(i + 1) } else { 0.0 })
    }

    /// The acceleration is constant in an interval and jumps at its end; the jerk is 0.
    fn peaks(&self) -> Peaks {
        let mut peaks = Peaks::default();
        // The second half mirrors the first.
        for i in 0..=self.ramp {
            let (slope, next) = (self.acceleration_into(i), self.acceleration_into(i + 1));
            peaks.speed = greater(peaks.speed, self.interval_speed(i));
            peaks.acceleration = greater(peaks.acceleration, libm::fabs(slope));
            if i > 0 {
                let jump = libm::fabs(next - slope);
                peaks.acceleration_jump = greater(peaks.acceleration_jump, jump);
            }
            let jump = self.interval_speed(i) - self.interval_speed(i.saturating_sub(1));
            peaks.jump = greater(peaks.jump, libm::fabs(jump));
        }
        peaks
    }

    /// One more interval than the ramp has, because its slope shows the end of the ramp.
    fn breakpoints_s(&self) -> Vec<f64> {
        let near = self.used_rows().min(self.count());
        let far = self.count().saturating_sub(self.used_rows()).max(near + 1);
        (1..=near).chain(far..self.count()).map(|k| self.step_s(k)).collect()
    }

    fn detail(&self, _: f64) -> String {
        format!("peak {} steps/s, table of {} rows", grouped(self.peaks().speed), self.rows())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::round_half_up;

    fn table(steps: i64, top_speed: f64) -> TrapezoidTable {
        let table = AccelerationTable::new(250.0, top_speed, 9000.0, 1_000_000);
        TrapezoidTable::new(steps, table, 1_000_000).unwrap()
    }

    /// Simulates the paper's program: the interrupt counts a step, moves the index by at most one toward the target that the
    /// main program has set, and reloads the timer. Returns the timer ticks at each step.
    fn simulate_program(table: &AccelerationTable, count: u64, target: impl Fn(u64, u64) -> u64) -> Vec<u64> {
        let (mut now, mut index, mut made) = (0, 0, 0);
        let mut reload = table.reload(index);
        let mut ticks = Vec::new();
        while made < count {
            now += reload;
            made += 1;
            ticks.push(now);
            let aim = target(made, index);
            if index < aim {
                index += 1;
            } else if index > aim {
                index -= 1;
            }
            reload = table.reload(index);
        }
        ticks
    }

    #[test]
    fn steps_agree_with_the_interrupt_program() {
        let short = (1..200).map(|n| (n, 700.0)).chain([(500, 700.0), (501, 1e5), (7, 250.0)]);
        let mut seed = 2011_u64;
        let any = core::iter::from_fn(|| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            Some((1 + (seed >> 33) % 3000, 250.0 + ((seed >> 20) % 4000) as f64))
        });
        for (count, top_speed) in short.chain(any.take(200)) {
            let table = table(count as i64, top_speed);
            let top = table.table().top();
            // The program can stop from an index up to the number of steps left after the next interval.
            let expected =
                simulate_program(table.table(), count, |made, _| top.min(count.saturating_sub(made + 1)));
            let found: Vec<u64> = (1..=count).map(|k| table.step_ticks(k)).collect();
            assert_eq!(found, expected, "{count} steps to {top_speed}");
            assert_eq!(found.first(), Some(&table.table().reload(0)), "the first reload");
            let before = found.iter().rev().nth(1).unwrap_or(&0);
            assert_eq!(
                found.last().map(|last| last - before),
                Some(table.table().reload(0)),
                "the last reload"
            );
            assert_eq!(table.duration_s(), *expected.last().unwrap() as f64 / 1e6);
        }
    }

    /// The paper's main program has two targets, the top and 0, and checks between interrupts whether only the steps to stop
    /// are left. The steps are the same, except that a triangle with an even count goes one row higher and makes its last step
    /// at row 1 instead of row 0.
    #[test]
    fn with_two_targets_only_an_even_triangle_ends_one_row_too_fast() {
        for count in 2..300 {
            let table = table(count as i64, 700.0);
            let top = table.table().top();
            // The main program runs after the interrupt, so it has the new index.
            let main_target = core::cell::Cell::new(top);
            let two = simulate_program(table.table(), count, |made, index| {
                let aim = main_target.get();
                let next = if index < aim { index + 1 } else { index.saturating_sub(u64::from(index > aim)) };
                if made + next + 1 >= count {
                    main_target.set(0);
                }
                aim
            });
            let found: Vec<u64> = (1..=count).map(|k| table.step_ticks(k)).collect();
            let even_triangle = count % 2 == 0 && count / 2 <= top;
            if even_triangle {
                let half = count / 2;
                let (last, rate) = (*two.last().unwrap(), |row| table.table().reload(row));
                assert_eq!(last + rate(0), found.last().unwrap() + rate(half), "{count} steps");
                assert_eq!(two[..half as usize], found[..half as usize]);
            } else {
                assert_eq!(two, found, "{count} steps");
            }
        }
    }

    #[test]
    fn a_step_is_due_at_its_time_or_to_the_left_right_after_it() {
        for (steps, sign) in [(1, 1), (2, -1), (40, 1), (41, -1), (2000, 1), (2001, -1)] {
            let table = table(steps * sign, 700.0);
            for k in 1..=steps {
                let ticks = table.step_ticks(k as u64) as f64;
                let due = |ticks: f64| sign * round_half_up(table.position(ticks / 1e6));
                let at_time = if sign < 0 && k < steps { k - 1 } else { k };
                assert_eq!(
                    (due(ticks - 1.0), due(ticks), due(ticks + 1.0)),
                    (k - 1, at_time, k),
                    "of {steps}"
                );
            }
            assert_eq!(table.position(table.duration_s()), (steps * sign) as f64);
        }
    }

    #[test]
    fn refuses_too_many_rows_and_a_slow_timer() {
        let new = |steps, top, timer| {
            TrapezoidTable::new(steps, AccelerationTable::new(250.0, top, 9000.0, timer), 100).err()
        };
        // Row 100 would be the 101st.
        assert_eq!(new(200, 1e6, 1_000_000), None);
        assert_eq!(new(201, 1e6, 1_000_000), Some(NoTable::Rows { needed: 101 }));
        assert_eq!(new(50, 600.0, 600), None);
        assert_eq!(new(50, 600.0, 599), Some(NoTable::Timer { rate: 600.0 }));
        // Two steps use only row 0, whose reload is 1.
        assert_eq!(new(2, 600.0, 250), None);
        let two = TrapezoidTable::new(2, AccelerationTable::new(250.0, 600.0, 9000.0, 250), 100).unwrap();
        assert!(two.sums.is_sorted_by(|a, b| a < b), "{two:?}");
        assert_eq!((two.step_ticks(1), two.step_ticks(2), two.used_rows()), (1, 2, 1));
    }

    #[test]
    fn the_start_of_a_search_does_not_change_its_result() {
        for steps in [1, 2, -41, 2000, -2001] {
            let table = table(steps, 700.0);
            for sample in -1..400 {
                let t = table.duration_s() * f64::from(sample) / 397.0;
                let is_after_end = i64::from(steps < 0 && t == table.duration_s());
                let due = round_half_up(table.position(t)) + is_after_end;
                for before in [0, due - 1, due, due + 3, steps, i64::MIN, i64::MAX] {
                    assert_eq!(table.steps_due(t, before), due, "{steps} steps, {t} s, {before} before");
                }
            }
        }
    }

    #[test]
    fn acceleration_shows_the_rounding_of_rates() {
        let table = table(2000, 4000.0);
        let peaks = table.peaks();
        assert!(peaks.speed >= 4000.0 && peaks.speed < 4001.0, "{peaks:?}");
        assert!(peaks.acceleration > 9000.0 && peaks.acceleration < 100_000.0, "{peaks:?}");
        assert!(table.acceleration(0.01) > 0.0 && table.acceleration(table.duration_s() - 0.01) < 0.0);
    }
}
