//! Settling time of the supply current after a step (the patent's delta t_p), and its deviation while motors step together
//! (PLANT F8).
//!
//! ```
//! use stepscope_plant::settling::{SHARE, Sample, StepResponse};
//!
//! let samples = [(0, 1.0), (10, 1.0), (20, 3.0), (30, 1.5), (40, 1.1), (50, 1.0)];
//! let samples = samples.map(|(cycle, current)| Sample { cycle, current });
//! let found = StepResponse::of(&samples, 0, 15, 100, SHARE).expect("there are samples");
//! assert_eq!((found.reached, found.settled), (Some(25), Some(15)));
//! ```

use crate::plant::{Observer, Plant};
use alloc::vec::Vec;

/// Settled means within this share of the peak.
pub const SHARE: f64 = 0.2;
/// Step periods of rest before a step, from which the rest current follows.
pub const REST_STEPS: u64 = 10;

/// A reading of the current sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub cycle: u64,
    /// In A, or in codes of the converter; results have the same unit.
    pub current: f64,
}

/// The supply current around one step of a motor at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepResponse {
    pub rest_a: f64,
    pub min_a: f64,
    pub max_a: f64,
    /// Cycles from the rise of STEP to the first sample after the maximum that is at most a share of the peak above rest.
    /// `None` if not within a step period, or if no sample differs from rest.
    pub reached: Option<u64>,
    /// Cycles to the last sample that differs by more than this share. `None` if no sample follows it, or if no sample
    /// differs from rest.
    pub settled: Option<u64>,
}

impl StepResponse {
    /// Measures samples around a rise of STEP in cycle `rise`: from `from` up to it, and `t_step` cycles after it.
    /// `None` without samples on one side.
    pub fn of(samples: &[Sample], from: u64, rise: u64, t_step: u64, share: f64) -> Option<Self> {
        let within = |after: u64, to: u64| {
            samples.iter().filter(move |sample| sample.cycle > after && sample.cycle <= to)
        };
        let rest_a = mean(within(from, rise))?;
        let after: Vec<Sample> = within(rise, rise.saturating_add(t_step)).copied().collect();
        let first = after.first()?;
        let (mut min_a, mut max_a, mut t_max) = (first.current, first.current, 0);
        for (index, sample) in after.iter().enumerate() {
            min_a = min_a.min(sample.current);
            if sample.current > max_a {
                (max_a, t_max) = (sample.current, index);
            }
        }
        let peak = (max_a - rest_a).abs().max((min_a - rest_a).abs());
        let since = |sample: &Sample| sample.cycle - rise;
        let is_back = |sample: &&Sample| peak > 0.0 && sample.current - rest_a <= share * peak;
        let reached = after.iter().skip(t_max).find(is_back).map(since);
        let last_off = after.iter().rposition(|sample| (sample.current - rest_a).abs() > share * peak);
        let settled =
            last_off.filter(|index| index + 1 < after.len()).and_then(|index| after.get(index)).map(since);
        Some(Self { rest_a, min_a, max_a, reached, settled })
    }
}

/// The mean of samples, if there are any. Differences from the first are summed, so that a constant current has no peak.
pub fn mean<'a>(mut samples: impl Iterator<Item = &'a Sample>) -> Option<f64> {
    let first = samples.next()?.current;
    let (sum, count) = samples.fold((0.0, 1_u32), |(sum, count), s| (sum + (s.current - first), count + 1));
    Some(first + sum / f64::from(count))
}

/// Deviation of the supply current while motors step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Mean at rest in A.
    pub rest_a: f64,
    /// Maximum above it, at least 0.
    pub above_a: f64,
    /// Maximum below it, at least 0.
    pub below_a: f64,
}

impl Deviation {
    /// From samples: those up to cycle `first_step` are at rest, those after cycle `from` are measured.
    pub fn of(samples: &[Sample], first_step: u64, from: u64) -> Option<Self> {
        let rest_a = mean(samples.iter().filter(|sample| sample.cycle <= first_step))?;
        let off = samples.iter().filter(|sample| sample.cycle > from).map(|sample| sample.current - rest_a);
        let (below, above_a) = off.fold((0.0_f64, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
        Some(Self { rest_a, above_a, below_a: -below })
    }

    /// The larger of both, in A.
    pub const fn max_a(&self) -> f64 {
        self.above_a.max(self.below_a)
    }
}

/// Records the readings of the current sensor.
#[derive(Clone, Debug, Default)]
pub struct SensorLog {
    pub samples: Vec<Sample>,
    /// Rises of STEP of channel 0.
    pub steps: Vec<u64>,
}

impl Observer for SensorLog {
    fn point(&mut self, plant: &Plant) {
        let current = plant.current_sensor().filtered();
        self.samples.push(Sample { cycle: plant.cycle(), current });
    }

    fn steps(&mut self, cycle: u64, rises: u16, _: u16) {
        if rises & 1 != 0 {
            self.steps.push(cycle);
        }
    }
}
