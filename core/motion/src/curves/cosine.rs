//! Cosine S-curve with exact distance and exact time (DESIGN B4, `exact`; Song, Han, Lu 2021).
//!
//! ```text
//!  f_max |     .--------.       f_max = n/(T - t_s)
//!        |    /          \      f(t)  = f_max/2*(1 - cos(pi*t/t_s))            in the ramp
//!        | .-'            '-.   s(t)  = f_max/2*(t - t_s/pi*sin(pi*t/t_s))     in the ramp
//!        +-----------------------       = f_max*(t - t_s/2)                    in the plateau
//!         t_s           T-t_s  T         = n - s(T - t)                        from T/2 on
//! ```
//!
//! n steps, T the duration and t_s the time of each ramp, 0 <= t_s <= T/2. By symmetry s(T) is exactly n.

use crate::curves::mirrored::{Mirrored, MirroredCurve, RAMP_PARTS, parts_s};
use crate::curves::ramp::longest_ramp_s;
use crate::timing::{
    CycleTime, Exact, F106, IsDueBefore, Number, Runs, Schedule, is_mirrored_due_before, one_searched_run,
};
use crate::{Peaks, format::ramp_up_to};
use alloc::{boxed::Box, string::String, vec::Vec};
use core::f64::consts::PI;

/// A cosine S-curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cosine {
    halves: Mirrored,
    pub(crate) ramp_s: f64,
    top_speed: f64,
}

impl Cosine {
    /// `steps` (left negative) in `duration_s` > 0 with ramps of `ramp_s`, from 0 to half of it.
    pub fn new(steps: i64, duration_s: f64, ramp_s: f64) -> Self {
        debug_assert!((0.0..=duration_s / 2.0).contains(&ramp_s), "ramps of {ramp_s} s in {duration_s} s");
        let top_speed = steps.unsigned_abs() as f64 / (duration_s - ramp_s);
        Self { halves: Mirrored { steps, duration_s }, ramp_s, top_speed }
    }

    /// f_max in steps/s, the plateau speed.
    pub fn top_speed(&self) -> f64 {
        self.top_speed
    }

    /// The longest ramp in s with a top speed of at most `speed` steps/s ([`longest_ramp_s`]).
    pub fn longest_ramp_s(&self, speed: f64) -> Option<f64> {
        longest_ramp_s(self.halves.steps.unsigned_abs(), self.halves.duration_s, speed, 0.5)
    }

    /// Phase of the ramp at `t` from the nearer end, 0 to pi; `None` in the plateau.
    fn phase(&self, t: f64) -> Option<f64> {
        (t < self.ramp_s).then(|| PI * t / self.ramp_s)
    }

    pub(crate) fn relative_speed(&self, t: f64) -> f64 {
        // (1 - cos x)/2 = sin^2(x/2), which does not cancel near 0.
        self.phase(self.halves.nearer_end(t)).map_or(1.0, |phase| {
            let sine = libm::sin(phase / 2.0);
            sine * sine
        })
    }

    fn ramp_steps(&self) -> f64 {
        self.top_speed * self.ramp_s / 2.0
    }

    pub(crate) fn changes(&self) -> Vec<f64> {
        self.halves.changes(&[self.ramp_steps()])
    }
}

fn first_half<N: Number>(t: N, top_speed: N, ramp: N) -> N {
    if t < ramp {
        top_speed * ramp / (N::PI * 2.0) * (N::PI * t / ramp).minus_its_sine()
    } else {
        top_speed * (t - ramp * 0.5)
    }
}

/// Error of a time in f64: 10 u of the level (three of them from T - t_s), 4 u of the two formulas for x - sin(x), and 2 u
/// of Newton's method. With the products by ramp time and clock, and the difference from the end, it is below 32 u.
impl Schedule for Cosine {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::exact(&Exact::of(self.halves.duration_s).times(clock_hz.into()))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        one_searched_run(self, clock_hz, self.changes())
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let cycles = |time_s: f64| Exact::of(time_s).times(clock_hz.into()).double();
        let (duration, ramp) = (cycles(self.halves.duration_s), cycles(self.ramp_s));
        let count = self.halves.steps.unsigned_abs();
        let top_speed = F106::from(count) / (duration - ramp);
        Box::new(move |k, since| {
            is_mirrored_due_before((k, count), since, duration, |t, position| {
                first_half(t, top_speed, ramp) > position.into()
            })
        })
    }
}

impl MirroredCurve for Cosine {
    fn halves(&self) -> &Mirrored {
        &self.halves
    }

    fn half_position(&self, t: f64) -> f64 {
        first_half(t, self.top_speed, self.ramp_s)
    }

    fn half_speed(&self, t: f64) -> f64 {
        match self.phase(t) {
            Some(phase) => {
                let sine = libm::sin(phase / 2.0);
                self.top_speed * sine * sine
            }
            None => self.top_speed,
        }
    }

    fn half_acceleration(&self, t: f64) -> Option<f64> {
        Some(self.top_speed * PI / (2.0 * self.ramp_s) * libm::sin(self.phase(t)?))
    }

    /// The phase solves x - sin(x) = pi*position/(steps of the ramp).
    fn half_time_s(&self, position: f64) -> f64 {
        let ramp_steps = self.ramp_steps();
        if position >= ramp_steps {
            self.ramp_s / 2.0 + position / self.top_speed
        } else {
            self.ramp_s * phase_at(PI * position / ramp_steps) / PI
        }
    }

    fn half_breakpoints_s(&self) -> Vec<f64> {
        parts_s(self.ramp_s, RAMP_PARTS).collect()
    }

    fn all_peaks(&self) -> Peaks {
        let speed = self.top_speed;
        if self.ramp_s > 0.0 {
            let acceleration = speed * PI / (2.0 * self.ramp_s);
            // The jerk has its maximum f_max*pi^2/(2*t_s^2) at both ends of each ramp.
            Peaks { speed, acceleration, jerk: acceleration * PI / self.ramp_s, ..Peaks::default() }
        } else {
            Peaks { speed, ..Peaks::default() }
        }
    }

    fn text(&self, limit_steps_s: f64) -> String {
        let longest_s = self.longest_ramp_s(limit_steps_s);
        self.all_peaks().to_text() + &ramp_up_to(longest_s, self.halves.duration_s)
    }
}

/// Maximum steps of Newton's method; two or three are enough.
const MAX_NEWTON_STEPS: u32 = 10;

/// Approximates [`phase_at`] by the inverse series.
fn guess_phase(level: f64) -> f64 {
    let root = libm::cbrt(6.0 * level);
    let square = root * root;
    root * (1.0 + square * (1.0 / 60.0 + square * (1.0 / 1400.0 + square / 25_200.0)))
}

/// The x of 0..=pi with x - sin(x) = `level`.
fn phase_at(level: f64) -> f64 {
    // The guess is slightly low. x - sin(x) rises and is convex, so the first step of Newton's method passes the root, and
    // the others fall toward it.
    let mut phase = guess_phase(level);
    for _ in 0..MAX_NEWTON_STEPS {
        let half = libm::sin(phase / 2.0);
        let correction = (phase.minus_its_sine() - level) / (2.0 * half * half);
        if libm::fabs(correction) <= phase * f64::EPSILON {
            break;
        }
        phase -= correction;
    }
    phase
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Curve;

    #[test]
    fn has_the_top_speed_and_longest_ramp_of_the_paper() {
        assert_eq!(Cosine::new(6400, 0.4, 0.2).top_speed(), 32_000.0);
        let curve = Cosine::new(3200, 0.4, 0.2);
        let longest = curve.longest_ramp_s(19_200.0).unwrap();
        assert!((longest - 0.233_333_3).abs() < 1e-6, "{longest}");
        assert_eq!(curve.longest_ramp_s(8000.0), Some(0.0));
        assert_eq!(curve.longest_ramp_s(7999.0), None);
    }

    #[test]
    fn position_is_the_integral_of_speed_and_speed_of_acceleration() {
        for (steps, duration_s, ramp_s) in [(6400, 0.4, 0.2), (-6400, 0.4, 0.1), (1, 2.0, 0.5)] {
            let curve = Cosine::new(steps, duration_s, ramp_s);
            let slots = 20_000;
            let dt = duration_s / f64::from(slots);
            let (mut position, mut speed) = (0.0, 0.0);
            let scale = f64::from(steps as i32).abs();
            for slot in 0..slots {
                let middle = (f64::from(slot) + 0.5) * dt;
                position += curve.speed(middle) * dt;
                speed += curve.acceleration(middle) * dt;
                let end = f64::from(slot + 1) * dt;
                assert!((position - curve.position(end)).abs() < 1e-6 * scale, "position at {end}");
                assert!((speed - curve.speed(end)).abs() < 1e-6 * scale / duration_s, "speed at {end}");
            }
        }
    }

    #[test]
    fn ends_exactly_and_is_half_way_in_the_middle() {
        for steps in [1, -1, 3, 6400, 999_999_999, -1_000_000_000] {
            for ramp_s in [0.0, 0.05, 0.15] {
                let curve = Cosine::new(steps, 0.3, ramp_s);
                let end = curve.duration_s();
                assert_eq!(curve.position(0.0), 0.0);
                assert_eq!(curve.position(end), steps as f64);
                assert_eq!(curve.position(9.0), steps as f64);
                let middle = curve.position(end / 2.0) * 2.0 / steps as f64;
                assert!((middle - 1.0).abs() < 1e-14, "{middle}");
            }
        }
    }

    #[test]
    fn time_is_the_inverse_of_position() {
        for (steps, ramp_s) in [(1, 0.15), (7, 0.05), (-6400, 0.15), (6401, 0.0), (1_000_000_000, 0.1)] {
            let curve = Cosine::new(steps, 0.3, ramp_s);
            let count = curve.halves.count();
            for i in 0..=5000 {
                let target = if i < 100 { 0.5 + f64::from(i) } else { count * f64::from(i) / 5000.0 };
                let target = if target > count { count } else { target };
                let t = curve.time_s(target);
                // Within a cycle of 1 GHz and the rounding of the position.
                let at = |t: f64| libm::fabs(curve.position(t));
                let digits = count * 1e-15;
                assert!(
                    at(t - 1e-9) <= target + digits && at(t + 1e-9) >= target - digits,
                    "{target} of {steps}"
                );
            }
        }
    }
}
