//! The two compensations of a sliced move (DESIGN B4), described in [`super`]: the top speed is raised until the rounded
//! slices have enough steps (coarse), then the excess is removed from the end of the plateau and from the tail (fine).

use crate::{
    Curve, MAX_SPEED,
    curves::{
        cosine::Cosine,
        curve::{greater, lesser},
    },
    round_half_up,
    timing::Double,
};
use alloc::vec::Vec;
use core::ops::Range;

pub(super) const NEARLY: f64 = 1e-9;
/// Rounds of the coarse compensation after which its growth is doubled, repeatedly. The paper's moves need two or three.
const PATIENCE: u32 = 1000;

pub(super) struct Slices {
    /// Relative speed at the start of each slice times its length in s.
    weights: Vec<f64>,
    /// Slices of the plateau; empty, at the start of the second half, if there are none.
    plateau: Range<usize>,
    slice_s: f64,
}

/// Number of slices for a duration of `ratio` slices; a rest in the last digits does not count.
pub(super) fn slices_in(ratio: f64) -> u64 {
    let whole = round_half_up(ratio);
    let rest = ratio - whole as f64;
    let more = rest > NEARLY * greater(1.0, ratio);
    whole.unsigned_abs() + u64::from(more || whole == 0)
}

/// floor for nonnegative numbers, tolerant of the last digits.
fn whole_steps(steps: f64) -> u64 {
    (steps + NEARLY) as u64
}

impl Slices {
    pub(super) fn of(exact: &Cosine, count: u64, slice_s: f64) -> Self {
        let (duration_s, ramp_s) = (exact.duration_s(), exact.ramp_s);
        let start_s = |index: usize| index as f64 * slice_s;
        let length_s = |index: usize| {
            let left_s = duration_s - start_s(index);
            lesser(slice_s, left_s)
        };
        let count = count as usize;
        let weights = (0..count).map(|index| exact.part(start_s(index)) * length_s(index)).collect();
        let digits = duration_s * f64::EPSILON * 4.0;
        let in_plateau = |index: &usize| {
            start_s(*index) >= ramp_s - digits && start_s(index + 1) <= duration_s - ramp_s + digits
        };
        let first = (0..count).find(in_plateau).unwrap_or(count / 2);
        let plateau = first..first + (first..count).take_while(in_plateau).count();
        Self { weights, plateau, slice_s }
    }

    fn steps(&self, index: usize, top_speed: f64) -> u64 {
        let weight = self.weights.get(index).copied().unwrap_or(0.0);
        whole_steps(top_speed * if self.plateau.contains(&index) { self.slice_s } else { weight })
    }

    fn sum(&self, top_speed: f64) -> u64 {
        let held = self.plateau.len() as u64 * whole_steps(top_speed * self.slice_s);
        let ramps = (0..self.plateau.start).chain(self.plateau.end..self.weights.len());
        held + ramps.map(|index| self.steps(index, top_speed)).sum::<u64>()
    }

    /// Coarse compensation: n' and its top speed; `None` if no allowed speed is enough.
    pub(super) fn coarse(&self, exact: &Cosine, ramp_s: f64) -> Option<(u64, f64)> {
        let count = exact.steps().unsigned_abs();
        let (mut compensated, mut round) = (count, 0);
        loop {
            let top_speed = compensated as f64 / (exact.duration_s() - ramp_s);
            let missing = count.saturating_sub(self.sum(top_speed));
            if missing == 0 {
                return Some((compensated, top_speed));
            }
            if top_speed > MAX_SPEED {
                return None;
            }
            compensated = compensated.saturating_add(missing << (round / PATIENCE).min(30));
            round += 1;
        }
    }

    /// Fine compensation: the starts of the remaining slices in 106 bits and in f64, the steps before each, and the maximum
    /// rate.
    pub(super) fn fine(&self, top_speed: f64, exact: &Cosine) -> (Vec<Double>, Vec<f64>, Vec<u32>, f64) {
        let all = self.weights.len();
        let mut counts: Vec<u64> = (0..all).map(|index| self.steps(index, top_speed)).collect();
        let held = whole_steps(top_speed * self.slice_s);
        let mut above = counts.iter().sum::<u64>().saturating_sub(exact.steps().unsigned_abs());
        let Range { start, end } = self.plateau;
        for index in (start..end).rev().chain((end..all).rev()).chain((0..start).rev()) {
            let Some(count) = counts.get_mut(index) else { continue };
            let taken = above.min(*count);
            *count -= taken;
            above -= taken;
        }
        let (mut starts_s, mut sums) = (Vec::with_capacity(all + 1), Vec::with_capacity(all + 1));
        let (mut shorter_s, mut sum, mut top_rate) = (0.0, 0, 0.0);
        let (mut exact_starts, mut lost) = (Vec::with_capacity(all + 1), 0);
        let (slice, held_steps) = (Double::decimal(self.slice_s), Double::from(held.max(1)));
        for (index, count) in counts.iter().enumerate() {
            let shortened = self.plateau.contains(&index) && *count < held;
            if !(shortened && *count == 0) {
                starts_s.push(index as f64 * self.slice_s - shorter_s);
                exact_starts.push(slice * Double::from(index as u64 * held - lost) / held_steps);
                sums.push(sum as u32);
            }
            if shortened {
                shorter_s += self.slice_s * ((held - count) as f64 / held as f64);
                lost += held - count;
            }
            if *count > 0 {
                // Rounded down, no slice exceeds the top speed; a shortened one has the plateau's rate.
                let left_s = exact.duration_s() - index as f64 * self.slice_s;
                let length_s = libm::fmin(left_s, self.slice_s);
                let steps = if shortened { held } else { *count };
                top_rate = greater(top_rate, libm::fmin(steps as f64 / length_s, top_speed));
            }
            sum += count;
        }
        starts_s.push(exact.duration_s() - shorter_s);
        exact_starts.push(Double::decimal(exact.duration_s()) - slice * Double::from(lost) / held_steps);
        sums.push(sum as u32);
        (exact_starts, starts_s, sums, top_rate)
    }
}
