//! The spectrum as a plot shows it: the position's amplitude over frequency, harmonics and all that
//! stands between them.

use super::{
    fourier::amplitudes,
    stretch::{Stretch, sampled, transform_points},
};
use crate::motion::AxisPlan;
use alloc::{vec, vec::Vec};
use core::f64::consts::PI;

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
