//! Jerk-limited move from rest to rest in seven phases (DESIGN B6): the fastest within a maximum speed V, acceleration A
//! and jerk J.
//!
//! ```text
//!  jerk    |--.   .--.        .--.  .--   +J  0  -J  0  -J  0  +J
//!          |  '-'-|  |--------|  '--'     t_j  time of a jerk phase         J*t_j is at most A
//!  accel.  | .---.                        t_a  constant acceleration, or 0
//!          |/     \__________             t_v  plateau, or 0
//!          |                 \     /      v  = J*t_j*(t_j + t_a)            at most V
//!          |                  '---'       t_r = 2*t_j + t_a                 time of a ramp
//!            t_j t_a t_j t_v t_j t_a t_j  s_r = v*t_r/2                     steps of a ramp
//! ```
//!
//! | limited by | v | t_j |
//! | --- | --- | --- |
//! | speed and acceleration | V | A/J |
//! | speed, below A: no constant acceleration | V | sqrt(V/J) |
//! | acceleration, below V: no plateau | from v*(v/A + A/J) = n | A/J |
//! | distance: jerk phases only | J*t_j^2 | cbrt(n/(2*J)) |
//!
//! The time of a step is a root of the polynomial of its phase, from the end where it is small, so no digits cancel.

use crate::curves::mirrored::{Mirrored, MirroredCurve};
use crate::timing::{
    CycleTime, F106, IsDueBefore, Number, Runs, Schedule, is_mirrored_due_before, one_searched_run,
};
use crate::{Peaks, format::grouped, square_root};
use alloc::{boxed::Box, format, string::String, vec::Vec};

/// Maximum steps of Newton's method; six are enough.
const MAX_NEWTON_STEPS: u32 = 12;
/// Number of intervals of a phase of constant jerk, in which the speed is curved.
const JERK_PARTS: u32 = 16;

/// Maximum speed in steps/s, acceleration in steps/s^2 and jerk in steps/s^3 of a move, each above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits<N = f64> {
    pub speed: N,
    pub acceleration: N,
    pub jerk: N,
}

/// A jerk-limited move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JerkLimited {
    halves: Mirrored,
    phases: Phases<f64>,
    limits: Limits<F106>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Phases<N> {
    jerk: N,
    jerk_s: N,
    constant_s: N,
    /// v, the maximum speed of the move.
    peak_speed: N,
    ramp_s: N,
    /// s_r, at most half of the steps.
    ramp_steps: N,
    duration_s: N,
}

impl<N: Number> Phases<N> {
    fn new(steps: i64, Limits { speed, acceleration, jerk }: Limits<N>) -> Self {
        let distance = N::from(steps.unsigned_abs() as f64);
        // A ramp to the maximum speed, with constant acceleration if the maximum acceleration is reached first.
        let full_jerk_s = acceleration / jerk;
        let (jerk_s, constant_s) = if speed > acceleration * full_jerk_s {
            (full_jerk_s, (speed / acceleration - full_jerk_s).or_zero())
        } else {
            ((speed / jerk).square_root(), 0.0.into())
        };
        let ramp_s = jerk_s * 2.0 + constant_s;
        let ramp_steps = speed * ramp_s * 0.5;
        if ramp_steps * 2.0 <= distance {
            let duration_s = distance / speed + ramp_s;
            return Self { jerk, jerk_s, constant_s, peak_speed: speed, ramp_s, ramp_steps, duration_s };
        }
        let (jerk_s, constant_s, peak_speed) = if distance > acceleration * 2.0 * full_jerk_s * full_jerk_s {
            // v*(v/A + t_j) = n, solved without cancellation.
            let root = (full_jerk_s * full_jerk_s + distance * 4.0 / acceleration).square_root();
            let peak_speed = distance * 2.0 / (full_jerk_s + root);
            (full_jerk_s, (peak_speed / acceleration - full_jerk_s).or_zero(), peak_speed)
        } else {
            let jerk_s = (distance / (jerk * 2.0)).cube_root();
            (jerk_s, 0.0.into(), jerk * jerk_s * jerk_s)
        };
        let ramp_s = jerk_s * 2.0 + constant_s;
        Self {
            jerk,
            jerk_s,
            constant_s,
            peak_speed,
            ramp_s,
            ramp_steps: distance * 0.5,
            duration_s: ramp_s * 2.0,
        }
    }

    /// J*t_j, the maximum acceleration of the move.
    fn peak_acceleration(&self) -> N {
        self.jerk * self.jerk_s
    }

    fn phase_ends_s(&self) -> [N; 3] {
        [self.jerk_s, self.jerk_s + self.constant_s, self.ramp_s]
    }

    fn first_phase_steps(&self) -> N {
        self.jerk * self.jerk_s * self.jerk_s * self.jerk_s / 6.0
    }

    fn first_phase_speed(&self) -> N {
        self.jerk * self.jerk_s * self.jerk_s * 0.5
    }

    fn position(&self, t: N) -> N {
        let [jerk_end, constant_end, ramp_end] = self.phase_ends_s();
        if t < jerk_end {
            self.jerk * t * t * t / 6.0
        } else if t < constant_end {
            let x = t - jerk_end;
            self.first_phase_steps() + (self.first_phase_speed() + self.peak_acceleration() * x * 0.5) * x
        } else if t < ramp_end {
            self.ramp_steps - self.travel_left(ramp_end - t)
        } else {
            self.ramp_steps + self.peak_speed * (t - ramp_end)
        }
    }

    /// Travel in the last `left_s` of a ramp, within its last phase.
    fn travel_left(&self, left_s: N) -> N {
        (self.peak_speed - self.jerk * left_s * left_s / 6.0) * left_s
    }
}

impl JerkLimited {
    /// `steps` (left negative, not 0) from rest to rest.
    pub fn new(steps: i64, limits: Limits) -> Self {
        let [speed, acceleration, jerk] = [limits.speed, limits.acceleration, limits.jerk].map(F106::decimal);
        Self::from_exact(steps, Limits { speed, acceleration, jerk })
    }

    pub(crate) fn from_exact(steps: i64, limits: Limits<F106>) -> Self {
        let [speed, acceleration, jerk] =
            [limits.speed, limits.acceleration, limits.jerk].map(|number| number.high);
        let phases = Phases::new(steps, Limits { speed, acceleration, jerk });
        Self { halves: Mirrored { steps, duration_s: phases.duration_s }, phases, limits }
    }

    /// Maximum speed of the move in steps/s.
    pub fn peak_speed(&self) -> f64 {
        self.phases.peak_speed
    }

    /// Durations in s of jerk, constant acceleration, jerk and plateau; the other three phases mirror the first three.
    pub fn phases_s(&self) -> [f64; 4] {
        let Phases { jerk_s, constant_s, ramp_s, duration_s, .. } = self.phases;
        [jerk_s, constant_s, jerk_s, (duration_s - 2.0 * ramp_s).or_zero()]
    }

    pub(crate) fn changes(&self) -> Vec<f64> {
        let last = self.phases.ramp_steps - self.phases.travel_left(self.phases.jerk_s);
        self.halves.changes(&[self.phases.first_phase_steps(), last, self.phases.ramp_steps])
    }
}

/// Error of a time in f64: 6 u of each earlier phase, and a third of 14 u of the steps that are left at the end of a phase.
/// With the root, the difference from the end and the product with the clock it is below 48 u.
impl Schedule for JerkLimited {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::of(Phases::new(self.halves.steps, self.limits).duration_s * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        one_searched_run(self, clock_hz, self.changes())
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let (phases, count) = (Phases::new(self.halves.steps, self.limits), self.halves.steps.unsigned_abs());
        Box::new(move |k, since| {
            is_mirrored_due_before(
                (k, count),
                since / f64::from(clock_hz),
                phases.duration_s,
                |t, position| phases.position(t) > position.into(),
            )
        })
    }
}

impl MirroredCurve for JerkLimited {
    fn halves(&self) -> &Mirrored {
        &self.halves
    }

    fn half_position(&self, t: f64) -> f64 {
        self.phases.position(t)
    }

    fn half_speed(&self, t: f64) -> f64 {
        let [jerk_end, constant_end, ramp_end] = self.phases.phase_ends_s();
        if t < jerk_end {
            self.phases.jerk * t * t / 2.0
        } else if t < constant_end {
            self.phases.first_phase_speed() + self.phases.peak_acceleration() * (t - jerk_end)
        } else if t < ramp_end {
            self.phases.peak_speed - self.phases.jerk * (ramp_end - t) * (ramp_end - t) / 2.0
        } else {
            self.phases.peak_speed
        }
    }

    fn half_acceleration(&self, t: f64) -> Option<f64> {
        let [jerk_end, constant_end, ramp_end] = self.phases.phase_ends_s();
        Some(if t < jerk_end {
            self.phases.jerk * t
        } else if t < constant_end {
            self.phases.peak_acceleration()
        } else if t < ramp_end {
            self.phases.jerk * (ramp_end - t)
        } else {
            0.0
        })
    }

    fn half_time_s(&self, position: f64) -> f64 {
        let Phases { jerk, jerk_s, peak_speed, ramp_s, ramp_steps, .. } = self.phases;
        let past_first = position - self.phases.first_phase_steps();
        if past_first <= 0.0 {
            return libm::cbrt(6.0 * position / jerk);
        }
        let steps_left = ramp_steps - position;
        if steps_left <= 0.0 {
            return ramp_s - steps_left / peak_speed;
        }
        if steps_left > self.phases.travel_left(jerk_s) {
            let (speed, acceleration) = (self.phases.first_phase_speed(), self.phases.peak_acceleration());
            let root = square_root(speed * speed + 2.0 * acceleration * past_first);
            return jerk_s + 2.0 * past_first / (speed + root);
        }
        // v*u - J*u^3/6 rises and is concave up to t_j, with a slope above v/2: Newton's method approaches the root from
        // below and never passes it.
        let mut u = steps_left / peak_speed;
        for _ in 0..MAX_NEWTON_STEPS {
            let slope = peak_speed - jerk * u * u / 2.0;
            let correction = (steps_left - self.phases.travel_left(u)) / slope;
            u += correction;
            if correction <= u * f64::EPSILON {
                break;
            }
        }
        ramp_s - u
    }

    fn all_peaks(&self) -> Peaks {
        Peaks {
            speed: self.phases.peak_speed,
            acceleration: self.phases.peak_acceleration(),
            jerk: self.phases.jerk,
            ..Peaks::default()
        }
    }

    fn half_breakpoints_s(&self) -> Vec<f64> {
        let [jerk_end_s, constant_end_s, ramp_end_s] = self.phases.phase_ends_s();
        let parts = |from_s: f64, to_s: f64| {
            (1..=JERK_PARTS)
                .map(move |part| from_s + (to_s - from_s) * f64::from(part) / f64::from(JERK_PARTS))
        };
        parts(0.0, jerk_end_s).chain([constant_end_s]).chain(parts(constant_end_s, ramp_end_s)).collect()
    }

    fn text(&self, _: f64) -> String {
        let phases: Vec<String> = self.phases_s().iter().map(|phase_s| format!("{phase_s:.4}")).collect();
        format!(
            "{}, {} steps/s\u{b3}; phases of {} s, then mirrored",
            self.all_peaks().to_text(),
            grouped(self.phases.jerk),
            phases.join(", ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Curve, moves};

    fn curve(steps: i64, speed: f64, acceleration: f64, jerk: f64) -> JerkLimited {
        JerkLimited::new(steps, Limits { speed, acceleration, jerk })
    }

    /// One move for each row of the module's table, one for each limit between them, and extremes.
    const MOVES: [(i64, f64, f64, f64); 9] = [
        (10_000, 4000.0, 20_000.0, 400_000.0),
        (10_000, 1000.0, 20_000.0, 100_000.0),
        (600, 4000.0, 20_000.0, 400_000.0),
        (50, 4000.0, 20_000.0, 400_000.0),
        (1000, 4000.0, 20_000.0, 400_000.0),
        (100, 4000.0, 20_000.0, 400_000.0),
        (-10_000, 1000.0, 10_000.0, 100_000.0),
        (1, 1e7, 1e13, 1e-6),
        (-1_000_000_000, 1e7, 1e-6, 1e19),
    ];

    #[test]
    fn refuses_a_limit_out_of_range_with_its_path() {
        use crate::mechanics::{Acceleration, Distance, Jerk, Speed};
        let speed = Speed::StepsPerSecond;
        let (acceleration, jerk) = (Acceleration::StepsPerSecond2, Jerk::StepsPerSecond3);
        let valid = moves::JerkLimited::default;
        let rows = [
            (moves::JerkLimited { distance: Distance::Steps(0.0), ..valid() }, "distance"),
            (moves::JerkLimited { max_speed: speed(0.0), ..valid() }, "max_speed"),
            (moves::JerkLimited { max_acceleration: acceleration(1e14), ..valid() }, "max_acceleration"),
            (moves::JerkLimited { max_jerk: jerk(0.0), ..valid() }, "max_jerk"),
            (moves::JerkLimited { max_jerk: jerk(1e20), ..valid() }, "max_jerk"),
        ];
        for (given, field) in rows {
            let axis = moves::Axis { moves: vec![moves::Move::JerkLimited(given)], ..Default::default() };
            let problems = crate::plan_axis(&axis, "x").expect_err(field);
            let paths: Vec<&str> = problems.iter().map(|problem| problem.path.as_str()).collect();
            assert_eq!(paths, [format!("x.moves[0].jerk_limited.{field}")]);
        }
    }

    #[test]
    fn has_the_phases_of_each_row_of_the_table() {
        // Phases in s, peak speed.
        let rows = [
            ([0.05, 0.15, 0.05, 2.25], 4000.0),
            ([0.1, 0.0, 0.1, 9.8], 1000.0),
            ([0.05, 0.100_000_0, 0.05, 0.0], 3000.0),
            ([0.039_685_0, 0.0, 0.039_685_0, 0.0], 629.960_52),
            ([0.05, 0.15, 0.05, 0.0], 4000.0),
            ([0.05, 0.0, 0.05, 0.0], 1000.0),
            ([0.1, 0.0, 0.1, 9.8], 1000.0),
        ];
        for ((steps, speed, acceleration, jerk), (phases_s, peak)) in MOVES.into_iter().zip(rows) {
            let made = curve(steps, speed, acceleration, jerk);
            for (found, expected) in made.phases_s().into_iter().zip(phases_s) {
                assert!((found - expected).abs() < 1e-7, "{steps}: {found} {expected}");
            }
            assert!((made.peak_speed() - peak).abs() < 1e-4, "{steps}: {}", made.peak_speed());
            assert_eq!(made.position(made.duration_s()), steps as f64);
        }
    }

    #[test]
    fn reaches_one_limit_in_each_phase_and_exceeds_none() {
        for (steps, speed, acceleration, jerk) in MOVES {
            let made = curve(steps, speed, acceleration, jerk);
            let (peaks, tolerance) = (made.peaks(), 1.0 + 1e-12);
            assert!(
                peaks.speed <= speed * tolerance && peaks.acceleration <= acceleration * tolerance,
                "{steps}"
            );
            assert_eq!(peaks.jerk, jerk);
            let [jerk_end, constant_end, _] = made.phases.phase_ends_s();
            assert!(
                constant_end <= jerk_end || (peaks.acceleration / acceleration - 1.0).abs() < 1e-12,
                "{steps}"
            );
            assert!(made.phases_s()[3] <= 0.0 || peaks.speed == speed, "{steps}");
        }
    }

    #[test]
    fn position_is_the_integral_of_speed_and_speed_of_acceleration() {
        for (steps, speed, acceleration, jerk) in MOVES.into_iter().take(7) {
            let made = curve(steps, speed, acceleration, jerk);
            let (slots, end) = (40_000, made.duration_s());
            let dt = end / f64::from(slots);
            let (mut at, mut rate) = (0.0, 0.0);
            for slot in 0..slots {
                let middle = (f64::from(slot) + 0.5) * dt;
                at += made.speed(middle) * dt;
                rate += made.acceleration(middle) * dt;
                let t = f64::from(slot + 1) * dt;
                assert!((at - made.position(t)).abs() < 1e-4 * (1.0 + at.abs()), "{steps} at {t}");
                assert!((rate - made.speed(t)).abs() < 1e-2 * made.peak_speed(), "{steps} at {t}");
            }
        }
    }

    #[test]
    fn time_is_the_inverse_of_position() {
        for (steps, speed, acceleration, jerk) in MOVES {
            let made = curve(steps, speed, acceleration, jerk);
            let count = steps.unsigned_abs() as f64;
            let mut before = (0.0, 0.0);
            for i in 0..=4000 {
                let target = if i < 100 { 0.5 + f64::from(i) } else { count * f64::from(i) / 4000.0 };
                if target > count {
                    continue;
                }
                let t = made.time_s(target);
                let off = (made.position(t).abs() - target).abs();
                // The rounding of the position, and that of the time times the speed.
                assert!(off <= 4e-15 * (count + made.peak_speed() * t), "{target} of {steps}: {off} off");
                assert!(target < before.0 || t >= before.1, "{target} of {steps}");
                before = (target, t);
            }
        }
    }
}
