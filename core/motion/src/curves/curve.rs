//! What all motions share: a curve over time, in steps (DESIGN B1).

use crate::{bisection::border, format::grouped};
use alloc::{format, string::String, vec::Vec};

/// The curve of one move: position, speed and acceleration over time since the move's start.
///
/// Times are in s, positions in steps from the move's own start, left negative. Before the start a
/// curve stands at 0, after its end at [`Curve::steps`].
pub trait Curve {
    /// How long the move lasts, in s.
    fn duration_s(&self) -> f64;

    /// Where it ends, in steps from its start.
    fn steps(&self) -> i64;

    /// Position at `t`: B1's rounding of it gives the steps due by `t`, and at the end it is exactly [`Curve::steps`].
    fn position(&self, t: f64) -> f64;

    /// Speed at `t` in steps/s: at the start the first that the move has, at the end the last.
    fn speed(&self, t: f64) -> f64;

    /// Acceleration at `t` in steps/s^2; where the speed jumps it has no value, and none is given.
    fn acceleration(&self, t: f64) -> f64;

    /// Maximum values within the move, without the jumps at its start and its end.
    fn peaks(&self) -> Peaks;

    /// Times in s at which its formula changes, rising: between two of them position, speed and acceleration are smooth
    /// and monotonic. Only the first period of a move that repeats itself is given.
    fn breakpoints_s(&self) -> Vec<f64>;

    /// When a curve that goes one way is at `place`, in s; `place` in steps without sign, above 0 and below all.
    /// Step k is due at k - 1/2 (B1).
    ///
    /// By default a search of sixty positions; a formula that can be solved for the time is quicker.
    fn time_s(&self, place: f64) -> f64 {
        border(0.0, self.duration_s(), |t| libm::fabs(self.position(t)) < place).1
    }

    /// A few words for the user about the move, on a bus with a maximum rate of `limit_steps_s`; may be empty.
    fn detail(&self, _limit_steps_s: f64) -> String {
        self.peaks().to_text()
    }
}

/// The maximum magnitudes of a move or an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Speed in steps/s.
    pub speed: f64,
    /// Acceleration in steps/s^2 where the speed has no jump.
    pub acceleration: f64,
    /// Jump of speed in steps/s: what a motor has to follow at once (its start-stop rate).
    pub jump: f64,
    /// Jerk in steps/s^3 where the acceleration has no jump; 0 where the acceleration only jumps.
    pub jerk: f64,
    /// Jump of acceleration in steps/s^2; there the jerk has no bound. At a jump of speed it is that from
    /// the acceleration before to the one after.
    pub acceleration_jump: f64,
}

impl Peaks {
    /// The greater of both, each by itself.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            speed: greater(self.speed, other.speed),
            acceleration: greater(self.acceleration, other.acceleration),
            jump: greater(self.jump, other.jump),
            jerk: greater(self.jerk, other.jerk),
            acceleration_jump: greater(self.acceleration_jump, other.acceleration_jump),
        }
    }

    /// The maximum speed and acceleration, as people read them.
    #[must_use]
    pub fn to_text(self) -> String {
        format!("peak {} steps/s, {} steps/s\u{b2}", grouped(self.speed), grouped(self.acceleration))
    }
}

/// The greater of two magnitudes.
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

#[cfg(test)]
mod tests {
    use crate::{Curve, curves::trapezoid::Trapezoid};

    #[test]
    fn a_place_is_found_in_a_curve_that_tells_only_its_positions() {
        for steps in [1, -2, 801, -40_000] {
            let curve = Trapezoid::new(steps, 250.0, 4000.0, 9000.0);
            let times = curve.step_times(1_000_000_000).map(|cycle| cycle as f64 * 1e-9);
            let mut before = 0.0;
            for (k, expected) in (1..).zip(times) {
                let found = curve.time_s(f64::from(k) - 0.5);
                assert!((found - expected).abs() <= 1e-9, "step {k} of {steps}: {found}, {expected}");
                assert!(found > before, "step {k} of {steps}: {found} after {before}");
                before = found;
            }
        }
    }
}
