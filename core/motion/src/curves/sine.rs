//! Exact sine (DESIGN B6): each step is due where the cosine crosses its half-integer.
//!
//! It starts at the right extreme; A is the amplitude in whole steps, T the period, d the travel from the last extreme.
//!
//! ```text
//!  0   |'-.          .-'    s(t) = -2*A*sin^2(pi*t/T)       exact where 1 - cos cancels
//!      |   \        /       d    = 2*A*sin^2(pi*t/T)        travel in a half period from its extreme on
//! -2*A |    '-.__.-'        t    = T/pi*asin(sqrt(d/(2*A))) of step k at d = k - 1/2, k = 1..=A
//!      0     T/2     T           and T/2 minus that of the remaining travel, k = A+1..=2*A
//! ```
//!
//! The arcsine is only used up to 45 degrees, so that no digits cancel.

use crate::timing::{
    CycleTime, F106, IsDueBefore, Number, Run, Runs, Schedule, Times, is_mirrored_due_before,
};
use crate::{Curve, Peaks, curves::oscillation::Oscillation, square_root};
use alloc::{boxed::Box, format, rc::Rc, string::String, vec::Vec};
use core::f64::consts::{PI, TAU};

const PERIOD_PARTS: u32 = 128;
const MAX_SAVED: u64 = 65_536;

/// An exact sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    pub(crate) oscillation: Oscillation,
}

impl Sine {
    /// `periods` whole periods of `period_s` > 0 between `amplitude` steps (not 0) on both sides of the middle; a negative
    /// amplitude starts at the left extreme.
    pub fn new(amplitude: i64, period_s: f64, periods: u32) -> Self {
        Self { oscillation: Oscillation::new(amplitude, period_s, periods) }
    }

    fn amplitude(&self) -> f64 {
        self.oscillation.amplitude as f64
    }

    fn angular_speed(&self) -> f64 {
        TAU / self.oscillation.period_s
    }
}

/// Error of a time in f64: 2.5 u of the quotient's root, which the arcsine up to 45 degrees multiplies by up to 4/pi, and its
/// own two. With both products and the sum of half periods it is at most 10 u.
impl Schedule for Sine {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        self.oscillation.duration(clock_hz)
    }

    /// One run per half period. They have the same times from their starts, which are saved, because an arcsine takes 20
    /// times as long.
    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let Oscillation { amplitude, period_s, periods, .. } = self.oscillation;
        let (travel, half_cycles) = (2 * amplitude, period_s / 2.0 * f64::from(clock_hz));
        let max_error = self.max_error_s() * f64::from(clock_hz);
        let saved = if travel <= MAX_SAVED { travel } else { 0 };
        let saved: Rc<[f64]> = (1..=saved).map(|k| part_of_half(k, amplitude)).collect();
        Box::new((0..2 * u64::from(periods)).map(move |half| {
            let (parts, halves, right) = (Rc::clone(&saved), half as f64, self.oscillation.goes_right(half));
            if parts.is_empty() {
                let part = move |step: f64| part_of_half(step as u64 + 1, amplitude);
                return Run::new(travel, right, max_error, move |step| (halves + part(step)) * half_cycles);
            }
            Run {
                count: travel,
                right,
                times: Box::new(SavedTimes { parts, halves, half_cycles, max_error }),
            }
        }))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let travel = 2 * self.oscillation.amplitude;
        let period = self.oscillation.period_cycles(clock_hz);
        let half = period * 0.5;
        Box::new(move |k, since| {
            let since = since - half * F106::from((k - 1) / travel);
            is_mirrored_due_before(((k - 1) % travel + 1, travel), since, half, |time, position| {
                let phase = F106::PI * time / period;
                let sine = phase - phase.minus_its_sine();
                sine * sine * travel as f64 > position.into()
            })
        })
    }
}

struct SavedTimes {
    parts: Rc<[f64]>,
    halves: f64,
    half_cycles: f64,
    max_error: f64,
}

impl Times for SavedTimes {
    fn fill(&mut self, first: f64, times: &mut [f64]) -> f64 {
        for (time, part) in times.iter_mut().zip(self.parts.iter().skip(first as usize)) {
            *time = (self.halves + part) * self.half_cycles;
        }
        self.max_error
    }
}

/// Time of step `k` of the 2*`amplitude` steps of a half period, in half periods.
fn part_of_half(k: u64, amplitude: u64) -> f64 {
    let travel = 2 * amplitude;
    // Twice the distance of the step from the nearer extreme is an integer.
    let from_extreme = |twice: u64| 2.0 / PI * libm::asin(square_root(twice as f64 / (2 * travel) as f64));
    if k <= amplitude { from_extreme(2 * k - 1) } else { 1.0 - from_extreme(2 * (travel - k) + 1) }
}

impl Curve for Sine {
    fn duration_s(&self) -> f64 {
        self.oscillation.duration_s()
    }

    fn steps(&self) -> i64 {
        0
    }

    fn position(&self, t: f64) -> f64 {
        if t <= 0.0 || t >= self.duration_s() {
            return 0.0;
        }
        let sine = libm::sin(PI * self.oscillation.part(t));
        self.oscillation.signed(-2.0 * self.amplitude() * sine * sine)
    }

    fn speed(&self, t: f64) -> f64 {
        if t <= 0.0 || t >= self.duration_s() {
            return 0.0;
        }
        let sine = libm::sin(TAU * self.oscillation.part(t));
        self.oscillation.signed(-self.amplitude() * self.angular_speed() * sine)
    }

    fn acceleration(&self, t: f64) -> f64 {
        let part = if t >= self.duration_s() { 0.0 } else { self.oscillation.part(t) };
        let scale = self.amplitude() * self.angular_speed() * self.angular_speed();
        self.oscillation.signed(-scale * libm::cos(TAU * part))
    }

    fn peaks(&self) -> Peaks {
        let omega = self.angular_speed();
        let speed = self.amplitude() * omega;
        let acceleration = speed * omega;
        Peaks { speed, acceleration, jump: 0.0, jerk: acceleration * omega, acceleration_jump: 0.0 }
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        let part_s = self.oscillation.period_s / f64::from(PERIOD_PARTS);
        (1..=PERIOD_PARTS).map(|part| f64::from(part) * part_s).collect()
    }

    fn detail(&self, _: f64) -> String {
        let hertz = 1.0 / self.oscillation.period_s;
        format!("{hertz:.4} Hz; {}", self.peaks().to_text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half periods until each step of one period.
    fn period(amplitude: i64) -> Vec<f64> {
        let count = amplitude.unsigned_abs();
        let half = || (1..=2 * count).map(move |k| part_of_half(k, count));
        half().chain(half().map(|part| 1.0 + part)).collect()
    }

    #[test]
    fn steps_are_due_where_the_cosine_crosses_half_integers() {
        // One step either side: cos = 1/2 and -1/2, at 60 and 120 degrees.
        for (found, expected) in period(1).into_iter().zip([1.0 / 3.0, 2.0 / 3.0, 4.0 / 3.0, 5.0 / 3.0]) {
            assert!((found - expected).abs() < 1e-15, "{found}");
        }
        // The first step of a large amplitude: cos = 1 - 1/(2*A), so nearly sqrt(1/A).
        for amplitude in [1_000_000, 1_000_000_000_u64] {
            let first = part_of_half(1, amplitude) * PI;
            let x = 1.0 / amplitude as f64;
            let expected = libm::sqrt(x) * (1.0 + x / 24.0 + 3.0 * x * x / 640.0);
            assert!((first / expected - 1.0).abs() < 1e-15, "{amplitude}: {first} {expected}");
        }
    }

    #[test]
    fn half_periods_have_equal_mirrored_steps() {
        for amplitude in [1, 2, 3, 1000, -777] {
            let (sine, travel) = (Sine::new(amplitude, 0.5, 3), 2 * amplitude.unsigned_abs());
            let runs: Vec<Run> = sine.runs(1000).collect();
            assert_eq!(runs.iter().map(|run| run.count).sum::<u64>(), sine.oscillation.step_count());
            for (half, run) in runs.iter().enumerate() {
                assert_eq!((run.count, run.right), (travel, (half % 2 == 1) == (amplitude > 0)));
            }
            let due = period(amplitude);
            assert!(due.is_sorted_by(|a, b| a < b), "{amplitude}");
            for k in 0..travel as usize {
                assert!((due[k] + due[travel as usize - 1 - k] - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn position_is_the_integral_of_speed_and_speed_of_acceleration() {
        for amplitude in [1000.0, -1.0] {
            let sine = Sine::new(amplitude as i64, 0.5, 2);
            for i in 1..500 {
                let t = f64::from(i) * 0.002;
                let slope = |f: &dyn Fn(f64) -> f64| (f(t + 1e-6) - f(t - 1e-6)) / 2e-6;
                let speed = slope(&|t| sine.position(t));
                let acceleration = slope(&|t| sine.speed(t));
                assert!((speed - sine.speed(t)).abs() < 1e-6 * sine.peaks().speed, "{t}");
                assert!(
                    (acceleration - sine.acceleration(t)).abs() < 1e-6 * sine.peaks().acceleration,
                    "{t}"
                );
            }
            assert_eq!((sine.position(0.5), sine.position(1.0), sine.steps()), (0.0, 0.0, 0));
            assert!((sine.position(0.25) + 2.0 * amplitude).abs() < 1e-9);
            let omega = 4.0 * PI;
            assert!((sine.acceleration(0.0) + amplitude * omega * omega).abs() < 1e-6 * omega * omega);
            assert_eq!(sine.acceleration(0.0), sine.acceleration(1.0));
        }
    }
}
