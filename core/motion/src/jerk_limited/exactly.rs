//! The jerk-limited move in 106 bits (DESIGN B1, B6): its phases as the table of [`super`] has them, and where it is at a
//! time.

use super::{ExactLimits, JerkLimited};
use crate::{crossing::is_due_before, double::Double};

/// The first half, of times in s.
#[derive(Clone, Copy)]
struct Exactly {
    jerk: Double,
    /// t_j.
    jerk_s: Double,
    /// t_a.
    steady_s: Double,
    peak_speed: Double,
    ramp_steps: Double,
    duration_s: Double,
}

impl Exactly {
    fn ramp_s(&self) -> Double {
        self.jerk_s * 2.0.into() + self.steady_s
    }

    /// Whether the first half is past `place` at `t`.
    fn is_past(&self, t: Double, place: f64) -> bool {
        let Self { jerk, jerk_s, steady_s, peak_speed, ramp_steps, .. } = *self;
        let (half, sixth, left_s) = (Double::from(0.5), jerk / 6.0.into(), self.ramp_s() - t);
        let travelled = if jerk_s.exceeds(t) {
            sixth * t * t * t
        } else if (jerk_s + steady_s).exceeds(t) {
            let (x, acceleration) = (t - jerk_s, jerk * jerk_s);
            sixth * jerk_s * jerk_s * jerk_s + acceleration * half * (jerk_s + x) * x
        } else if left_s.is_positive() {
            ramp_steps - (peak_speed - sixth * left_s * left_s) * left_s
        } else {
            ramp_steps - peak_speed * left_s
        };
        travelled.exceeds(place.into())
    }
}

impl JerkLimited {
    fn exactly(&self) -> Exactly {
        let ExactLimits { speed, acceleration, jerk } = self.limits;
        let (count, two) = (Double::from(self.halves.steps.unsigned_abs()), Double::from(2.0));
        let at_rest = Double::default();
        let full_jerk_s = acceleration / jerk;
        let steady_s = |peak_speed: Double| {
            let steady_s = peak_speed / acceleration - full_jerk_s;
            if steady_s.is_positive() { steady_s } else { at_rest }
        };
        let (jerk_s, to_top_s) = if speed.exceeds(acceleration * full_jerk_s) {
            (full_jerk_s, steady_s(speed))
        } else {
            ((speed / jerk).square_root(), at_rest)
        };
        let ramp_s = jerk_s * two + to_top_s;
        let ramp_steps = speed * ramp_s / two;
        if !(ramp_steps * two).exceeds(count) {
            let duration_s = count / speed + ramp_s;
            return Exactly { jerk, jerk_s, steady_s: to_top_s, peak_speed: speed, ramp_steps, duration_s };
        }
        // No plateau: the two ramps are the whole travel.
        let (jerk_s, steady_s, peak_speed) = if count.exceeds(acceleration * full_jerk_s * full_jerk_s * two)
        {
            let root = (full_jerk_s * full_jerk_s + count * 4.0.into() / acceleration).square_root();
            let peak_speed = count * two / (full_jerk_s + root);
            (full_jerk_s, steady_s(peak_speed), peak_speed)
        } else {
            let jerk_s = (count / (jerk * two)).cube_root();
            (jerk_s, at_rest, jerk * jerk_s * jerk_s)
        };
        let duration_s = jerk_s * 4.0.into() + steady_s * two;
        Exactly { jerk, jerk_s, steady_s, peak_speed, ramp_steps: count / two, duration_s }
    }

    /// How long it lasts in s.
    pub(crate) fn exact_duration(&self) -> Double {
        self.exactly().duration_s
    }

    /// Whether step `k` (from 1) falls due before a time in cycles of a clock of `clock_hz`, for certain.
    ///
    /// Of a time in f64 the phases before it have at most 6 u each of theirs, and what is left of the way at the joint
    /// before or after it 14 u of its steps, which the speed there makes a third as much of the time. With the root, cube
    /// root or Newton's end, the difference from the end and the product with the clock, it is off by less than 48 u.
    pub(crate) fn is_due_before(&self, clock_hz: u32) -> impl Fn(u64, Double) -> bool + use<> {
        let (curve, count) = (self.exactly(), self.halves.steps.unsigned_abs());
        let clock = Double::from(u64::from(clock_hz));
        move |k, since| {
            is_due_before((k, count), since / clock, curve.duration_s, |t, place| curve.is_past(t, place))
        }
    }
}
