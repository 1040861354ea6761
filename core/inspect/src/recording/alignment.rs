//! Recorded steps compared with matched planned steps.
//!
//! ```text
//! recorded     |   |  | | |        lateness: time since the aligned step, recorded minus planned
//! plan         |   | |  | |        drift: slope of the straight line through most latenesses over time
//!              ^ aligned           jitter: lateness minus this line
//! ```
//!
//! Clocks differ by tens of ppm, so drift and jitter are separate. Outliers affect neither drift nor RMS jitter.
//!
//! ```
//! use stepscope_inspect::recording::{alignment::{Alignment, Side}, tolerance::Tolerance};
//! # use stepscope_inspect::trace::stored_run::StoredRun;
//! # let mut recording = StoredRun::default();
//! # stepscope_sim::Experiment::from_json("{}").expect("the default motion").run(&mut recording);
//! # let plan = stepscope_peripheral::trace::steps(&recording.trace, 0);
//! // The recorded steps are those of the plan without one.
//! let mut recorded = plan.clone();
//! recorded.remove(2000);
//! let side = |steps| Side { steps, clock_hz: 16_000_000, values: &[] };
//! let found = Alignment::of(side(&recorded), side(&plan), None).expect("both have steps");
//! assert_eq!(found.comparison(Tolerance::ZERO).missing, 1);
//! ```

use super::{drift::Drift, matching::Matching, tolerance::Tolerance};
use serde::Serialize;

pub use super::compared_data::{ExactTimes, Side};

/// The deviation of a recorded step from its planned step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Deviation {
    pub step: usize,
    pub recorded_step: usize,
    pub recorded_s: f64,
    pub late_s: f64,
    pub other_direction: bool,
    pub other_value: bool,
}

/// A recording compared with a plan. Times are in s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Comparison {
    pub recorded: usize,
    pub model: usize,
    pub compared: usize,
    pub missing: usize,
    pub extra: usize,
    /// The recording's time less the plan's at the aligned step.
    pub offset_s: f64,
    pub largest: Deviation,
    pub rms_s: f64,
    pub mean_s: f64,
    pub drift_ppm: f64,
    pub largest_jitter_s: f64,
    pub rms_jitter_s: f64,
    pub outliers: usize,
    pub first_difference: Option<Deviation>,
    /// Matched steps that are late or in the other direction.
    pub differing: usize,
    pub other_values: usize,
}

impl Comparison {
    /// Whether the recording equals the plan within the tolerance.
    pub const fn is_same(&self) -> bool {
        self.differing == 0 && self.missing == 0 && self.extra == 0 && self.other_values == 0
    }
}

/// Matched steps, and an instant that both sides share.
#[derive(Clone, Debug)]
pub struct Alignment<'a> {
    pub recorded: Side<'a>,
    pub model: Side<'a>,
    pub matching: Matching,
    /// The planned and the recorded step of the shared instant.
    pub aligned: (usize, usize),
    /// Times of the recorded steps where cycles would round them.
    pub exact: Option<&'a ExactTimes>,
}

impl<'a> Alignment<'a> {
    /// Matches the steps. The shared instant is planned step `aligned`, or the first match; `None` without it.
    pub fn of(recorded: Side<'a>, model: Side<'a>, aligned: Option<usize>) -> Option<Self> {
        let matching = Matching::of(recorded, model);
        let aligned = match aligned {
            Some(step) => (step, matching.recorded(step)?),
            None => matching.pair(0)?,
        };
        Some(Self { recorded, model, matching, aligned, exact: None })
    }

    /// The unit of recorded times: numerator and denominator, in s.
    fn recorded_unit(&self) -> (u64, u64) {
        self.exact.map_or((1, self.recorded.clock_hz.max(1).into()), |exact| exact.base.parts())
    }

    /// Lateness of a matched step, exactly, in units of 1/(denominator of the recorded unit * clock of the plan) s.
    fn units(&self, index: usize) -> Option<i128> {
        let (step, recorded_step) = self.matching.pair(index)?;
        let due = self.model.since(self.aligned.0, step)?;
        let came = match self.exact {
            Some(exact) => {
                let tick = |step: usize| exact.ticks.get(step).map(|tick| i128::from(*tick));
                tick(recorded_step)? - tick(self.aligned.1)?
            }
            None => self.recorded.since(self.aligned.1, recorded_step)?,
        };
        let (numerator, denominator) = self.recorded_unit();
        let came = came.saturating_mul(numerator.into()).saturating_mul(self.model.clock_hz.into());
        Some(came.saturating_sub(due.saturating_mul(denominator.into())))
    }

    pub fn deviation(&self, index: usize) -> Option<Deviation> {
        let Self { recorded, model, .. } = self;
        let (step, recorded_step) = self.matching.pair(index)?;
        let (_, denominator) = self.recorded_unit();
        Some(Deviation {
            step,
            recorded_step,
            recorded_s: recorded.steps.get(recorded_step)?.cycle as f64 / f64::from(recorded.clock_hz.max(1)),
            // Exact up to the one division.
            late_s: self.units(index)? as f64 / (denominator as f64 * f64::from(model.clock_hz.max(1))),
            other_direction: recorded.direction(recorded_step) != model.direction(step),
            other_value: recorded.values.get(recorded_step) != model.values.get(step),
        })
    }

    /// Whether match `index` is early or late by more than `within`.
    pub fn is_late(&self, index: usize, within: Tolerance) -> bool {
        let (_, denominator) = self.recorded_unit();
        let max = within.units(denominator, self.model.clock_hz.into());
        self.units(index).is_none_or(|units| units.unsigned_abs() > max)
    }

    /// Compares; a step that is off by exactly `within` is not different.
    pub fn comparison(&self, within: Tolerance) -> Comparison {
        let (recorded, model) = (self.recorded, self.model);
        let compared = self.matching.len();
        let seconds = |side: Side<'_>, index: usize| {
            let cycle = side.steps.get(index).map_or(0, |step| step.cycle);
            cycle as f64 / f64::from(side.clock_hz.max(1))
        };
        let aligned = Deviation {
            step: self.aligned.0,
            recorded_step: self.aligned.1,
            recorded_s: seconds(recorded, self.aligned.1),
            late_s: 0.0,
            other_direction: recorded.direction(self.aligned.1) != model.direction(self.aligned.0),
            other_value: recorded.values.get(self.aligned.1) != model.values.get(self.aligned.0),
        };
        let mut found = Comparison {
            recorded: recorded.steps.len(),
            model: model.steps.len(),
            compared,
            missing: model.steps.len() - compared,
            extra: recorded.steps.len() - compared,
            offset_s: aligned.recorded_s - seconds(model, self.aligned.0),
            largest: aligned,
            ..Comparison::default()
        };
        let n = compared as f64;
        let (mut sum, mut square) = (0.0, 0.0);
        for (index, deviation) in (0..compared).filter_map(|index| Some((index, self.deviation(index)?))) {
            sum += deviation.late_s;
            square += deviation.late_s * deviation.late_s;
            if libm::fabs(deviation.late_s) > libm::fabs(found.largest.late_s) {
                found.largest = deviation;
            }
            found.other_values += usize::from(deviation.other_value);
            if deviation.other_direction || self.is_late(index, within) {
                found.differing += 1;
                found.first_difference = found.first_difference.or(Some(deviation));
            }
        }
        (found.mean_s, found.rms_s) = (sum / n, libm::sqrt(square / n));
        let cycle_s = 1.0 / f64::from(recorded.clock_hz.min(model.clock_hz).max(1));
        let event = |index| self.deviation(index).map(|found| (self.model_s(found.step), found.late_s));
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
        found
    }

    fn model_s(&self, step: usize) -> f64 {
        self.model.since(self.aligned.0, step).unwrap_or(0) as f64 / f64::from(self.model.clock_hz.max(1))
    }

    /// The due time of a planned step in s of the recording, from the nearest matched step.
    pub(super) fn due_s(&self, step: usize) -> f64 {
        let runs = self.matching.runs();
        let before = runs.partition_point(|run| run.model <= step).checked_sub(1);
        let near = match before.and_then(|before| runs.get(before)) {
            Some(run) => {
                let within = (step - run.model).min(run.count - 1);
                (run.model + within, run.recorded + within)
            }
            None => runs.first().map_or(self.aligned, |run| (run.model, run.recorded)),
        };
        let came = self.recorded.steps.get(near.1).map_or(0, |step| step.cycle) as f64;
        came / f64::from(self.recorded.clock_hz.max(1)) + self.model_s(step) - self.model_s(near.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use stepscope_capture::timebase::Timebase;
    use stepscope_peripheral::trace::Step;

    fn steps(cycles: impl Iterator<Item = u64>) -> Vec<Step> {
        (1..).zip(cycles).map(|(position, cycle)| Step { cycle, position }).collect()
    }

    /// Recorded at 1 GHz, planned at 16 MHz; 1 us is allowed.
    fn compared(recorded: &[Step], model: &[Step]) -> Comparison {
        let recorded = Side { steps: recorded, clock_hz: 1_000_000_000, values: &[] };
        let model = Side { steps: model, clock_hz: 16_000_000, values: &[] };
        let within = Tolerance::from_micros(1, 0).expect("a time");
        Alignment::of(recorded, model, None).expect("both have steps").comparison(within)
    }

    #[test]
    fn a_slow_clock_is_drift_and_not_jitter() {
        // 50 ppm slow, and every tenth step 2 us late.
        let model = steps((0..10_000).map(|k| 1000 * k));
        let recorded = steps(
            (0..10_000_u64).map(|k| 7_000_000 + 62_503 * k + k / 8 + if k % 10 == 5 { 2000 } else { 0 }),
        );
        let found = compared(&recorded, &model);
        assert!((found.drift_ppm - 50.0).abs() < 0.2, "{found:?}");
        assert!((found.largest_jitter_s - 2e-6).abs() < 2e-8 && found.outliers == 1000, "{found:?}");
        assert!(found.rms_jitter_s < 1e-8, "{found:?}");
        assert!((found.offset_s - 7e-3).abs() < 1e-9 && !found.is_same());
    }

    #[test]
    fn one_late_step_among_a_thousand_is_neither_drift_nor_jitter() {
        let model = steps((0..1000).map(|k| 16_000 * k));
        for at in [1, 250, 999] {
            // 50 ppm slow, up to 1.5 us late, and one step by 0.9 ms.
            let late = |k: u64| if k == at { 900_000 } else { 500 * (k * 7 % 4) };
            let recorded = steps((0..1000).map(|k| 1_000_050 * k + late(k)));
            let found = compared(&recorded, &model);
            assert!((found.drift_ppm - 50.0).abs() < 0.1, "{found:?}");
            assert!(found.rms_jitter_s < 0.6e-6 && found.outliers == 1, "{found:?}");
            assert_eq!((found.largest.step as u64, found.largest_jitter_s > 0.8e-3), (at, true));
            assert_eq!((found.missing, found.extra), (0, 0));
        }
    }

    #[test]
    fn drift_and_jitter_are_of_the_steps_that_both_have() {
        let model = steps((0..3200).map(|k| 16_000 * k));
        let recorded = steps((0..3200).filter(|k| *k != 2000).map(|k| 1_000_050 * k));
        let found = compared(&recorded, &model);
        assert_eq!((found.compared, found.missing, found.extra), (3199, 1, 0));
        assert!((found.drift_ppm - 50.0).abs() < 0.01 && found.largest_jitter_s < 1e-9, "{found:?}");
    }

    #[test]
    fn exactly_the_tolerance_is_accepted() {
        // 16 MHz and 1 MHz: 20 us are 320 cycles; 20.0625 us one more.
        let recorded = steps([0, 1020, 2000, 2980].into_iter());
        for (last, differing) in [(48_000, 0), (48_001, 1), (47_359, 1)] {
            let model = steps([0, 16_000, 32_000, last].into_iter());
            let sides = |steps, clock_hz| Side { steps, clock_hz, values: &[] };
            let found = Alignment::of(sides(&recorded, 1_000_000), sides(&model, 16_000_000), None);
            let found = found.expect("steps").comparison(Tolerance::from_micros(20, 0).expect("a time"));
            assert_eq!(found.differing, differing, "{last}: {found:?}");
        }
    }

    #[test]
    fn exact_times_are_compared_in_ticks_of_the_file() {
        // In ps: 20 us, 1 ps more, and 1 ps less than 20 us early. A clock of 1 GHz would round all three to 20 us.
        let ticks = alloc::vec![0, 1_020_000_000, 2_020_000_001, 2_980_000_001];
        let recorded = steps(ticks.iter().map(|tick| tick / 1000));
        let model = steps([0, 1_000_000, 2_000_000, 3_000_000].into_iter());
        let sides = |steps, clock_hz| Side { steps, clock_hz, values: &[] };
        let exact = ExactTimes { ticks, base: Timebase::new(1, 1_000_000_000_000).expect("a unit") };
        let mut found = Alignment::of(sides(&recorded, 1_000_000_000), sides(&model, 1_000_000_000), None)
            .expect("steps");
        let within = Tolerance::from_micros(20, 0).expect("a time");
        assert_eq!(found.comparison(within).differing, 0);
        found.exact = Some(&exact);
        let compared = found.comparison(within);
        assert_eq!((compared.differing, compared.first_difference.map(|off| off.step)), (1, Some(2)));
        assert!((compared.largest.late_s - 20.000_001e-6).abs() < 1e-15, "{compared:?}");
    }

    #[test]
    fn missing_steps_and_wrong_directions_are_reported() {
        let model = steps([100, 200, 300, 400].into_iter());
        let side = |steps| Side { steps, clock_hz: 1000, values: &[] };
        let of = |recorded, aligned| Alignment::of(side(recorded), side(&model), aligned);
        let compared = |recorded, aligned| of(recorded, aligned).expect("steps").comparison(Tolerance::ZERO);
        let same = compared(&model, Some(2));
        assert!(same.is_same() && same.largest.late_s == 0.0);
        let missing = compared(&model[..3], None);
        assert_eq!((missing.compared, missing.missing, missing.is_same()), (3, 1, false));
        assert_eq!(missing.first_difference, None);
        let mut back = model.clone();
        (back[2].position, back[3].position) = (1, 2);
        let turned = compared(&back, None);
        assert_eq!(turned.first_difference.map(|off| (off.step, off.other_direction)), Some((2, true)));
        assert!(of(&[], None).is_none() && of(&model, Some(4)).is_none());
    }
}
