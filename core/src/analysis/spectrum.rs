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

use super::fourier::{amplitudes, magnitude, sums};
use crate::motion::{AxisPlan, Profile, sine_segments};
use alloc::{vec, vec::Vec};
use core::f64::consts::{PI, TAU};

/// Points of the document's transform over one period (B5).
pub const DOCUMENT_POINTS: usize = 2048;
/// The order that gives the document's distortions: all harmonics of [`DOCUMENT_POINTS`].
pub const DOCUMENT_ORDER: u16 = 1023;
/// Longest transform.
const MOST_POINTS: usize = 1 << 20;

/// The stretch of time that a spectrum is taken of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Its start in s.
    pub start_s: f64,
    /// Time of one period in s, above 0.
    pub period_s: f64,
    /// How many whole periods, at least 1.
    pub periods: u32,
    /// Whether the motion repeats; otherwise the whole of it stands as one period.
    pub periodic: bool,
}

impl Stretch {
    /// All periods of the first periodic move, or, where none is, the whole motion; `None` for a
    /// motion that takes no time.
    #[must_use]
    pub fn of(plan: &AxisPlan) -> Option<Self> {
        let sine = plan.moves().iter().find_map(|planned| match &planned.profile {
            Profile::SineSegments(sine) => Some((planned.start_s, sine)),
            _ => None,
        });
        let stretch = match sine {
            Some((start_s, sine)) => {
                Self { start_s, period_s: sine.period_s(), periods: sine.periods(), periodic: true }
            }
            None => Self { start_s: 0.0, period_s: plan.duration_s(), periods: 1, periodic: false },
        };
        (stretch.period_s > 0.0).then_some(stretch)
    }

    /// Its length in s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.period_s * f64::from(self.periods)
    }

    /// The frequency of harmonic 1 in Hz.
    #[must_use]
    pub fn fundamental_hz(&self) -> f64 {
        1.0 / self.period_s
    }

    /// Pulses within the stretch: when since its start, in s, and +1 or -1.
    fn within<'p>(&self, pulses: &'p [(f64, i8)]) -> impl Iterator<Item = (f64, f64)> + use<'p> {
        let (start_s, length_s) = (self.start_s, self.length_s());
        pulses
            .iter()
            .map(move |&(time_s, direction)| (time_s - start_s, f64::from(direction)))
            .filter(move |(since_s, _)| (0.0..length_s).contains(since_s))
    }
}

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

/// Amplitudes of the position over frequency, for a plot: line i at i*`step_hz`, from 1 on.
#[derive(Clone, Debug, PartialEq)]
pub struct Lines {
    /// From line to line, in Hz: 1/length of the stretch.
    pub step_hz: f64,
    /// Amplitudes in steps from line 1 on.
    pub amplitudes: Vec<f64>,
}

impl Lines {
    /// Of the ideal curve over all periods of the stretch, by a transform of at least `points`.
    #[must_use]
    pub fn ideal(plan: &AxisPlan, stretch: Stretch, points: usize) -> Self {
        Self::of(&stretch, &sampled(plan, &stretch, points))
    }

    /// Of the pulses' staircase over the stretch.
    ///
    /// A sample is the staircase's mean over its cell, which damps what would fold back, and the
    /// mean's own sin(x)/x is divided out again; the distortion never comes from here.
    #[must_use]
    pub fn of_pulses(pulses: &[(f64, i8)], stretch: Stretch, points: usize) -> Self {
        let points = transform_points(points);
        let cell_s = stretch.length_s() / points as f64;
        let (mut within_cell, mut after_cell) = (vec![0.0; points], vec![0.0; points]);
        let mut all = 0.0;
        for (since_s, way) in stretch.within(pulses) {
            let place = since_s / cell_s;
            let cell = (place as usize).min(points - 1);
            if let (Some(within), Some(after)) = (within_cell.get_mut(cell), after_cell.get_mut(cell)) {
                *within += way * ((cell + 1) as f64 - place);
                *after += way;
                all += way;
            }
        }
        let mut position = 0.0;
        let samples: Vec<f64> = (0..points)
            .zip(within_cell.iter().zip(&after_cell))
            .map(|(cell, (within, after))| {
                let mean = position + within;
                position += after;
                mean - all * (cell as f64 + 0.5) / points as f64
            })
            .collect();
        let mut lines = Self::of(&stretch, &samples);
        for (i, amplitude) in lines.amplitudes.iter_mut().enumerate() {
            let x = PI * (i + 1) as f64 / points as f64;
            *amplitude *= x / libm::sin(x);
        }
        lines
    }

    fn of(stretch: &Stretch, samples: &[f64]) -> Self {
        Self { step_hz: 1.0 / stretch.length_s(), amplitudes: amplitudes(samples, samples.len()) }
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
    let samples: Vec<f64> = (0..DOCUMENT_POINTS)
        .map(|point| sine_segments::unit_polyline(breakpoints, point as f64))
        .collect();
    Harmonics::new(amplitudes(&samples, DOCUMENT_ORDER.into()), true)
}

/// A transform's length: a power of two, not beyond all bounds.
fn transform_points(points: usize) -> usize {
    points.clamp(16, MOST_POINTS).next_power_of_two()
}

/// The ideal position over the stretch less its straight line, at equal steps of time.
fn sampled(plan: &AxisPlan, stretch: &Stretch, points: usize) -> Vec<f64> {
    let points = transform_points(points);
    let at = |part: f64| plan.position(stretch.start_s + stretch.length_s() * part);
    let first = at(0.0);
    let way = if stretch.periodic { 0.0 } else { at(1.0) - first };
    (0..points)
        .map(|i| {
            let part = i as f64 / points as f64;
            at(part) - first - way * part
        })
        .collect()
}
