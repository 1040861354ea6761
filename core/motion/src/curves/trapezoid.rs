//! Trapezoid with each step where the ideal curve crosses its half-integer (DESIGN B1, B2).
//!
//! Uniform acceleration a from the start speed v0 to the top speed v1 and back, v^2 = v0^2 + 2*a*s; a short move is a
//! triangle:
//!
//! ```text
//!  v1 |     ________               t_r = (v1 - v0)/a         time of a ramp
//!     |   /          \             s_r = (v1^2 - v0^2)/(2a)  steps of a ramp
//!  v0 | /              \           s(t) = v0*t + a*t^2/2     in the ramp
//!     |                                 = s_r + v1*(t - t_r) in the plateau
//!     +------------------              = n - s(T - t)        from T/2 on
//!       t_r        T-t_r  T
//! ```

use crate::curves::mirrored::{Mirrored, MirroredCurve};
use crate::timing::{
    CycleTime, F106, IsDueBefore, MoveSteps, Number, Runs, Schedule, is_mirrored_due_before, one_run,
};
use crate::{Curve, Peaks};
use alloc::{boxed::Box, vec::Vec};

/// A trapezoid with exact step times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    halves: Mirrored,
    half: Half<f64>,
    limits: Limits<F106>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits<N> {
    pub(crate) start_speed: N,
    pub(crate) top_speed: N,
    pub(crate) acceleration: N,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Half<N> {
    start_speed: N,
    acceleration: N,
    /// The top speed, or the maximum speed of a triangle.
    peak_speed: N,
    ramp_steps: N,
    ramp_s: N,
    duration_s: N,
}

impl<N: Number> Half<N> {
    fn new(steps: i64, limits: Limits<N>) -> Self {
        let Limits { start_speed: v0, top_speed: v1, acceleration } = limits;
        let distance = N::from(steps.unsigned_abs() as f64);
        // (v1 - v0)*(v1 + v0) does not cancel like v1^2 - v0^2.
        let whole_ramp = (v1 - v0) * (v1 + v0) / (acceleration * 2.0);
        let (peak_speed, ramp_steps) = if whole_ramp * 2.0 <= distance {
            (v1, whole_ramp)
        } else {
            ((v0 * v0 + acceleration * distance).square_root(), distance * 0.5)
        };
        // s = (v0 + v)/2 * t, without cancellation.
        let ramp_s = ramp_steps * 2.0 / (v0 + peak_speed);
        let duration_s = ramp_s * 2.0 + (distance - ramp_steps * 2.0) / peak_speed;
        Self { start_speed: v0, acceleration, peak_speed, ramp_steps, ramp_s, duration_s }
    }

    fn position(&self, t: N) -> N {
        if t < self.ramp_s {
            (self.start_speed + self.acceleration * t * 0.5) * t
        } else {
            self.ramp_steps + self.peak_speed * (t - self.ramp_s)
        }
    }
}

impl Trapezoid {
    /// `steps` (left negative) from `start_speed` >= 0 to `top_speed` >= `start_speed` and back with `acceleration` > 0,
    /// in steps and s. The top speed is above 0.
    pub fn new(steps: i64, start_speed: f64, top_speed: f64, acceleration: f64) -> Self {
        let [start_speed, top_speed, acceleration] =
            [start_speed, top_speed, acceleration].map(F106::decimal);
        Self::from_exact(steps, Limits { start_speed, top_speed, acceleration })
    }

    pub(crate) fn from_exact(steps: i64, limits: Limits<F106>) -> Self {
        let Limits { start_speed, top_speed, acceleration } = limits;
        let [start_speed, top_speed, acceleration] =
            [start_speed, top_speed, acceleration].map(|number| number.high);
        let half = Half::new(steps, Limits { start_speed, top_speed, acceleration });
        Self { halves: Mirrored { steps, duration_s: half.duration_s }, half, limits }
    }

    /// Maximum speed of the move in steps/s.
    pub fn peak_speed(&self) -> f64 {
        self.half.peak_speed
    }

    pub fn ramp_s(&self) -> f64 {
        self.half.ramp_s
    }

    /// Steps of each ramp, not rounded.
    pub fn ramp_steps(&self) -> f64 {
        self.half.ramp_steps
    }

    /// The cycle of each step at `clock_hz`, from the start of the move.
    pub fn step_times(&self, clock_hz: u32) -> impl Iterator<Item = u64> + '_ {
        MoveSteps::new(self, CycleTime::default(), clock_hz).map(|(_, step)| step.cycle)
    }

    fn exact(&self) -> Half<F106> {
        Half::new(self.halves.steps, self.limits)
    }
}

impl Schedule for Trapezoid {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::of(self.exact().duration_s * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let clock = f64::from(clock_hz);
        one_run(self, clock_hz, move |step| self.time_s(step + 0.5) * clock)
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let (half, count) = (self.exact(), self.halves.steps.unsigned_abs());
        Box::new(move |k, since| {
            is_mirrored_due_before((k, count), since / f64::from(clock_hz), half.duration_s, |t, position| {
                half.position(t) > position.into()
            })
        })
    }
}

impl MirroredCurve for Trapezoid {
    fn halves(&self) -> &Mirrored {
        &self.halves
    }

    fn half_position(&self, t: f64) -> f64 {
        self.half.position(t)
    }

    fn half_speed(&self, t: f64) -> f64 {
        let climbed = self.half.start_speed + self.half.acceleration * t;
        if t < self.half.ramp_s { climbed } else { self.half.peak_speed }
    }

    fn half_acceleration(&self, t: f64) -> Option<f64> {
        (t < self.half.ramp_s).then_some(self.half.acceleration)
    }

    /// t = 2*s/(v0 + v), which does not cancel like (v - v0)/a.
    fn half_time_s(&self, position: f64) -> f64 {
        let Half { start_speed, acceleration, peak_speed, ramp_steps, ramp_s, .. } = self.half;
        if position < ramp_steps {
            let speed = (start_speed * start_speed + 2.0 * acceleration * position).square_root();
            2.0 * position / (start_speed + speed)
        } else {
            ramp_s + (position - ramp_steps) / peak_speed
        }
    }

    fn all_peaks(&self) -> Peaks {
        let acceleration = if self.half.ramp_s > 0.0 { self.half.acceleration } else { 0.0 };
        // At the tip of a triangle the acceleration is reversed.
        let is_triangle = 2.0 * self.half.ramp_s >= self.halves.duration_s;
        let acceleration_jump = if is_triangle { 2.0 * acceleration } else { acceleration };
        Peaks { speed: self.half.peak_speed, acceleration, acceleration_jump, ..Peaks::default() }
    }

    fn half_breakpoints_s(&self) -> Vec<f64> {
        Vec::from([self.half.ramp_s])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_moves_have_a_plateau_and_short_moves_are_triangles() {
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
    fn squared_speed_is_linear_in_the_travel() {
        let curve = Trapezoid::new(4000, 300.0, 4000.0, 9000.0);
        for i in 0..100 {
            let t = curve.ramp_s() * f64::from(i) / 100.0;
            let (v, s) = (curve.speed(t), curve.position(t));
            assert!((v * v - (300.0 * 300.0 + 2.0 * 9000.0 * s)).abs() < 1e-6 * v * v);
            let mirrored = 4000.0 - curve.position(curve.duration_s() - t);
            assert!((mirrored - s).abs() < 1e-9, "{t}: {s} {mirrored}");
        }
    }

    #[test]
    fn a_move_that_starts_at_its_top_speed_has_no_acceleration() {
        let flat = Trapezoid::new(500, 1000.0, 1000.0, 8000.0);
        assert_eq!(flat.peaks(), Peaks { speed: 1000.0, ..Peaks::default() });
        // The acceleration jumps once per end of a ramp, at the tip of a triangle twice as far.
        for (steps, speed, jump) in [(10_000, 5000.0, 8000.0), (2500, 4_472.135_955, 16_000.0)] {
            let peaks = Trapezoid::new(steps, 0.0, 5000.0, 8000.0).peaks();
            assert!((peaks.speed - speed).abs() < 1e-6, "{peaks:?}");
            assert_eq!((peaks.acceleration, peaks.acceleration_jump), (8000.0, jump), "{steps}");
        }
    }
}
