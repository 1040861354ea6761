//! The curve of a move: position, speed and acceleration over time, in steps (DESIGN B1).

use crate::{bisection::border, format::grouped};
use alloc::{format, string::String, vec::Vec};

/// The curve of one move. Times are in s from its start, positions in steps, left negative. Before its start and after its
/// end the position is that of the start and of the end: 0 and [`Curve::steps`], or up to half a step from them if a move
/// begins or ends between two steps.
pub trait Curve {
    fn duration_s(&self) -> f64;

    /// Position at the end, in whole steps.
    fn steps(&self) -> i64;

    /// Position at `t`. Rounded half up it is the number of steps due by `t`.
    fn position(&self, t: f64) -> f64;

    /// Speed at `t` in steps/s: at the start the first of the move, at the end the last.
    fn speed(&self, t: f64) -> f64;

    /// Acceleration at `t` in steps/s^2, without the jumps of the speed; 0 by default, for constant rates.
    fn acceleration(&self, _t: f64) -> f64 {
        0.0
    }

    /// Maxima within the move, without the jumps at its start and end.
    fn peaks(&self) -> Peaks;

    /// Rising times in s at which the formula changes: between them position, speed and acceleration are smooth and
    /// monotonic. The end of the move may be the last one. An oscillation has only the times in its first period.
    fn breakpoints_s(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Time in s at which a curve without reversals is at `position`, in steps without sign, between start and end. The
    /// default bisects; a formula that can be solved for the time is faster.
    fn time_s(&self, position: f64) -> f64 {
        border(0.0, self.duration_s(), |t| libm::fabs(self.position(t)) < position).1
    }

    /// A short description of the move on a bus with a maximum rate of `limit_steps_s`; may be empty.
    fn detail(&self, _limit_steps_s: f64) -> String {
        self.peaks().to_text()
    }
}

/// Maximum magnitudes of a move or an axis, in steps and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    pub speed: f64,
    /// Without the jumps of the speed.
    pub acceleration: f64,
    /// Jump of the speed; a motor must start or stop at this rate.
    pub jump: f64,
    /// Without the jumps of the acceleration.
    pub jerk: f64,
    /// Jump of the acceleration, which makes the jerk infinite.
    pub acceleration_jump: f64,
}

impl Peaks {
    /// Peaks of consecutive constant rates, the first of which follows `before`.
    pub(crate) fn of_rates(mut before: Option<f64>, rates: impl Iterator<Item = f64>) -> Self {
        rates.fold(Self::default(), |peaks, speed| {
            let jump = before.replace(speed).map_or(0.0, |before| libm::fabs(speed - before));
            peaks.max(Self { speed, jump, ..Self::default() })
        })
    }

    pub fn max(self, other: Self) -> Self {
        Self {
            speed: greater(self.speed, other.speed),
            acceleration: greater(self.acceleration, other.acceleration),
            jump: greater(self.jump, other.jump),
            jerk: greater(self.jerk, other.jerk),
            acceleration_jump: greater(self.acceleration_jump, other.acceleration_jump),
        }
    }

    /// Maximum speed and acceleration as a text.
    pub fn to_text(self) -> String {
        format!("peak {} steps/s, {} steps/s\u{b2}", grouped(self.speed), grouped(self.acceleration))
    }
}

pub(crate) fn signed(steps: i64, magnitude: f64) -> f64 {
    if steps < 0 { -magnitude } else { magnitude }
}

/// Position at which step `index` (from 0) between two whole positions is due.
pub(crate) fn due_position(from: i64, to: i64, index: f64) -> f64 {
    from as f64 + if to > from { index + 0.5 } else { -0.5 - index }
}

/// The greater of two numbers by one comparison, because the bits of `libm`'s maximum differ for NaN and -0.
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

#[cfg(test)]
mod tests {
    use crate::{Curve, curves::trapezoid::Trapezoid};

    #[test]
    fn finds_a_time_by_bisection() {
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
