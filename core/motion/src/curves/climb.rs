//! Rates in whole steps/s during uniform acceleration (DESIGN B2, B3).
//!
//! ```text
//! rate(k) = round_half_up(sqrt(v0^2 + 2*a*k))      k steps from the start
//!
//! v0 = 6.1, a = 9.52:   6.1^2 + 2*9.52*1 = 56.25 = 7.5^2, so rate(1) is 8; in f64 the root is 7.499999999999999
//! ```
//!
//! An f64 decides unless its root is next to a half. There the squares are compared as integers, so that ties of decimals
//! are rounded up.

use crate::{bisection::first_near, round_half_up, square_root, timing::Exact};
use num_bigint::BigUint;

/// Maximum relative error of a speed in f64: 64 roundings.
const MAX_ERROR: f64 = 32.0 * f64::EPSILON;

/// Maximum steps of an exact search; no move has that many.
const MAX_STEPS: u64 = 1 << 52;
/// From this speed on an f64 has no halves.
const MAX_SPEED: f64 = (1_u64 << 51) as f64;

fn speed_after(start: f64, acceleration: f64, steps: u64) -> f64 {
    square_root(start * start + 2.0 * acceleration * steps as f64)
}

/// The rate after `steps` from `start` steps/s at `acceleration` steps/s^2; `None` if the speed is so close to a half that
/// only [`Climb::rate`] decides.
pub(crate) fn quick_rate(start: f64, acceleration: f64, steps: u64) -> Option<u64> {
    let speed = speed_after(start, acceleration, steps);
    let is_near_half = speed < MAX_SPEED && libm::fabs(speed - libm::floor(speed) - 0.5) <= MAX_ERROR * speed;
    (!is_near_half).then(|| round_half_up(speed).unsigned_abs())
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Climb {
    start: f64,
    acceleration: f64,
    /// The squared speed after k steps is (base + slope*k)/unit.
    base: BigUint,
    slope: BigUint,
    unit: BigUint,
}

impl Climb {
    /// From `start` >= 0 in steps/s with `acceleration` > 0 in steps/s^2.
    pub(crate) fn new(start: &Exact, acceleration: &Exact) -> Self {
        let (start_numerator, start_denominator) = start.magnitude();
        let (numerator, denominator) = acceleration.magnitude();
        let squared_denominator = start_denominator * start_denominator;
        let base = start_numerator * start_numerator * denominator;
        let slope = numerator * &squared_denominator * 2_u8;
        let unit = squared_denominator * denominator;
        Self { start: start.nearest(), acceleration: acceleration.nearest(), base, slope, unit }
    }

    pub(crate) fn rate(&self, steps: u64) -> u64 {
        quick_rate(self.start, self.acceleration, steps).unwrap_or_else(|| {
            let below = speed_after(self.start, self.acceleration, steps) as u64;
            below + u64::from(self.reaches(steps, &(2 * below + 1).into(), &2_u8.into()))
        })
    }

    /// The first step after which the speed is at least `top` steps/s; an estimate beyond 2^52 steps.
    pub(crate) fn steps_to(&self, top: &Exact) -> u64 {
        let speed = top.nearest();
        let climb = (speed - self.start) * (speed + self.start);
        let near = libm::ceil(climb / (2.0 * self.acceleration)) as u64;
        if near >= MAX_STEPS {
            return near;
        }
        let (numerator, denominator) = top.magnitude();
        first_near(near, 2 * MAX_STEPS, |steps| self.reaches(steps, numerator, denominator))
    }

    fn reaches(&self, steps: u64, numerator: &BigUint, denominator: &BigUint) -> bool {
        let square = &self.slope * steps + &self.base;
        square * denominator * denominator >= numerator * numerator * &self.unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn climb(start: f64, acceleration: f64) -> Climb {
        Climb::new(&Exact::of(start), &Exact::of(acceleration))
    }

    #[test]
    fn rounds_ties_of_decimals_up_and_smaller_numbers_down() {
        // Start speed, acceleration, steps, rate.
        let rows = [
            (6.1, 9.52, 1, 8),
            (6.1, 9.519_999_999_999_998, 1, 7),
            (6.099_999_999_999_999, 9.52, 1, 7),
            (6.100_000_000_000_001, 9.52, 1, 8),
            (7.5, 9.0, 0, 8),
            (7.499_999_999_999_999, 9.0, 0, 7),
            (1000.5, 29_435.0, 1, 1030),
            (1_000.499_999_999_999_9, 29_435.0, 1, 1029),
            (0.7, 0.88, 1, 2),
            (0.3, 0.000_001, 0, 0),
        ];
        for (start, acceleration, steps, expected) in rows {
            assert_eq!(climb(start, acceleration).rate(steps), expected, "{start} {acceleration} {steps}");
        }
    }

    #[test]
    fn rounds_every_tie_of_short_decimals_up() {
        let mut ties = 0;
        for tenths in 5..200_u32 {
            for (half, steps) in
                (tenths / 10 + 1..tenths / 10 + 12).flat_map(|half| [1_u32, 2, 5].map(|n| (half, n)))
            {
                // (half + 1/2)^2 - (tenths/10)^2 = 2*a*steps, in hundredths.
                let hundredths = (10 * half + 5).pow(2) - tenths.pow(2);
                let parts = f64::from(hundredths) * 1000.0 / f64::from(2 * steps);
                if parts != libm::floor(parts) {
                    continue;
                }
                let acceleration: f64 = alloc::format!("{parts}e-5").parse().unwrap();
                let start: f64 = alloc::format!("{tenths}e-1").parse().unwrap();
                let found = climb(start, acceleration).rate(steps.into());
                assert_eq!(found, u64::from(half) + 1, "{start} {acceleration} {steps}");
                ties += 1;
            }
        }
        assert!(ties > 5000, "{ties}");
    }

    #[test]
    fn counts_a_speed_that_is_reached_exactly() {
        // Start, acceleration, top speed; the steps to it.
        let rows = [
            (6.1, 9.52, 7.5, 1),
            (6.1, 9.52, 7.500_000_000_000_001, 2),
            (0.1, 0.12, 0.5, 1),
            (0.1, 0.04, 0.3, 1),
            (0.1, 0.1, 0.7, 3),
            (600.0, 1.0, 600.0, 0),
            (1.0, 1e-6, 1e7, u64::MAX),
        ];
        for (start, acceleration, top, expected) in rows {
            let found = climb(start, acceleration).steps_to(&Exact::of(top));
            assert!(
                found == expected || (found >= MAX_STEPS && expected >= MAX_STEPS),
                "{start} {top}: {found}"
            );
        }
    }

    /// 3/8 degree per second at 80/9 steps per degree: 10/3 is no decimal, and 100/9 + 2*203.125/9 is 7.5^2.
    #[test]
    fn rounds_ties_of_periodic_quotients_up() {
        let steps = |degrees: f64| Exact::of(degrees).times(80.0).divided_by(9.0);
        assert_eq!(Climb::new(&steps(0.375), &steps(2.539_062_5)).rate(1), 8);
    }
}
