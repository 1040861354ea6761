//! Position difference of two runs.
//!
//! Positions are constant between steps, so the difference changes only at steps. Both are 0 before the first step.

use crate::motion::curves::{Band, Window};
use stepscope_peripheral::trace::Step;

/// The steps of a run in another unit.
#[derive(Clone, Copy, Debug)]
pub struct Scaled<'a> {
    pub steps: &'a [Step],
    pub hz: f64,
    pub unit: f64,
}

impl Scaled<'_> {
    fn time_s(&self, index: usize) -> Option<f64> {
        self.steps.get(index).map(|step| step.cycle as f64 / self.hz)
    }

    fn position(&self, steps: usize) -> f64 {
        let last = steps.checked_sub(1).and_then(|last| self.steps.get(last));
        last.map_or(0.0, |step| f64::from(step.position)) * self.unit
    }
}

pub(crate) struct Difference<'a> {
    runs: [Scaled<'a>; 2],
    next: [usize; 2],
}

impl<'a> Difference<'a> {
    pub(crate) fn from(runs: [Scaled<'a>; 2], from_s: f64) -> Self {
        let next = runs.map(|run| run.steps.partition_point(|step| step.cycle as f64 / run.hz <= from_s));
        Self { runs, next }
    }

    fn now(&self) -> f64 {
        let [a, b] = self.positions();
        a - b
    }

    pub(crate) fn positions(&self) -> [f64; 2] {
        let [a, b] = self.runs;
        let [after_a, after_b] = self.next;
        [a.position(after_a), b.position(after_b)]
    }

    pub(crate) fn changes(&mut self, to_s: f64, each: &mut dyn FnMut(f64, [f64; 2])) {
        loop {
            let [a, b] = self.runs;
            let times = [a.time_s(self.next[0]), b.time_s(self.next[1])].map(|t| t.unwrap_or(f64::INFINITY));
            let at = if times[1] < times[0] { times[1] } else { times[0] };
            if at >= to_s || at == f64::INFINITY {
                return;
            }
            for (next, time) in self.next.iter_mut().zip(times) {
                *next += usize::from(time == at);
            }
            each(at, self.positions());
        }
    }
}

/// Minimum and maximum difference per column; NaN outside the common time.
pub fn difference(first: Scaled<'_>, second: Scaled<'_>, common_s: f64, window: Window) -> Band {
    let mut band = Band::new(window.columns);
    let mut positions = Difference::from([first, second], window.start_s);
    for column in 0..window.columns {
        if window.edge_s(column) >= common_s {
            break;
        }
        band.take(column, positions.now());
        positions.changes(window.edge_s(column + 1), &mut |_, [a, b]| band.take(column, a - b));
    }
    band
}

/// The difference of two runs' positions, in their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionError {
    pub largest: f64,
    pub at_s: f64,
    pub rms: f64,
}

/// Compares two runs from 0 to `common_s`, which is above 0.
pub fn compare(first: Scaled<'_>, second: Scaled<'_>, common_s: f64) -> PositionError {
    let mut positions = Difference::from([first, second], 0.0);
    let (mut since_s, mut difference) = (0.0, positions.now());
    let (mut largest, mut at_s, mut square) = (difference, 0.0, 0.0);
    positions.changes(common_s, &mut |time_s, [a, b]| {
        let now = a - b;
        square += difference * difference * (time_s - since_s);
        (since_s, difference) = (time_s, now);
        if libm::fabs(now) > libm::fabs(largest) {
            (largest, at_s) = (now, time_s);
        }
    });
    square += difference * difference * (common_s - since_s);
    PositionError { largest, at_s, rms: libm::sqrt(square / common_s) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    type Rows = &'static [(u64, i32)];

    fn steps(rows: &[(u64, i32)]) -> Vec<Step> {
        rows.iter().map(|&(cycle, position)| Step { cycle, position }).collect()
    }

    /// The position after all steps up to a time.
    fn position(run: Scaled<'_>, time_s: f64) -> f64 {
        let last = run.steps.iter().rev().find(|step| step.cycle as f64 / run.hz <= time_s);
        last.map_or(0.0, |step| f64::from(step.position)) * run.unit
    }

    #[test]
    fn columns_equal_those_of_every_cycle() {
        // Clocks of 1024 Hz and 4096 Hz, so that all times are exact; a step at the same time in both, one a run's only step.
        let rows: [(Rows, Rows); 4] = [
            (&[(1, 1), (5, 2), (9, 1), (30, 2)], &[(4, 1), (22, 2), (23, 1), (36, 2), (80, 3)]),
            (&[], &[(40, -1)]),
            (&[(7, 1)], &[]),
            (&[], &[]),
        ];
        for (first, second) in rows {
            let (first, second) = (steps(first), steps(second));
            let first = Scaled { steps: &first, hz: 1024.0, unit: 0.5 };
            let second = Scaled { steps: &second, hz: 4096.0, unit: 2.0 };
            let common_s = 36.0 / 1024.0;
            let samples: Vec<(f64, f64)> = (0..36 * 4)
                .map(|cycle| {
                    let time_s = f64::from(cycle) / 4096.0;
                    (time_s, position(first, time_s) - position(second, time_s))
                })
                .collect();
            let window = Window { start_s: 2.0 / 1024.0, end_s: 42.0 / 1024.0, columns: 10 };
            let band = difference(first, second, common_s, window);
            for column in 0..window.columns {
                let (from, to) = (window.edge_s(column), window.edge_s(column + 1));
                let before = samples.iter().rev().find(|(t, _)| *t < from);
                let inside = samples.iter().filter(|(t, _)| *t >= from && *t < to);
                let inside = before.into_iter().chain(inside).map(|sample| sample.1);
                if from >= common_s {
                    assert!(band.min[column].is_nan() && band.max[column].is_nan());
                    continue;
                }
                let (min, max) = inside.fold((f64::MAX, f64::MIN), |(a, b), d| (a.min(d), b.max(d)));
                assert_eq!((band.min[column], band.max[column]), (min, max), "{first:?} {second:?} {column}");
            }
            let found = compare(first, second, common_s);
            let (at_s, largest) = samples.iter().copied().fold((0.0, samples[0].1), |max, sample| {
                if sample.1.abs() > max.1.abs() { sample } else { max }
            });
            let square: f64 = samples.iter().map(|sample| sample.1 * sample.1).sum();
            let rms = (square / samples.len() as f64).sqrt();
            assert_eq!((found.largest, found.at_s), (largest, at_s));
            assert!((found.rms - rms).abs() < 1e-12, "{} {rms}", found.rms);
        }
    }
}
