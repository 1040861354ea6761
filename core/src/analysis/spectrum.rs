//! Spectrum and distortion of a motion: of the ideal curve, and of the pulses as they come
//! (DESIGN B5, Part D).
//!
//! Whole periods are looked at and no window is laid over them, so each harmonic stands in one
//! line and nothing leaks. Speed and acceleration of a periodic curve have, exactly, the
//! harmonics of its position times 2*pi*k*f0 and times its square:
//!
//! ```text
//! position  A_k        speed  A_k*(2*pi*k*f0)        acceleration  A_k*(2*pi*k*f0)^2
//! THD_F = sqrt(A_2^2 + … + A_order^2)/A_1
//! ```
//!
//! The order belongs to the figure: segments of fixed rate have jumps of speed, so the harmonics
//! of their acceleration do not fall at all and its distortion grows with the order.
//!
//! A motion that is not periodic is looked at as a whole; the straight line from its first to its
//! last point is taken off its position, for otherwise the jump back at the end would be in all
//! three. Its lines are no harmonics of anything, so it has no distortion.

pub use super::{lines::Lines, stretch::Stretch};

use super::{
    fourier::{amplitudes, magnitude, sums},
    stretch::sampled,
};
use crate::motion::{AxisPlan, polyline::unit_polyline};
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};

/// Points of the document's transform over one period (B5).
pub const DOCUMENT_POINTS: usize = 2048;
/// The order that gives the document's distortions: all harmonics of [`DOCUMENT_POINTS`].
pub const DOCUMENT_ORDER: u16 = 1023;

/// Harmonics of one quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Harmonics {
    /// Amplitudes (peak, not effective) of harmonics 1, 2, ….
    pub amplitudes: Vec<f64>,
    /// THD_F over all of these, as a ratio; `None` without a first harmonic to compare with.
    pub distortion: Option<f64>,
}

impl Harmonics {
    fn new(amplitudes: Vec<f64>, periodic: bool) -> Self {
        let distortion = if periodic { distortion(&amplitudes) } else { None };
        Self { amplitudes, distortion }
    }
}

/// THD_F: the root of the sum of squares of all harmonics but the first, over the first.
fn distortion(amplitudes: &[f64]) -> Option<f64> {
    let (&first, others) = amplitudes.split_first()?;
    let square: f64 = others.iter().map(|amplitude| amplitude * amplitude).sum();
    (first > 0.0).then(|| libm::sqrt(square) / first)
}

/// A spectrum with what belongs to its figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// What it is taken of; no window is laid over it.
    pub stretch: Stretch,
    /// Highest harmonic, also of the distortion.
    pub order: u16,
    /// Position, in steps.
    pub position: Harmonics,
    /// Speed, in steps/s.
    pub speed: Harmonics,
    /// Acceleration, in steps/s^2.
    pub acceleration: Harmonics,
}

impl Spectrum {
    /// From the position's harmonics.
    fn of_position(stretch: Stretch, position: Vec<f64>) -> Self {
        let per_s = |k: usize| TAU * (k + 1) as f64 / stretch.period_s;
        let speed: Vec<f64> = position.iter().enumerate().map(|(k, a)| a * per_s(k)).collect();
        let acceleration = speed.iter().enumerate().map(|(k, a)| a * per_s(k)).collect();
        Self {
            stretch,
            order: u16::try_from(position.len()).unwrap_or(u16::MAX),
            position: Harmonics::new(position, stretch.periodic),
            speed: Harmonics::new(speed, stretch.periodic),
            acceleration: Harmonics::new(acceleration, stretch.periodic),
        }
    }

    /// Of the ideal curve over [`Stretch::of`] it, up to harmonic `order`; `None` where that is.
    ///
    /// `points`, a power of two (256 to 65536 in a scenario; the next one is taken), are the
    /// samples of a period. One period is sampled, because the others are the same. Harmonics from
    /// half of the points on do not exist: the order is cut to that and stated in the result.
    #[must_use]
    pub fn ideal(plan: &AxisPlan, order: u16, points: u32) -> Option<Self> {
        let stretch = Stretch::of(plan)?;
        let samples = sampled(plan, &Stretch { periods: 1, ..stretch }, points as usize);
        Some(Self::of_position(stretch, amplitudes(&samples, order.into())))
    }

    /// Of the motion that pulses make: `pulses` are (time in s, on the same axis of time as the
    /// stretch; +1 right or -1 left), in any order. Those outside the stretch don't count.
    ///
    /// Straight from the pulses' times, see `fourier`: nothing is sampled, nothing folds back.
    #[must_use]
    pub fn of_pulses(pulses: &[(f64, i8)], stretch: Stretch, order: u16) -> Self {
        let phases = stretch.within(pulses).map(|(since_s, way)| (since_s / stretch.period_s, way));
        let position = sums(phases, order.into())
            .into_iter()
            .enumerate()
            // |v_k| = |sum|/L; the speed's amplitude is twice that, the position's 1/(2*pi*k*f0).
            .map(|(k, sum)| magnitude(sum) / (PI * (k + 1) as f64 * f64::from(stretch.periods)))
            .collect();
        Self::of_position(stretch, position)
    }
}

/// Harmonics of the polyline through the cosine at a quarter's `breakpoints`, with B5's figures of
/// distortion: [`DOCUMENT_POINTS`] samples of a period, all their [`DOCUMENT_ORDER`] harmonics.
///
/// The document does not state its order; this is the one that gives its 0.26913 % for
/// d1 = 0.0054 and 0.26710 % for d1 = 0.006 to the last digit (up to the 40th harmonic they would
/// be 0.26369 % and 0.26078 %).
#[must_use]
pub fn polyline_harmonics(breakpoints: &[u16]) -> Harmonics {
    let samples: Vec<f64> =
        (0..DOCUMENT_POINTS).map(|point| unit_polyline(breakpoints, point as f64)).collect();
    Harmonics::new(amplitudes(&samples, DOCUMENT_ORDER.into()), true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        motion::{plan_axis, polyline::breakpoints},
        scenario::{Axis, Cosine, Distance, Dwell, Move, SineSegments},
    };
    use alloc::vec;

    fn plan(moves: Vec<Move>) -> AxisPlan {
        plan_axis(&Axis { moves, ..Axis::default() }, "axis").unwrap()
    }

    fn sine(amplitude: f64, max_deviation: f64) -> Move {
        let amplitude = Distance::Steps(amplitude);
        Move::SineSegments(SineSegments { amplitude, max_deviation, ..SineSegments::default() })
    }

    fn close(found: f64, expected: f64, relative: f64) {
        assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not {expected}");
    }

    #[test]
    fn the_documents_distortions_come_out() {
        let harmonics = |d1| polyline_harmonics(&breakpoints(d1));
        let (first, second) = (harmonics(0.0054), harmonics(0.006));
        assert_eq!(first.amplitudes.len(), usize::from(DOCUMENT_ORDER));
        close(first.distortion.unwrap() * 100.0, 0.26913, 2e-5);
        close(second.distortion.unwrap() * 100.0, 0.26710, 2e-5);
        let power = |harmonics: &Harmonics| harmonics.amplitudes[6] * harmonics.amplitudes[6];
        assert!(power(&first) > 22.0 * power(&second));
        close(power(&first) / power(&second), 23.76, 1e-3);
    }

    #[test]
    fn a_motion_of_many_steps_has_the_spectrum_of_its_polyline() {
        let plan = plan(vec![Move::Dwell(Dwell { duration_s: 0.3 }), sine(-5e5, 0.006)]);
        let spectrum = Spectrum::ideal(&plan, DOCUMENT_ORDER, 2048).unwrap();
        assert_eq!((spectrum.stretch.start_s, spectrum.stretch.periods, spectrum.order), (0.3, 4, 1023));
        close(spectrum.position.distortion.unwrap() * 100.0, 0.26710, 1e-3);
        close(spectrum.position.amplitudes[0], 5e5, 1e-2);
        close(spectrum.speed.amplitudes[0], spectrum.position.amplitudes[0] * TAU * 2.0, 1e-12);
        close(spectrum.acceleration.amplitudes[2], spectrum.speed.amplitudes[2] * TAU * 6.0, 1e-12);
        let order = Spectrum::ideal(&plan, 1000, 256).unwrap().order;
        assert_eq!(order, 127, "there are no more harmonics than half of the points");
    }

    #[test]
    fn a_motion_that_does_not_repeat_has_lines_but_no_distortion() {
        let cosine = Cosine { distance: Distance::Steps(6400.0), duration_s: 0.4, ramp_s: 0.2 };
        let plan = plan(vec![Move::Cosine(cosine)]);
        let spectrum = Spectrum::ideal(&plan, 5, 4096).unwrap();
        assert!(!spectrum.stretch.periodic && spectrum.position.distortion.is_none());
        // Its speed is 16000*(1 - cos(2*pi*2.5 Hz*t)): one line.
        close(spectrum.stretch.fundamental_hz(), 2.5, 1e-15);
        close(spectrum.speed.amplitudes[0], 16_000.0, 1e-6);
        assert!(spectrum.speed.amplitudes[1..].iter().all(|a| *a < 1e-3), "{spectrum:?}");
        assert_eq!(
            Spectrum::ideal(&super::tests::plan(vec![Move::Dwell(Dwell { duration_s: 0.0 })]), 5, 256),
            None
        );
    }

    #[test]
    fn a_step_to_and_fro_is_a_square_wave() {
        // Two periods of 1 s, height 1.
        let stretch = Stretch { start_s: 10.0, period_s: 1.0, periods: 2, periodic: true };
        let pulses = [(10.25, 1), (10.75, -1), (11.25, 1), (11.75, -1), (9.99, 1), (12.0, 1)];
        let spectrum = Spectrum::of_pulses(&pulses, stretch, 101);
        let lines = Lines::of_pulses(&pulses, stretch, 4096);
        assert_eq!(lines.step_hz, 0.5);
        for (k, amplitude) in (1..).zip(&spectrum.position.amplitudes) {
            let expected = if k % 2 == 1 { 2.0 / (PI * f64::from(k)) } else { 0.0 };
            assert!((amplitude - expected).abs() < 1e-12, "{k}: {amplitude} {expected}");
            let line = lines.amplitudes[2 * k as usize - 1];
            assert!((line - expected).abs() < 1e-3, "{k}: {line} {expected}");
        }
        close(spectrum.speed.amplitudes[6], 4.0, 1e-12);
    }

    #[test]
    fn pulses_through_the_recurrence_weigh_as_much_as_one_by_one() {
        let stretch = Stretch { start_s: 0.0, period_s: 0.125, periods: 3, periodic: true };
        let pulses: Vec<(f64, i8)> = (0..1001)
            .map(|i| (f64::from(i * i % 4099) * 0.375 / 4099.0, if i % 3 == 0 { -1 } else { 1 }))
            .collect();
        let found = Spectrum::of_pulses(&pulses, stretch, 1000);
        for (k, amplitude) in (1..).zip(&found.position.amplitudes) {
            let k = f64::from(k);
            let (re, im) = pulses.iter().fold((0.0, 0.0), |(re, im), &(t, way)| {
                let turns = k * (t / 0.125);
                let (sine, cosine) = libm::sincos(TAU * (turns - libm::floor(turns)));
                (re + f64::from(way) * cosine, im - f64::from(way) * sine)
            });
            let expected = libm::sqrt(re * re + im * im) / (PI * k * 3.0);
            assert!((amplitude - expected).abs() < 1e-12 * 1001.0 / k, "{k}: {amplitude} {expected}");
        }
    }

    #[test]
    fn pulses_where_the_curve_asks_for_them_have_the_curves_spectrum() {
        let plan = plan(vec![sine(2000.0, 0.006)]);
        let mut pulses = Vec::new();
        let (mut due, looks) = (0, 2_000_000);
        for look in 1..=looks {
            let t = plan.duration_s() * f64::from(look) / f64::from(looks);
            let now = plan.steps_due(t);
            pulses.extend((due != now).then_some((t, if now > due { 1 } else { -1 })));
            due = now;
        }
        let ideal = Spectrum::ideal(&plan, 40, 4096).unwrap();
        let made = Spectrum::of_pulses(&pulses, ideal.stretch, 40);
        close(made.position.amplitudes[0], ideal.position.amplitudes[0], 1e-5);
        close(made.position.distortion.unwrap(), ideal.position.distortion.unwrap(), 0.02);
        let lines = Lines::of_pulses(&pulses, ideal.stretch, 1 << 15);
        close(lines.amplitudes[3], ideal.position.amplitudes[0], 1e-4);
        let smooth = Lines::ideal(&plan, ideal.stretch, 1 << 15);
        close(smooth.amplitudes[3], ideal.position.amplitudes[0], 1e-6);
    }
}
