//! Spectrum and distortion of a motion: ideal curve and pulses (DESIGN B5, Part D).
//!
//! Whole periods are taken without a window function, so nothing leaks. Speed and acceleration have the position's
//! harmonics times 2*pi*k*f0 and its square. Distortion of the acceleration grows with the order; a sensor is a
//! first-order low pass of bandwidth f_b:
//!
//! ```text
//! filtered  A_k*(2*pi*k*f0)^2 * |H(k*f0)|        |H(f)| = 1/sqrt(1 + (f/f_b)^2)
//! ```
//!
//! A motion that is not periodic is taken as a whole, less its straight line, and has no distortion.
//!
//! ```
//! use stepscope_inspect::motion::spectrum::Spectrum;
//! use stepscope_motion::{moves::{Axis, Move, SineSegments}, plan_axis};
//!
//! let axis = Axis { moves: vec![Move::SineSegments(SineSegments::default())], ..Axis::default() };
//! let plan = plan_axis(&axis, "x").expect("it can be planned");
//! let spectrum = Spectrum::ideal(&plan, 40, 4096).expect("it takes time");
//! assert!(spectrum.position.distortion.expect("it is periodic") < 0.003); // THD below 0.3 %
//! ```

pub use crate::motion::analysis_window::AnalysisWindow;

use crate::motion::fourier::{amplitudes, magnitude, sums};
use crate::motion::{analysis_window::sampled, sine_polyline::low_pass};
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};
use stepscope_motion::AxisPlan;

/// Amplitudes from the first harmonic on, and their distortion.
#[derive(Clone, Debug, PartialEq)]
pub struct Harmonics {
    pub amplitudes: Vec<f64>,
    /// THD as a ratio; `None` if the motion is not periodic.
    pub distortion: Option<f64>,
}

impl Harmonics {
    fn new(amplitudes: Vec<f64>, periodic: bool) -> Self {
        let distortion = if periodic { distortion(&amplitudes) } else { None };
        Self { amplitudes, distortion }
    }
}

fn distortion(amplitudes: &[f64]) -> Option<f64> {
    let (&first, others) = amplitudes.split_first()?;
    let square: f64 = others.iter().map(|amplitude| amplitude * amplitude).sum();
    (first > 0.0).then(|| libm::sqrt(square) / first)
}

/// Harmonics of position, speed and acceleration over whole periods.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    pub window: AnalysisWindow,
    pub order: u16,
    pub position: Harmonics,
    pub speed: Harmonics,
    pub acceleration: Harmonics,
    /// The acceleration that a sensor measures ([`Self::filtered_by`]).
    pub acceleration_filtered: Option<Harmonics>,
}

impl Spectrum {
    fn of_position(window: AnalysisWindow, position: Vec<f64>) -> Self {
        let per_s = |k: usize| TAU * (k + 1) as f64 / window.period_s;
        let speed: Vec<f64> = position.iter().enumerate().map(|(k, a)| a * per_s(k)).collect();
        let acceleration = speed.iter().enumerate().map(|(k, a)| a * per_s(k)).collect();
        Self {
            window,
            order: u16::try_from(position.len()).unwrap_or(u16::MAX),
            position: Harmonics::new(position, window.periodic),
            speed: Harmonics::new(speed, window.periodic),
            acceleration: Harmonics::new(acceleration, window.periodic),
            acceleration_filtered: None,
        }
    }

    /// Adds the acceleration that a sensor of this bandwidth (-3 dB, in Hz) measures.
    pub fn filtered_by(mut self, sensor_hz: Option<f64>) -> Self {
        self.acceleration_filtered = sensor_hz.map(|sensor_hz| {
            let harmonics = (1..).zip(&self.acceleration.amplitudes);
            let line_hz = |k: u32| f64::from(k) * self.window.fundamental_hz();
            let filtered =
                harmonics.map(|(k, amplitude)| amplitude * low_pass(line_hz(k) / sensor_hz)).collect();
            Harmonics::new(filtered, self.window.periodic)
        });
        self
    }

    /// The ideal curve over [`AnalysisWindow::of`]. `points` sample one period; harmonics from half of them on do not
    /// exist, which lowers the order.
    pub fn ideal(plan: &AxisPlan, order: u16, points: u32) -> Option<Self> {
        let window = AnalysisWindow::of(plan)?;
        let samples = sampled(plan, &AnalysisWindow { periods: 1, ..window }, points as usize);
        Some(Self::of_position(window, amplitudes(&samples, order.into())))
    }

    /// Pulses (time in s, +1 right or -1 left) in any order; those outside the window are moved by whole periods.
    pub fn of_pulses(pulses: &[(f64, i8)], window: AnalysisWindow, order: u16) -> Self {
        let phases = pulses
            .iter()
            .map(|&(time_s, direction)| ((time_s - window.start_s) / window.period_s, f64::from(direction)));
        let position = sums(phases, order.into())
            .into_iter()
            .enumerate()
            // |v_k| = |sum|/L; the speed's amplitude is twice that, the position's 1/(2*pi*k*f0).
            .map(|(k, sum)| magnitude(sum) / (PI * (k + 1) as f64 * f64::from(window.periods)))
            .collect();
        Self::of_position(window, position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use stepscope_motion::{
        mechanics::{Distance, Speed},
        moves::{Axis, Constant, Cosine, Dwell, Move, SineSegments},
        plan_axis, round_half_up,
        step_tables::TickClock,
    };

    /// All harmonics of the paper's transform of 2048 points. The paper does not state its
    /// order; this is the one that gives its distortions to the last digit (up to the 40th harmonic
    /// they would be 0.26369 % and 0.26078 %).
    const PAPER_ORDER: u16 = 1023;

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
    fn the_papers_distortions_are_reproduced() {
        // So many steps that their rounding is not in the last digit.
        let harmonics = |d1| {
            let sine = SineSegments {
                amplitude: Distance::Steps(1e9),
                period_s: 3600.0,
                max_deviation: d1,
                ..SineSegments::default()
            };
            let plan = plan(vec![Move::SineSegments(sine)]);
            Spectrum::ideal(&plan, PAPER_ORDER, 2048).unwrap().position
        };
        let (first, second) = (harmonics(0.0054), harmonics(0.006));
        assert_eq!(first.amplitudes.len(), usize::from(PAPER_ORDER));
        close(first.distortion.unwrap() * 100.0, 0.26913, 2e-5);
        close(second.distortion.unwrap() * 100.0, 0.26710, 2e-5);
        let power = |harmonics: &Harmonics| harmonics.amplitudes[6] * harmonics.amplitudes[6];
        assert!(power(&first) > 22.0 * power(&second));
        close(power(&first) / power(&second), 23.76, 1e-3);
    }

    #[test]
    fn a_motion_of_many_steps_has_the_spectrum_of_its_polyline() {
        let plan = plan(vec![Move::Dwell(Dwell { duration_s: 0.3 }), sine(-5e5, 0.006)]);
        let spectrum = Spectrum::ideal(&plan, PAPER_ORDER, 2048).unwrap();
        assert_eq!((spectrum.window.start_s, spectrum.window.periods, spectrum.order), (0.3, 4, 1023));
        close(spectrum.position.distortion.unwrap() * 100.0, 0.26710, 1e-3);
        close(spectrum.position.amplitudes[0], 5e5, 1e-2);
        close(spectrum.speed.amplitudes[0], spectrum.position.amplitudes[0] * TAU * 2.0, 1e-12);
        close(spectrum.acceleration.amplitudes[2], spectrum.speed.amplitudes[2] * TAU * 6.0, 1e-12);
        let order = Spectrum::ideal(&plan, 1000, 256).unwrap().order;
        assert_eq!(order, 127, "there are no more harmonics than half of the points");
    }

    #[test]
    fn any_number_of_samples_has_the_harmonics_of_the_polyline() {
        let plan = plan(vec![sine(5e5, 0.006)]);
        let exact = |order| crate::motion::sine_polyline::Row::of(0.006, order).distortion;
        for (points, order) in [(1000, 40), (4099, 99), (4096, 99), (65_535, 399), (17, 40)] {
            let found = Spectrum::ideal(&plan, order, points).unwrap();
            assert_eq!(u32::from(found.order), u32::from(order).min((points - 1) / 2));
            let expected = exact(found.order);
            // Of a few points nearly all is what folds back from beyond half of them.
            if points >= 1000 {
                close(found.position.distortion.unwrap(), expected.position, 0.01);
                close(found.speed.distortion.unwrap(), expected.speed, 0.01);
                close(found.acceleration.distortion.unwrap(), expected.acceleration, 0.02);
            }
        }
    }

    #[test]
    fn filtered_distortion_of_segments_hardly_depends_on_the_order() {
        let plan = plan(vec![sine(5e5, 0.006)]);
        // 2 Hz filtered with 40 Hz.
        let of = |order| Spectrum::ideal(&plan, order, 65_536).unwrap().filtered_by(Some(40.0));
        let [low, high] = [of(300), of(1000)];
        let thd = |found: &Harmonics| found.distortion.unwrap();
        assert!(thd(&high.acceleration) > 1.7 * thd(&low.acceleration));
        let [low, high] = [low, high].map(|found| found.acceleration_filtered.unwrap());
        assert!(thd(&high) < 1.03 * thd(&low), "{} {}", thd(&low), thd(&high));
        let acceleration = of(40).acceleration;
        // At the bandwidth itself, harmonic 20, half of the power is left; 19 is an odd one.
        let part = low.amplitudes[18] / acceleration.amplitudes[18];
        close(part, 1.0 / libm::sqrt(1.0 + 0.95 * 0.95), 1e-9);
        assert_eq!(of(40).filtered_by(None).acceleration_filtered, None);
    }

    #[test]
    fn a_motion_that_does_not_repeat_has_lines_but_no_distortion() {
        let cosine =
            Cosine { distance: Distance::Steps(6400.0), duration_s: 0.4, ramp_s: 0.2, ..Cosine::default() };
        let plan = plan(vec![Move::Cosine(cosine)]);
        let spectrum = Spectrum::ideal(&plan, 5, 4096).unwrap();
        assert!(!spectrum.window.periodic && spectrum.position.distortion.is_none());
        // Its speed is 16000*(1 - cos(2*pi*2.5 Hz*t)): one line.
        close(spectrum.window.fundamental_hz(), 2.5, 1e-15);
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
        let window = AnalysisWindow { start_s: 10.0, period_s: 1.0, periods: 2, periodic: true };
        // The last two are a step outside and where periods take it back.
        let pulses = [(10.25, 1), (10.75, -1), (11.25, 1), (11.75, -1), (9.99, 1), (11.99, -1)];
        let spectrum = Spectrum::of_pulses(&pulses, window, 101);
        for (k, amplitude) in (1..).zip(&spectrum.position.amplitudes) {
            let expected = if k % 2 == 1 { 2.0 / (PI * f64::from(k)) } else { 0.0 };
            assert!((amplitude - expected).abs() < 1e-12, "{k}: {amplitude} {expected}");
        }
        close(spectrum.speed.amplitudes[6], 4.0, 1e-12);
    }

    #[test]
    fn sums_over_the_grid_equal_sums_of_single_pulses() {
        let window = AnalysisWindow { start_s: 0.0, period_s: 0.125, periods: 3, periodic: true };
        let pulses: Vec<(f64, i8)> = (0..1001)
            .map(|i| (f64::from(i * i % 4099) * 0.375 / 4099.0, if i % 3 == 0 { -1 } else { 1 }))
            .collect();
        let found = Spectrum::of_pulses(&pulses, window, 1000);
        for (k, amplitude) in (1..).zip(&found.position.amplitudes) {
            let k = f64::from(k);
            let (re, im) = pulses.iter().fold((0.0, 0.0), |(re, im), &(t, direction)| {
                let turns = k * (t / 0.125);
                let (sine, cosine) = libm::sincos(TAU * (turns - libm::floor(turns)));
                (re + f64::from(direction) * cosine, im - f64::from(direction) * sine)
            });
            let expected = libm::sqrt(re * re + im * im) / (PI * k * 3.0);
            assert!((amplitude - expected).abs() < 1e-12 * 1001.0 / k, "{k}: {amplitude} {expected}");
        }
    }

    #[test]
    fn pulses_at_due_times_have_the_curves_spectrum() {
        let plan = plan(vec![sine(2000.0, 0.006)]);
        let mut pulses = Vec::new();
        let (mut due, samples) = (0, 2_000_000);
        for sample in 1..=samples {
            let t = plan.duration_s() * f64::from(sample) / f64::from(samples);
            let now = plan.steps_due(t);
            pulses.extend((due != now).then_some((t, if now > due { 1 } else { -1 })));
            due = now;
        }
        let ideal = Spectrum::ideal(&plan, 40, 4096).unwrap();
        let actual = Spectrum::of_pulses(&pulses, ideal.window, 40);
        close(actual.position.amplitudes[0], ideal.position.amplitudes[0], 1e-5);
        close(actual.position.distortion.unwrap(), ideal.position.distortion.unwrap(), 0.02);
    }

    #[test]
    fn pulses_in_a_shared_tick_belong_to_one_move() {
        // Ticks of 1 ms: a constant of 4 steps until 2 ms, or 2.5 ms, then the sine.
        let run = |steps: f64, speed: f64, sine_steps: f64, pulses: &[(u64, i8)]| {
            let constant = Move::Constant(Constant {
                distance: Distance::Steps(steps),
                speed: Speed::StepsPerSecond(speed),
            });
            let sine = SineSegments {
                amplitude: Distance::Steps(sine_steps),
                period_s: 0.004,
                periods: 1,
                max_deviation: 1.0,
            };
            let plan = plan(vec![constant.clone(), Move::SineSegments(sine), constant]);
            let window = AnalysisWindow::of(&plan).unwrap();
            let own = window.pulses_of_moves(&plan, TickClock::new(1000, 1_000_000), pulses);
            own.iter().map(|(t, direction)| (round_half_up(t * 1e6) as u64, *direction)).collect::<Vec<_>>()
        };
        // On the grid nothing is shared. The sine makes 2 steps per tick: left in two ticks, right in two.
        let there = |tick: u64, direction: i8| [(tick * 1000, direction), (tick * 1000 + 500, direction)];
        let sine: Vec<(u64, i8)> =
            [there(2, -1), there(3, -1), there(4, 1), there(5, 1)].into_iter().flatten().collect();
        let all: Vec<(u64, i8)> =
            [there(0, 1), there(1, 1)].into_iter().flatten().chain(sine.clone()).chain(there(6, 1)).collect();
        assert_eq!(run(4.0, 2000.0, 2.0, &all), sine);
        // Left, and half a tick later: the second pulse of tick 2 is the sine's. Opposite steps of
        // the sine and the next move in tick 6 cancel.
        let all: Vec<(u64, i8)> = [(0, -1), (1, -1), (2, -1), (3, -1), (5, 1)]
            .into_iter()
            .flat_map(|(tick, direction)| there(tick, direction))
            .collect();
        assert_eq!(run(-5.0, 2000.0, 2.0, &all), all[5..]);
        // In the opposite direction: tick 2 cancels, of tick 6 the first pulse is the sine's.
        let all: Vec<(u64, i8)> = [(0, -1), (1, -1), (3, 1), (5, -1), (6, -1)]
            .into_iter()
            .flat_map(|(tick, direction)| there(tick, direction))
            .collect();
        assert_eq!(run(-5.0, 2000.0, -2.0, &all), all[4..9]);
        // A tick with too many pulses, as after line errors: pulses of other moves are not taken.
        assert_eq!(run(-5.0, 2000.0, -2.0, &[(2500, 1), (2600, -1), (6500, 1)]), [(2500, 1)]);
    }
}
