//! Recorded steps beside a model's, step by step, from a step that both have at one time.
//!
//! ```text
//! recorded     |   |  | | |        late = time since the aligned step, recorded less model's
//! model        |   | |  | |        drift: the straight line through most of late over time
//!              ^ aligned           jitter: what is left of late without it
//! ```
//!
//! Two clocks never agree: a crystal is off by some tens of ppm, which grows to milliseconds in a minute. So the drift is
//! told by itself, and the jitter without it; a few steps that are far off tilt neither ([`super::drift`]), and are counted.
//!
//! ```
//! use stepscope_inspect::recording::{alignment::{Comparison, Side}, tolerance::Tolerance};
//! use stepscope_peripheral::trace::Step;
//!
//! let steps = |cycles: [u64; 4]| cycles.map(|cycle| Step { cycle, position: 1 });
//! // Recorded at 1 MHz, planned at 2 MHz; the third step comes 3 us late.
//! let (recorded, model) = (steps([100, 200, 303, 400]), steps([0, 200, 400, 600]));
//! let found = Comparison::of(
//!     Side { steps: &recorded, clock_hz: 1_000_000 },
//!     Side { steps: &model, clock_hz: 2_000_000 },
//!     0,
//!     Tolerance::from_micros(1, 0).expect("a time"),
//! ).expect("both have steps");
//! assert_eq!((found.largest.step, found.first_difference.map(|first| first.step)), (2, Some(2)));
//! assert!((found.largest.late_s - 3e-6).abs() < 1e-12);
//! ```

use super::{drift::Drift, tolerance::Tolerance};
use serde::Serialize;
use stepscope_peripheral::trace::Step;

/// Steps by a clock of their own.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// All of a channel.
    pub steps: &'a [Step],
    /// Cycles a second.
    pub clock_hz: u32,
}

impl Side<'_> {
    /// Cycles from a step to another, to the left of it where it is earlier.
    fn since(&self, aligned: usize, index: usize) -> Option<i128> {
        Some(i128::from(self.steps.get(index)?.cycle) - i128::from(self.steps.get(aligned)?.cycle))
    }

    fn way(&self, index: usize) -> i32 {
        Step::direction(self.steps, index).signum()
    }
}

/// A step that is off.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Off {
    /// Which step, from 0.
    pub step: usize,
    /// When it was recorded, in s of the recording.
    pub recorded_s: f64,
    /// How much later than the model's it comes, in s; below 0 earlier.
    pub late_s: f64,
    /// Whether it goes the other way.
    pub other_direction: bool,
}

/// How recorded steps stand to a model's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Steps of the recording.
    pub recorded: usize,
    /// Steps of the model.
    pub model: usize,
    /// Steps that both have.
    pub compared: usize,
    /// What the recording's time has over the model's at the aligned step, in s.
    pub offset_s: f64,
    /// The step that is off most.
    pub largest: Off,
    /// Root of the mean square of how late the steps are, in s.
    pub rms_s: f64,
    /// Mean of how late they are, in s.
    pub mean_s: f64,
    /// How much longer the recording takes than the model, in millionths: above 0, the recorded clock is the slower one.
    pub drift_ppm: f64,
    /// Greatest magnitude of what is left without drift and offset, in s.
    pub largest_jitter_s: f64,
    /// Root of its mean square, in s, of all but the outliers.
    pub rms_jitter_s: f64,
    /// Steps that are so far off that they do not count for drift and jitter.
    pub outliers: usize,
    /// The first step that is off by more than was allowed, or goes the other way.
    pub first_difference: Option<Off>,
    /// Steps that are off by more, or go the other way.
    pub differing: usize,
}

impl Comparison {
    /// Compares step by step; step `aligned` of both, from 0, is taken for the same instant. A step that is off by
    /// exactly `within` is not different. `None` where one of them has no such step.
    #[must_use]
    pub fn of(recorded: Side<'_>, model: Side<'_>, aligned: usize, within: Tolerance) -> Option<Self> {
        let late = Late { recorded, model, aligned };
        let compared = recorded.steps.len().min(model.steps.len());
        let first = late.off(aligned)?;
        let seconds = |side: Side<'_>| {
            side.steps.get(aligned).map_or(0.0, |step| step.cycle as f64 / f64::from(side.clock_hz))
        };
        let mut found = Self {
            recorded: recorded.steps.len(),
            model: model.steps.len(),
            compared,
            offset_s: seconds(recorded) - seconds(model),
            largest: first,
            rms_s: 0.0,
            mean_s: 0.0,
            drift_ppm: 0.0,
            largest_jitter_s: 0.0,
            rms_jitter_s: 0.0,
            outliers: 0,
            first_difference: None,
            differing: 0,
        };
        let n = compared as f64;
        let (mut sum, mut square) = (0.0, 0.0);
        let most = within.units(recorded.clock_hz, model.clock_hz);
        for off in (0..compared).filter_map(|index| late.off(index)) {
            sum += off.late_s;
            square += off.late_s * off.late_s;
            if libm::fabs(off.late_s) > libm::fabs(found.largest.late_s) {
                found.largest = off;
            }
            if off.other_direction || late.units(off.step).is_none_or(|units| units.unsigned_abs() > most) {
                found.differing += 1;
                found.first_difference = found.first_difference.or(Some(off));
            }
        }
        (found.mean_s, found.rms_s) = (sum / n, libm::sqrt(square / n));
        let cycle_s = 1.0 / f64::from(recorded.clock_hz.min(model.clock_hz).max(1));
        let event = |index| late.off(index).map(|off| (late.model_s(index), off.late_s));
        let drift = Drift::of(compared, cycle_s, event);
        found.drift_ppm = drift.slope * 1e6;
        let (mut square, mut counted) = (0.0, 0.0);
        for (time_s, late_s) in (0..compared).filter_map(event) {
            let left = drift.left(time_s, late_s);
            found.largest_jitter_s = libm::fmax(found.largest_jitter_s, libm::fabs(left));
            if drift.is_outlier(left) {
                found.outliers += 1;
            } else {
                (square, counted) = (square + left * left, counted + 1.0);
            }
        }
        found.rms_jitter_s = libm::sqrt(square / libm::fmax(counted, 1.0));
        Some(found)
    }

    /// Whether every step is there, in its direction and within what was allowed.
    #[must_use]
    pub const fn is_same(&self) -> bool {
        self.differing == 0 && self.recorded == self.model
    }
}

/// How late each step is.
#[derive(Clone, Copy, Debug)]
pub struct Late<'a> {
    /// What was recorded.
    pub recorded: Side<'a>,
    /// What was due.
    pub model: Side<'a>,
    /// The step that both have at one time.
    pub aligned: usize,
}

impl Late<'_> {
    /// How late step `index` is, exactly, in units of 1/(clock * clock) s.
    fn units(&self, index: usize) -> Option<i128> {
        let Self { recorded, model, aligned } = *self;
        let (came, due) = (recorded.since(aligned, index)?, model.since(aligned, index)?);
        Some(came * i128::from(model.clock_hz) - due * i128::from(recorded.clock_hz))
    }

    /// Step `index`; `None` where one of both has none.
    #[must_use]
    pub fn off(&self, index: usize) -> Option<Off> {
        let Self { recorded, model, .. } = *self;
        let (own, other) = (i128::from(recorded.clock_hz), i128::from(model.clock_hz));
        let late = self.units(index)?;
        Some(Off {
            step: index,
            recorded_s: recorded.steps.get(index)?.cycle as f64 / own as f64,
            late_s: late as f64 / (own as f64 * other as f64),
            other_direction: recorded.way(index) != model.way(index),
        })
    }

    /// When the model has the step, from the aligned one on, in s.
    fn model_s(&self, index: usize) -> f64 {
        self.model.since(self.aligned, index).unwrap_or(0) as f64 / f64::from(self.model.clock_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    fn steps(cycles: impl Iterator<Item = u64>) -> Vec<Step> {
        (1..).zip(cycles).map(|(position, cycle)| Step { cycle, position }).collect()
    }

    #[test]
    fn a_slow_clock_is_drift_and_not_jitter() {
        // 50 ppm slow, and every tenth step 2 us late.
        let model = steps((0..10_000).map(|k| 1000 * k));
        let recorded = steps(
            (0..10_000_u64).map(|k| 7_000_000 + 62_503 * k + k / 8 + if k % 10 == 5 { 2000 } else { 0 }),
        );
        let found = Comparison::of(
            Side { steps: &recorded, clock_hz: 1_000_000_000 },
            Side { steps: &model, clock_hz: 16_000_000 },
            0,
            Tolerance::from_micros(1, 0).expect("a time"),
        )
        .expect("both have steps");
        assert!((found.drift_ppm - 50.0).abs() < 0.2, "{found:?}");
        assert!((found.largest_jitter_s - 2e-6).abs() < 2e-8 && found.outliers == 1000, "{found:?}");
        assert!(found.rms_jitter_s < 1e-8, "{found:?}");
        assert!((found.offset_s - 7e-3).abs() < 1e-9 && !found.is_same());
    }

    #[test]
    fn one_late_step_among_a_thousand_is_neither_drift_nor_jitter() {
        let model = steps((0..1000).map(|k| 16_000 * k));
        for at in [1, 250, 999] {
            // 50 ppm slow, up to 1.5 us late, and one step by 10 ms, with those behind it in their times.
            let late = |k: u64| if k == at { 10_000_000 } else { 500 * (k * 7 % 4) };
            let recorded = steps((0..1000).map(|k| 1_000_050 * k + late(k)));
            let found = Comparison::of(
                Side { steps: &recorded, clock_hz: 1_000_000_000 },
                Side { steps: &model, clock_hz: 16_000_000 },
                0,
                Tolerance::from_micros(1, 0).expect("a time"),
            )
            .expect("both have steps");
            assert!((found.drift_ppm - 50.0).abs() < 0.1, "{found:?}");
            assert!(found.rms_jitter_s < 0.6e-6 && found.outliers == 1, "{found:?}");
            assert_eq!((found.largest.step as u64, found.largest_jitter_s > 9.9e-3), (at, true));
        }
    }

    #[test]
    fn steps_that_lack_or_go_the_other_way_are_told() {
        let model = steps([100, 200, 300, 400].into_iter());
        let side = |steps| Side { steps, clock_hz: 1000 };
        let same = Comparison::of(side(&model), side(&model), 2, Tolerance::ZERO).expect("steps");
        assert!(same.is_same() && same.largest.late_s == 0.0);
        let lacks = Comparison::of(side(&model[..3]), side(&model), 0, Tolerance::ZERO).expect("steps");
        assert_eq!((lacks.compared, lacks.is_same(), lacks.first_difference), (3, false, None));
        let mut back = model.clone();
        (back[2].position, back[3].position) = (1, 2);
        let turned = Comparison::of(side(&back), side(&model), 0, Tolerance::ZERO).expect("steps");
        assert_eq!(turned.first_difference.map(|off| (off.step, off.other_direction)), Some((2, true)));
        assert_eq!(Comparison::of(side(&[]), side(&model), 0, Tolerance::ZERO), None);
        assert_eq!(Comparison::of(side(&model), side(&model), 4, Tolerance::ZERO), None);
    }
}
