//! Exact sine (DESIGN B6): every step where the cosine crosses its half-integer (B1).
//!
//! It starts at the right extreme, goes left to the other one and comes back, as the sine by segments
//! does; with the amplitude A in whole steps, the period T and the travel d from the extreme behind it:
//!
//! ```text
//!  0   |'-.          .-'    s(t) = -2*A*sin^2(pi*t/T)       keeps its digits where 1 - cos loses them
//!      |   \        /       d    = 2*A*sin^2(pi*t/T)        of the half period from its extreme on
//! -2*A |    '-.__.-'        t    = T/pi*asin(sqrt(d/(2*A))) of step k at d = k - 1/2, k = 1..=A
//!      0     T/2     T           and T/2 less that of the travel that is left, k = A+1..=2*A
//! ```
//!
//! So no step's time is a small difference of large numbers: the arc sine is taken up to 45 degrees
//! alone, and the half periods before are added to it as a whole number, whatever their count.
//!
//! ```
//! use stepscope_motion::{Curve, sine::Sine};
//!
//! // An amplitude of 100 steps, 0.5 s a period: it starts at the right extreme, which counts as 0.
//! let sine = Sine::new(100, 0.5, 2);
//! assert_eq!((sine.duration_s(), sine.step_count(), sine.steps()), (1.0, 800, 0));
//! assert_eq!(sine.position(0.25), -200.0);
//! ```

use crate::{
    Curve, Peaks,
    budget::hold_speed,
    crossing::is_due_before,
    double::{self, Double},
    exact::Exact,
    limits, moves,
    oscillation::{Oscillation, Runs},
    quantities::Quantities,
    square_root,
};
use alloc::{format, string::String, vec::Vec};
use core::f64::consts::{PI, TAU};

/// Parts that a period is cut into; its extremes and its middle are breakpoints.
const PERIOD_PARTS: u32 = 128;
/// Steps of a half period whose places in it are kept for the next ones, at most.
const MAX_KEPT_PARTS: u64 = 65_536;
/// Maximum number of a quarter's steps whose exact times are saved: 24 MB.
const MAX_SAVED: u64 = 1 << 20;

/// A sine, each step in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    pub(super) oscillation: Oscillation,
}

impl Sine {
    /// `periods` whole periods of `period_s` > 0 between `amplitude` steps (not 0) on either side of
    /// the middle; a negative amplitude starts at the left extreme.
    #[must_use]
    pub fn new(amplitude: i64, period_s: f64, periods: u32) -> Self {
        Self { oscillation: Oscillation::new(amplitude, period_s, periods) }
    }

    /// From what is asked.
    pub(super) fn plan(quantities: &mut Quantities<'_>, given: &moves::Sine) -> Option<Self> {
        let amplitude = quantities.distance("amplitude", &given.amplitude);
        let period_s = quantities.duration("period_s", given.period_s);
        quantities.range("periods", given.periods.into(), limits::PERIODS, "")?;
        let curve = Self::new(amplitude?, period_s?, given.periods);
        hold_speed(quantities, "period_s", curve.peaks().speed)?;
        Some(curve)
    }

    /// Time of a period in s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.oscillation.period_s
    }

    /// How many periods.
    #[must_use]
    pub fn periods(&self) -> u32 {
        self.oscillation.periods
    }

    /// Steps of all periods, there and back: 4*A a period.
    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.oscillation.step_count()
    }

    /// When each step falls due from the start, in what there are `per_half` of in half a period, and whether it goes to the
    /// right.
    pub(super) fn due_halves(&self, per_half: f64) -> DueHalves {
        let oscillation = self.oscillation;
        let Oscillation { amplitude, periods, .. } = oscillation;
        let (travel, halves) = (2 * amplitude, if amplitude > 0 { 2 * u64::from(periods) } else { 0 });
        let kept = if travel <= MAX_KEPT_PARTS { travel } else { 0 };
        let parts = (1..=kept).map(|k| part_of_half(k, amplitude)).collect();
        DueHalves { oscillation, per_half, halves, parts, half: 0, past: 0 }
    }

    /// When step `k` (from 1) of all falls due, in half periods from the start.
    pub(super) fn due_half(&self, k: u64) -> f64 {
        let of_half = 2 * self.oscillation.amplitude;
        ((k - 1) / of_half) as f64 + part_of_half((k - 1) % of_half + 1, self.oscillation.amplitude)
    }

    /// Whether step `k` (from 1) of all falls due before a time in cycles of a clock of `clock_hz`, for certain: in its
    /// half period the travel from the nearer extreme is 2*A*sin^2(pi*t/T).
    ///
    /// Of a time in f64 ([`Self::due_halves`]) the quotient has one rounding u, its root one and a half, which the arc
    /// sine up to 45 degrees makes at most 4/pi times as much; with its own two, the product with 2/pi, the sum of the
    /// half periods and the product with their cycles, which are three, it is off by at most 10 u.
    pub(super) fn is_due_before(&self, clock_hz: u32) -> impl Fn(u64, Double) -> bool + use<> {
        let travel = 2 * self.oscillation.amplitude;
        let period = Exact::of(self.oscillation.period_s).times(clock_hz.into()).double();
        let half = period * 0.5.into();
        move |k, since| {
            let since = since - half * Double::from((k - 1) / travel);
            is_due_before(((k - 1) % travel + 1, travel), since, half, |time, place| {
                let phase = double::PI * time / period;
                let sine = phase - phase.less_its_sine();
                (Double::from(travel) * sine * sine).exceeds(place.into())
            })
        }
    }

    /// When each step (from 1) of all falls due, in cycles of a clock of `clock_hz`, in 106 bits.
    ///
    /// The four quarters of a period have the same times, so those of one are saved.
    pub(super) fn exact_times(&self, clock_hz: u32) -> impl FnMut(u64) -> Double + use<> {
        let amplitude = self.oscillation.amplitude;
        let half = Exact::of(self.oscillation.period_s).times(clock_hz.into()).double() * 0.5.into();
        let mut saved = Vec::new();
        move |k| {
            let (halves, step) = ((k - 1) / (2 * amplitude), (k - 1) % (2 * amplitude));
            let from_extreme = step.min(2 * amplitude - 1 - step);
            if saved.is_empty() {
                saved.resize(amplitude.min(MAX_SAVED) as usize, None);
            }
            let part = match saved.get_mut(from_extreme as usize) {
                Some(part) => *part.get_or_insert_with(|| exact_part(from_extreme, amplitude)),
                None => exact_part(from_extreme, amplitude),
            };
            let part = if step < amplitude { part } else { Double::from(1.0) - part };
            (Double::from(halves) + part) * half
        }
    }

    fn amplitude(&self) -> f64 {
        self.oscillation.amplitude as f64
    }

    /// 2*pi/T.
    fn angular_speed(&self) -> f64 {
        TAU / self.oscillation.period_s
    }
}

/// The steps of a sine, half period after half period.
pub(super) struct DueHalves {
    oscillation: Oscillation,
    /// The length of each.
    per_half: f64,
    /// How many there are.
    halves: u64,
    /// Parts of a half period after which its steps fall due, which are the same in each; none where they are too many.
    parts: Vec<f64>,
    /// Where it is, and how many steps of it are past.
    half: u64,
    past: u64,
}

impl Runs for DueHalves {
    /// No further than to the end of a half period.
    fn next_run(&mut self, block: &mut [f64]) -> (usize, bool) {
        let Oscillation { amplitude, .. } = self.oscillation;
        let travel = 2 * amplitude;
        if self.past == travel {
            (self.half, self.past) = (self.half + 1, 0);
        }
        if self.half >= self.halves {
            return (0, false);
        }
        let len = block.len().min(usize::try_from(travel - self.past).unwrap_or(usize::MAX));
        let (half, per_half) = (self.half as f64, self.per_half);
        let kept = usize::try_from(self.past).ok().and_then(|past| self.parts.get(past..)?.get(..len));
        match kept {
            Some(parts) => {
                block.iter_mut().zip(parts).for_each(|(due, part)| *due = (half + part) * per_half);
            }
            None => {
                let steps = block.iter_mut().zip(self.past + 1..).take(len);
                steps.for_each(|(due, k)| *due = (half + part_of_half(k, amplitude)) * per_half);
            }
        }
        self.past += len as u64;
        (len, self.oscillation.goes_right(self.half))
    }
}

/// Part of a half period, 0 to 1, after which step `k` of its 2*`amplitude` falls due.
fn part_of_half(k: u64, amplitude: u64) -> f64 {
    let travel = 2 * amplitude;
    // Twice the distance of the step's place from the nearer extreme is a whole number.
    let from_extreme = |twice: u64| 2.0 / PI * libm::asin(square_root(twice as f64 / (2 * travel) as f64));
    if k <= amplitude { from_extreme(2 * k - 1) } else { 1.0 - from_extreme(2 * (travel - k) + 1) }
}

/// Part of a half period from the extreme to the step before which there are `past` others, up to the middle: 2/pi*x
/// where sin^2(x) = (past + 1/2)/(2*`amplitude`).
fn exact_part(past: u64, amplitude: u64) -> Double {
    let sine = (Double::from(2 * past + 1) / Double::from(4 * amplitude)).square_root();
    let near = libm::asin(sine.high);
    // One of Newton's steps doubles the digits.
    let found = Double::from(near) - Double::from(near).less_its_sine();
    let rest = (sine - found).high / square_root(1.0 - sine.high * sine.high);
    Double::sum(near, rest) * 2.0.into() / double::PI
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
        let turning = self.angular_speed();
        let speed = self.amplitude() * turning;
        let acceleration = speed * turning;
        Peaks { speed, acceleration, jump: 0.0, jerk: acceleration * turning, acceleration_jump: 0.0 }
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

    /// All steps, in blocks of this length.
    fn all(sine: &Sine, block: usize) -> Vec<(f64, bool)> {
        let (mut halves, mut block, mut due) = (sine.due_halves(1.0), vec![0.0; block], Vec::new());
        loop {
            let (len, right) = halves.next_run(&mut block);
            if len == 0 {
                return due;
            }
            due.extend(block[..len].iter().map(|at| (*at, right)));
        }
    }

    /// Half periods of the steps of one half period.
    fn half(amplitude: i64) -> Vec<f64> {
        let mut due = all(&Sine::new(amplitude, 1.0, 1), 7);
        due.truncate(2 * amplitude.unsigned_abs() as usize);
        due.into_iter().map(|(at, _)| at).collect()
    }

    #[test]
    fn steps_stand_where_the_cosine_is_half_way_between_two() {
        // One step either side: cos = 1/2 and -1/2, at 60 and 120 degrees.
        for (found, expected) in half(1).into_iter().zip([1.0 / 3.0, 2.0 / 3.0]) {
            assert!((found - expected).abs() < 1e-15, "{found}");
        }
        // The first step of a large amplitude: cos = 1 - 1/(2*A), so nearly sqrt(1/A).
        for amplitude in [1_000_000, 1_000_000_000_i64] {
            let sine = Sine::new(amplitude, 1.0, 1);
            let mut first = [0.0];
            assert_eq!(sine.due_halves(1.0).next_run(&mut first), (1, false));
            let first = first[0] * PI;
            let x = 1.0 / amplitude as f64;
            let expected = libm::sqrt(x) * (1.0 + x / 24.0 + 3.0 * x * x / 640.0);
            assert!((first / expected - 1.0).abs() < 1e-15, "{amplitude}: {first} {expected}");
        }
    }

    #[test]
    fn every_period_has_its_steps_and_both_halves_mirror_each_other() {
        for amplitude in [1, 2, 3, 1000, -777] {
            let (sine, steps) = (Sine::new(amplitude, 0.5, 3), 2 * amplitude.unsigned_abs() as usize);
            let due = all(&sine, 64);
            assert_eq!(all(&sine, 1), due);
            assert_eq!((due.len() as u64, due.len()), (sine.step_count(), 6 * steps));
            for (index, pair) in due.windows(2).enumerate() {
                assert!(pair[0].0 < pair[1].0, "{amplitude}: {pair:?}");
                assert_eq!(pair[0].1, (index / steps % 2 == 1) == (amplitude > 0), "{amplitude}");
            }
            for k in 0..steps {
                assert!((due[k].0 + due[steps - 1 - k].0 - 1.0).abs() < 1e-15);
                assert!((due[5 * steps + k].0 - due[k].0 - 5.0).abs() < 1e-14);
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
