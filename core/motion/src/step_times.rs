//! The exact times of a trapezoid's steps, one after another (DESIGN B1, B2).
//!
//! Step k falls at cycle floor(t*clock_hz + 1/2), t being where s(t) = k - 1/2:
//!
//! ```text
//! ramp          v = sqrt(v0^2 + 2*a*s)    t = (v - v0)/a        with s = k - 1/2
//! plateau       t = t_r + (s - s_r)/v1
//! deceleration  t = T - (ramp's t of the distance to the end)
//! ```
//!
//! The inner loop is dumb by design: in a ramp one square root and no division, because
//! clock_hz/a is multiplied with; x = v0^2 + 2*a*s is formed anew for each step, so nothing adds
//! up. Of x four roundings u = 2^-53 are half as much of v, and with those of the root, of v0, of the
//! difference and of the product a ramp's time is off by at most 8*u*v*clock_hz/a. Where that is too
//! much of a cycle (a slow acceleration to a high speed) t = 2*s/(v + v0) takes its place, which
//! divides but keeps the digits that v - v0 loses. All others, T among them, are off by at most 32 u
//! of T: a time is the sum of ds/v over the way, so v0, v1 and a, each off by u, make no more of it.
//! Where that does not tell the cycle, `crossing` does.

use crate::{
    Curve,
    crossing::{MAX_OFF, ROUNDING, Rounding, guess, judged},
    cycle_time::CycleTime,
    round_half_up,
    series::{BLOCK, COUNTED},
    square_root,
    trapezoid::Trapezoid,
};

/// How far a ramp's time may be off, in cycles, before it divides: of so few steps the cycle is judged.
const MAX_ERROR: f64 = 1.0 / 4096.0;

/// Times of a trapezoid's steps in cycles from its start, rising.
#[derive(Clone, Debug)]
pub struct StepTimes {
    /// Place of the next step, k - 1/2.
    place: f64,
    /// Last place of the acceleration, and of the plateau.
    ramp_end: f64,
    plateau_end: f64,
    /// All steps.
    count: f64,
    ramp: Ramp,
    /// Cycles at place 0, were the plateau as long as that.
    plateau_zero: f64,
    cycles_per_step: f64,
    /// Cycles of the whole move.
    end: f64,
    curve: Trapezoid,
    clock_hz: u32,
    rounding: Rounding,
}

/// The ramp from rest or the start speed: cycles over place.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    start_speed: f64,
    start_squared: f64,
    twice_acceleration: f64,
    /// clock_hz/a.
    cycles_per_speed: f64,
    twice_clock: f64,
    divides: bool,
}

impl Ramp {
    /// Cycles until `place`, not rounded.
    #[inline]
    fn cycles(&self, place: f64) -> f64 {
        if self.divides { self.divided(place) } else { self.multiplied(place) }
    }

    #[inline]
    fn divided(&self, place: f64) -> f64 {
        self.twice_clock * place / (self.speed(place) + self.start_speed)
    }

    #[inline]
    fn multiplied(&self, place: f64) -> f64 {
        (self.speed(place) - self.start_speed) * self.cycles_per_speed
    }

    #[inline]
    fn speed(&self, place: f64) -> f64 {
        square_root(self.start_squared + self.twice_acceleration * place)
    }
}

impl Trapezoid {
    /// The cycle of each step, of a clock of `clock_hz`, from the start of the move.
    #[must_use]
    pub fn step_times(&self, clock_hz: u32) -> StepTimes {
        let clock = f64::from(clock_hz);
        let count = self.steps().unsigned_abs();
        let half = count / 2;
        let in_ramp = round_half_up(self.ramp_steps).unsigned_abs();
        // Of a triangle with an odd number of steps the middle one is both; the climb has it.
        let slowing = if in_ramp > half { half } else { in_ramp };
        let cycles_per_speed = clock / self.acceleration;
        let error = self.ramp_error(clock);
        let cycles_per_step = clock / self.peak_speed;
        StepTimes {
            place: 0.5,
            ramp_end: in_ramp as f64,
            plateau_end: (count - slowing) as f64,
            count: count as f64,
            ramp: Ramp {
                start_speed: self.start_speed,
                start_squared: self.start_speed * self.start_speed,
                twice_acceleration: 2.0 * self.acceleration,
                cycles_per_speed,
                twice_clock: 2.0 * clock,
                divides: error > MAX_ERROR,
            },
            plateau_zero: self.ramp_s * clock - self.ramp_steps * cycles_per_step,
            cycles_per_step,
            end: self.duration_s() * clock,
            curve: *self,
            clock_hz,
            rounding: Rounding::new(CycleTime::default(), self.off(clock)),
        }
    }

    /// How far a ramp's time is off at most in cycles if it does not divide.
    fn ramp_error(&self, clock: f64) -> f64 {
        8.0 * ROUNDING * self.peak_speed * clock / self.acceleration
    }

    /// How far a time is off at most, in cycles.
    pub(super) fn off(&self, clock: f64) -> f64 {
        let (error, rest) = (self.ramp_error(clock), MAX_OFF * self.duration_s() * clock);
        if error > MAX_ERROR { rest } else { error + rest }
    }
}

impl StepTimes {
    #[inline]
    fn climbing(&self, place: f64) -> f64 {
        self.ramp.cycles(place)
    }

    #[inline]
    fn steady(&self, place: f64) -> f64 {
        self.plateau_zero + place * self.cycles_per_step
    }

    #[inline]
    fn slowing(&self, place: f64) -> f64 {
        self.end - self.ramp.cycles(self.count - place)
    }

    /// Writes the cycles until the next steps, not rounded, from the block's beginning on, and says of how many: none at
    /// the end. A part of the move at once.
    pub(super) fn next_block(&mut self, block: &mut [f64; BLOCK]) -> usize {
        let mut len = 0;
        while let Some(rest) = block.get_mut(len..).filter(|rest| !rest.is_empty()) {
            let first = self.place;
            let ends = [self.ramp_end, self.plateau_end, self.count];
            let Some(end) = ends.into_iter().find(|end| first < *end) else { break };
            // Places are in the middle between whole numbers, which ends are.
            let formed = rest.len().min((end - first + 0.5) as usize);
            let (part, ramp, end, count) = (rest.iter_mut().take(formed), self.ramp, self.end, self.count);
            match (first < self.ramp_end, first < self.plateau_end) {
                (false, true) => form(part, first, |place| self.steady(place)),
                _ if ramp.divides => form(part, first, |place| self.unrounded(place)),
                (true, _) => form(part, first, |place| ramp.multiplied(place)),
                (false, false) => form(part, first, |place| end - ramp.multiplied(count - place)),
            }
            self.place = first + formed as f64;
            len += formed;
        }
        len
    }

    /// Writes the times of the next steps and, of these, their cycles.
    #[inline(never)]
    fn next_cycles(&mut self, times: &mut [f64; BLOCK], block: &mut [u64; BLOCK]) -> usize {
        let place = self.place;
        let len = self.next_block(times);
        // All of them without a question, as in `scheduled_step`.
        let mut are_certain = true;
        for (cycle, cycles) in block.iter_mut().zip(&*times).take(len) {
            let from_middle;
            (*cycle, from_middle) = self.rounding.after_start(0, *cycles);
            are_certain &= self.rounding.is_certain(from_middle);
        }
        if !are_certain {
            for ((cycle, cycles), i) in block.iter_mut().zip(&*times).take(len).zip(1..) {
                if self.rounding.certain(*cycles).is_none() {
                    *cycle = judge(self.curve, self.clock_hz, place + f64::from(i), *cycles);
                }
            }
        }
        len
    }

    /// Cycles until a place, not rounded.
    #[inline]
    fn unrounded(&self, place: f64) -> f64 {
        if place < self.ramp_end {
            self.climbing(place)
        } else if place < self.plateau_end {
            self.steady(place)
        } else {
            self.slowing(place)
        }
    }
}

/// Writes the cycles until one place after another from the first on: in a loop that asks for nothing.
#[inline]
fn form<'b>(block: impl Iterator<Item = &'b mut f64>, first: f64, cycles_until: impl Fn(f64) -> f64) {
    block.zip(&COUNTED).for_each(|(cycles, i)| *cycles = cycles_until(first + i));
}

/// The cycle, at about `cycles`, of the step before `next_place`.
#[cold]
#[inline(never)]
fn judge(curve: Trapezoid, clock_hz: u32, next_place: f64, cycles: f64) -> u64 {
    let is_due_before = curve.is_due_before(clock_hz);
    judged(CycleTime::default(), guess(cycles), &|since| is_due_before((next_place - 0.5) as u64, since))
}

impl Iterator for StepTimes {
    type Item = u64;

    #[inline]
    fn next(&mut self) -> Option<u64> {
        if self.place >= self.count {
            return None;
        }
        let cycles = self.unrounded(self.place);
        self.place += 1.0;
        // Copies are judged, so that all of this stays in registers.
        Some(match self.rounding.certain(cycles) {
            Some(cycle) => cycle,
            None => judge(self.curve, self.clock_hz, self.place, cycles),
        })
    }

    /// Passes by `n` steps without forming their times.
    fn nth(&mut self, n: usize) -> Option<u64> {
        self.place += n as f64;
        self.next()
    }

    /// Block by block.
    #[inline]
    fn fold<T, F: FnMut(T, u64) -> T>(mut self, first: T, mut f: F) -> T {
        let (mut folded, mut times, mut block) = (first, [0.0; BLOCK], [0; BLOCK]);
        loop {
            let len = self.next_cycles(&mut times, &mut block);
            if len == 0 {
                return folded;
            }
            folded = block.iter().take(len).fold(folded, |folded, cycle| f(folded, *cycle));
        }
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = round_half_up(self.count - self.place + 0.5).unsigned_abs() as usize;
        (left, Some(left))
    }
}

impl ExactSizeIterator for StepTimes {}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use core::cmp::Ordering;

    const CLOCK: i128 = 16_000_000;

    /// Compares s(half_cycles/2) in the ramp with k - 1/2, in whole numbers: a = num/den.
    fn compare(half_cycles: i128, k: i128, v0: i128, (num, den): (i128, i128)) -> Ordering {
        let travel = den * 4 * v0 * half_cycles * CLOCK + num * half_cycles * half_cycles;
        travel.cmp(&(den * 4 * (2 * k - 1) * CLOCK * CLOCK))
    }

    #[test]
    fn a_ramps_steps_are_where_whole_number_arithmetic_puts_them() {
        // v0, a = num/den, steps of a triangle
        let rows = [
            (250, (9000, 1), 2_000_000),
            (0, (1, 1), 200_000),
            (0, (10_000_000, 1), 2_000_000),
            (1, (1, 1024), 20_000),
            (1_000_000, (1, 128), 2_000_000),
        ];
        for (v0, (num, den), steps) in rows {
            let a = num as f64 / den as f64;
            let curve = Trapezoid::new(steps, v0 as f64, 1e7, a);
            let mut off = 0;
            for (k, time) in (1..).zip(curve.step_times(CLOCK as u32).take(steps as usize / 2)) {
                let twice = 2 * i128::from(time);
                let early = compare(twice + 1, k, v0, (num, den)) != Ordering::Greater;
                let late = compare(twice - 1, k, v0, (num, den)) == Ordering::Greater;
                off += usize::from(early || late);
                assert!(compare(twice + 3, k, v0, (num, den)) == Ordering::Greater, "step {k} early");
                assert!(compare(twice - 3, k, v0, (num, den)) != Ordering::Greater, "step {k} late");
            }
            // Off by the one cycle only where the ideal time is next to the middle of two cycles.
            assert!(off <= 1 + steps as usize / 100, "{off} steps of {steps} are off, v0 {v0}");
        }
    }

    #[test]
    fn times_are_off_by_their_roundings_and_by_those_of_a_ramp_that_does_not_divide() {
        // Steps, top speed, acceleration, clock; roundings: 8*v1/a and 64 of the whole time.
        let rows = [
            ((2000, 1000.0, 1000.0, 1e6), (8.0 + 64.0 * 3.0) * 1e6),
            ((-750, 500.0, 1000.0, 1e6), (8.0 * 0.5 + 64.0 * 2.0) * 1e6),
            // So slow that it divides.
            ((1_000_000, 1000.0, 1.0, 1e9), 64.0 * 2000.0 * 1e9),
        ];
        for ((steps, top, acceleration, clock), roundings) in rows {
            let parts = Trapezoid::new(steps, 0.0, top, acceleration).off(clock) / ROUNDING / roundings;
            assert!((parts - 1.0).abs() < 1e-12, "{steps} steps are off by {parts} times as much");
        }
    }

    #[test]
    fn plateau_and_deceleration_are_in_their_places() {
        // Ramps of 0.5 s and 1500 steps, plateau at 5000 steps/s, 200.4 s in all.
        let (steps, clock) = (1_000_000_u64, CLOCK as u64);
        let curve = Trapezoid::new(steps as i64, 1000.0, 5000.0, 8000.0);
        let times: Vec<u64> = curve.step_times(clock as u32).collect();
        assert_eq!(times.len() as u64, steps);
        let end = clock * 2004 / 10;
        for (k, (&time, &mirrored)) in (1..).zip(times.iter().zip(times.iter().rev())) {
            assert!((time + mirrored).abs_diff(end) <= 1, "step {k}: {time} {mirrored}");
            if (1501..=steps - 1500).contains(&k) {
                let ideal = clock / 2 + (2 * (k - 1500) - 1) * clock / 10_000;
                assert!(time.abs_diff(ideal) <= 1, "step {k}: {time} {ideal}");
            }
        }
        assert!(times.is_sorted_by(|a, b| a < b));
    }

    #[test]
    fn block_by_block_the_times_are_those_of_one_after_another() {
        // A line and parts of it, either ramp alone, one that divides, steps near edges that are judged: all of them in
        // blocks that end anywhere.
        let rows = [
            (1000, 1000.0, 5000.0, 8000.0, 16_000_000),
            (3001, 1000.0, 5000.0, 8000.0, 16_000_000),
            (-777, 0.0, 1e7, 9000.0, 16_000_000),
            (500, 2000.0, 2000.0, 1.0, 16_000_000),
            (200_000, 0.0, 1000.0, 1.0, 1_000_000_000),
            (30_000, 0.0, 40_000.0, 1e-3, 16_000_000),
            (1, 1.0, 1.0, 1.0, 1_000_000),
            (0, 1.0, 1.0, 1.0, 1_000_000),
        ];
        for (steps, start, top, acceleration, clock_hz) in rows {
            let times = Trapezoid::new(steps, start, top, acceleration).step_times(clock_hz);
            for passed in [0, 1, 64, BLOCK - 1, BLOCK, BLOCK + 1, 500] {
                let mut times = times.clone();
                if passed > 0 {
                    times.nth(passed - 1);
                }
                let mut one_by_one = Vec::new();
                // Which asks for the next one each time.
                for time in times.clone() {
                    one_by_one.push(time);
                }
                let blocks = times.fold(Vec::new(), |mut all, time| {
                    all.push(time);
                    all
                });
                assert!(blocks == one_by_one, "{steps} steps to {top} steps/s, {passed} of them passed");
            }
        }
    }

    #[test]
    fn the_curve_has_as_many_steps_due_as_have_fallen() {
        for steps in [1, 2, 3, 7, 100, 3001, 3002, 6001] {
            let curve = Trapezoid::new(steps, 1000.0, 5000.0, 8000.0);
            let times = curve.step_times(CLOCK as u32);
            assert_eq!(times.len(), steps as usize);
            assert_eq!(times.clone().count(), steps as usize);
            for (k, time) in (1..).zip(times) {
                let at = |cycle: f64| round_half_up(curve.position(cycle / CLOCK as f64));
                assert_eq!((at(time as f64 - 1.0), at(time as f64 + 1.0)), (k - 1, k), "of {steps}");
            }
        }
    }
}
