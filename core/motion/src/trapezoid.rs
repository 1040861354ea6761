//! Trapezoid with every step in its ideal place (DESIGN B2's ideal curve, B1's rule).
//!
//! Uniform acceleration a from the start speed v0 to the top speed v1 and back, v^2 = v0^2 + 2*a*s;
//! a short move has no plateau, a triangle:
//!
//! ```text
//!  v1 |     ________               t_r = (v1 - v0)/a         time of a ramp
//!     |   /          \             s_r = (v1^2 - v0^2)/(2a)  steps of a ramp
//!  v0 | /              \           s(t) = v0*t + a*t^2/2     in the ramp
//!     |                                 = s_r + v1*(t - t_r) in the plateau
//!     +------------------              = n - s(T - t)        from T/2 on
//!       t_r        T-t_r  T
//! ```
//!
//! ```
//! use stepscope_motion::{Curve, trapezoid::Trapezoid};
//!
//! let go = Trapezoid::new(2000, 250.0, 4000.0, 9000.0);
//! assert_eq!((go.peak_speed(), go.speed(0.0)), (4000.0, 250.0));
//! // A short move turns round at its middle, below the top speed.
//! assert!(Trapezoid::new(200, 250.0, 4000.0, 9000.0).peak_speed() < 4000.0);
//! ```

use crate::{Curve, Peaks, crossing::is_due_before, double::Double, mirrored::Mirrored, square_root};
use alloc::vec::Vec;

/// A trapezoid or triangle of uniform acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    pub(super) halves: Mirrored,
    pub(super) start_speed: f64,
    pub(super) acceleration: f64,
    /// Highest speed that is reached: the top speed, or that of the triangle's tip.
    pub(super) peak_speed: f64,
    /// Steps of a ramp, at most half of all.
    pub(super) ramp_steps: f64,
    pub(super) ramp_s: f64,
    limits: Limits,
}

/// What a trapezoid is made of, in 106 bits: in f64 neither a decimal nor a quotient by mechanics is what it means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) start_speed: Double,
    pub(super) top_speed: Double,
    pub(super) acceleration: Double,
}

/// The curve in 106 bits, of times in s.
#[derive(Clone, Copy)]
struct Exactly {
    count: Double,
    start_speed: Double,
    acceleration: Double,
    peak_speed: Double,
    ramp_steps: Double,
    ramp: Double,
}

impl Exactly {
    fn duration(&self) -> Double {
        let two = Double::from(2.0);
        self.ramp * two + (self.count - self.ramp_steps * two) / self.peak_speed
    }

    /// Whether the first half is past `place` at `t`.
    fn is_past(&self, t: Double, place: f64) -> bool {
        let travelled = if self.ramp.exceeds(t) {
            (self.start_speed + self.acceleration * t * 0.5.into()) * t
        } else {
            self.ramp_steps + self.peak_speed * (t - self.ramp)
        };
        travelled.exceeds(place.into())
    }
}

impl Trapezoid {
    /// `steps` (left negative) from `start_speed` >= 0 to `top_speed` >= `start_speed` and back
    /// with `acceleration` > 0, in steps, s. The top speed is above 0.
    #[must_use]
    pub fn new(steps: i64, start_speed: f64, top_speed: f64, acceleration: f64) -> Self {
        let [start_speed, top_speed, acceleration] =
            [start_speed, top_speed, acceleration].map(Double::decimal);
        Self::within(steps, Limits { start_speed, top_speed, acceleration })
    }

    /// [`Self::new`], of numbers with all their digits.
    pub(super) fn within(steps: i64, limits: Limits) -> Self {
        let [start_speed, top_speed, acceleration] =
            [limits.start_speed, limits.top_speed, limits.acceleration].map(|number| number.high);
        let all = steps.unsigned_abs() as f64;
        let (v0, v1, a) = (start_speed, top_speed, acceleration);
        // (v1 - v0)*(v1 + v0) keeps the digits that v1^2 - v0^2 would lose.
        let whole_ramp = (v1 - v0) * (v1 + v0) / (2.0 * a);
        let (peak_speed, ramp_steps) = if 2.0 * whole_ramp <= all {
            (v1, whole_ramp)
        } else {
            (square_root(v0 * v0 + a * all), all / 2.0)
        };
        // s = (v0 + v)/2 * t, which has no difference of nearly equal numbers in it.
        let ramp_s = if ramp_steps > 0.0 { 2.0 * ramp_steps / (v0 + peak_speed) } else { 0.0 };
        let plateau_s = (all - 2.0 * ramp_steps) / peak_speed;
        let duration_s = 2.0 * ramp_s + plateau_s;
        let halves = Mirrored { steps, duration_s };
        Self { halves, start_speed, acceleration, peak_speed, ramp_steps, ramp_s, limits }
    }

    /// Highest speed that is reached, in steps/s.
    #[must_use]
    pub fn peak_speed(&self) -> f64 {
        self.peak_speed
    }

    /// Time of each ramp in s.
    #[must_use]
    pub fn ramp_s(&self) -> f64 {
        self.ramp_s
    }

    /// Steps of each ramp, not rounded.
    #[must_use]
    pub fn ramp_steps(&self) -> f64 {
        self.ramp_steps
    }

    fn exactly(&self) -> Exactly {
        let Limits { start_speed: v0, top_speed: v1, acceleration } = self.limits;
        let (count, two) = (Double::from(self.halves.steps.unsigned_abs()), Double::from(2.0));
        let whole_ramp = (v1 - v0) * (v1 + v0) / (acceleration * two);
        let (peak_speed, ramp_steps) = if (whole_ramp * two).exceeds(count) {
            ((v0 * v0 + acceleration * count).square_root(), count / two)
        } else {
            (v1, whole_ramp)
        };
        let ramp = ramp_steps * two / (v0 + peak_speed);
        Exactly { count, start_speed: v0, acceleration, peak_speed, ramp_steps, ramp }
    }

    /// How long it lasts in s.
    pub(super) fn exact_duration(&self) -> Double {
        self.exactly().duration()
    }

    /// Whether step `k` (from 1) falls due before a time in cycles of a clock of `clock_hz`, for certain.
    pub(super) fn is_due_before(&self, clock_hz: u32) -> impl Fn(u64, Double) -> bool + use<> {
        let (curve, count) = (self.exactly(), self.halves.steps.unsigned_abs());
        let (duration, clock) = (curve.duration(), Double::from(u64::from(clock_hz)));
        move |k, since| is_due_before((k, count), since / clock, duration, |t, place| curve.is_past(t, place))
    }

    /// s(t) of the first half, in steps without sign.
    fn first_half(&self, t: f64) -> f64 {
        if t < self.ramp_s {
            (self.start_speed + self.acceleration * t / 2.0) * t
        } else {
            self.ramp_steps + self.peak_speed * (t - self.ramp_s)
        }
    }
}

impl Curve for Trapezoid {
    fn duration_s(&self) -> f64 {
        self.halves.duration_s
    }

    fn steps(&self) -> i64 {
        self.halves.steps
    }

    fn position(&self, t: f64) -> f64 {
        self.halves.position(t, |t| self.first_half(t))
    }

    fn speed(&self, t: f64) -> f64 {
        let t = self.halves.nearer_end(t);
        let climbed = self.start_speed + self.acceleration * t;
        self.halves.signed(if t < self.ramp_s { climbed } else { self.peak_speed })
    }

    fn acceleration(&self, t: f64) -> f64 {
        if self.halves.nearer_end(t) >= self.ramp_s {
            0.0
        } else {
            self.halves.acceleration(t, self.acceleration)
        }
    }

    fn peaks(&self) -> Peaks {
        let acceleration = if self.ramp_s > 0.0 { self.acceleration } else { 0.0 };
        // At the tip of a triangle the acceleration is reversed; else it ends where the plateau begins.
        let turns = 2.0 * self.ramp_s >= self.halves.duration_s;
        let acceleration_jump = if turns { 2.0 * acceleration } else { acceleration };
        Peaks { speed: self.peak_speed, acceleration, acceleration_jump, ..Peaks::default() }
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        self.halves.breakpoints_s([self.ramp_s].into_iter())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_moves_have_a_plateau_and_short_ones_are_triangles() {
        // (steps, start, top, acceleration), [peak speed, ramp s, ramp steps, duration s]
        let rows = [
            ((10_000, 1000.0, 5000.0, 8000.0), [5000.0, 0.5, 1500.0, 2.4]),
            ((3000, 1000.0, 5000.0, 8000.0), [5000.0, 0.5, 1500.0, 1.0]),
            ((800, 0.0, 5000.0, 8000.0), [2_529.822_128, 0.316_227_766, 400.0, 0.632_455_532]),
            ((-4, 1000.0, 5000.0, 8000.0), [1_015.874_007_9, 0.001_984_251, 2.0, 0.003_968_502]),
            ((500, 1000.0, 1000.0, 1.0), [1000.0, 0.0, 0.0, 0.5]),
        ];
        for ((steps, start, top, acceleration), expected) in rows {
            let curve = Trapezoid::new(steps, start, top, acceleration);
            let found = [curve.peak_speed(), curve.ramp_s(), curve.ramp_steps(), curve.duration_s()];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() <= 1e-6 * expected, "{steps}: {found} {expected}");
            }
            assert_eq!(curve.position(curve.duration_s()), steps as f64);
        }
    }

    #[test]
    fn the_square_of_the_speed_grows_with_the_travel() {
        let curve = Trapezoid::new(4000, 300.0, 4000.0, 9000.0);
        for i in 0..100 {
            let t = curve.ramp_s() * f64::from(i) / 100.0;
            let (v, s) = (curve.speed(t), curve.position(t));
            assert!((v * v - (300.0 * 300.0 + 2.0 * 9000.0 * s)).abs() < 1e-6 * v * v);
            let mirrored = 4000.0 - curve.position(curve.duration_s() - t);
            assert!((mirrored - s).abs() < 1e-9, "{t}: {s} {mirrored}");
        }
    }
}
