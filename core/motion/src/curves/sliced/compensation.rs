//! The two compensations of a sliced move (DESIGN B4): the top speed is raised until the rounded slices have enough steps
//! (coarse), then the excess is removed from the end of the plateau and from the tail (fine).

use crate::curves::cosine::Cosine;
use crate::curves::curve::{greater, lesser};
use crate::{Curve, MAX_SPEED, round_half_up, timing::F106};
use alloc::vec::Vec;
use core::ops::Range;

pub(super) const ROUNDING_TOLERANCE: f64 = 1e-9;
/// Rounds of the coarse compensation after which its growth is doubled, repeatedly. The paper's moves need two or three.
const ROUNDS_PER_DOUBLING: u32 = 1000;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct CompensatedSlices {
    /// Start of each slice in s, and the end of the last; rising.
    /// Invariant: at least two entries.
    pub(super) starts_s: Vec<f64>,
    pub(super) exact_starts_s: Vec<F106>,
    /// Steps before each slice without sign, and all steps.
    /// Invariant: as long as `starts_s`, from 0 to the move's steps, not decreasing.
    pub(super) sums: Vec<u32>,
    pub(super) top_rate: f64,
}

pub(super) struct UncompensatedSlices {
    /// Relative speed at the start of each slice times its length in s.
    weights: Vec<f64>,
    /// Slices of the plateau; empty, at the start of the second half, if there are none.
    plateau: Range<usize>,
    slice_s: f64,
}

/// Number of slices for a duration of `ratio` slices; a remainder below the rounding tolerance does not count.
pub(super) fn slices_in(ratio: f64) -> u64 {
    let whole = round_half_up(ratio);
    let has_remainder = ratio - whole as f64 > ROUNDING_TOLERANCE * greater(1.0, ratio);
    whole.unsigned_abs() + u64::from(has_remainder || whole == 0)
}

fn whole_steps(steps: f64) -> u64 {
    (steps + ROUNDING_TOLERANCE) as u64
}

impl UncompensatedSlices {
    pub(super) fn of(exact: &Cosine, count: u64, slice_s: f64) -> Self {
        let (duration_s, ramp_s) = (exact.duration_s(), exact.ramp_s);
        let start_s = |index: usize| index as f64 * slice_s;
        let length_s = |index: usize| {
            let left_s = duration_s - start_s(index);
            lesser(slice_s, left_s)
        };
        let count = count as usize;
        let weights =
            (0..count).map(|index| exact.relative_speed(start_s(index)) * length_s(index)).collect();
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
        let plateau = self.plateau.len() as u64 * whole_steps(top_speed * self.slice_s);
        let ramps = (0..self.plateau.start).chain(self.plateau.end..self.weights.len());
        plateau + ramps.map(|index| self.steps(index, top_speed)).sum::<u64>()
    }

    /// Coarse compensation: n' and its top speed; `None` if no allowed speed is high enough.
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
            compensated = compensated.saturating_add(missing << (round / ROUNDS_PER_DOUBLING).min(30));
            round += 1;
        }
    }

    /// Fine compensation: removes the excess steps, and shortens the plateau accordingly.
    pub(super) fn fine(&self, top_speed: f64, exact: &Cosine) -> CompensatedSlices {
        let counts = self.without_excess(top_speed, exact.steps().unsigned_abs());
        let plateau_steps = whole_steps(top_speed * self.slice_s);
        let (exact_slice_s, divisor) = (F106::decimal(self.slice_s), F106::from(plateau_steps.max(1)));
        let (mut starts_s, mut exact_starts_s, mut sums) = (Vec::new(), Vec::new(), Vec::new());
        let (mut lost_s, mut lost_steps, mut sum, mut top_rate) = (0.0, 0, 0, 0.0);
        for (index, count) in counts.iter().enumerate() {
            let in_plateau = self.plateau.contains(&index);
            let missing = if in_plateau { plateau_steps - count } else { 0 };
            if !in_plateau || *count > 0 {
                let steps_at_top = F106::from(index as u64 * plateau_steps - lost_steps);
                starts_s.push(index as f64 * self.slice_s - lost_s);
                exact_starts_s.push(exact_slice_s * steps_at_top / divisor);
                sums.push(sum as u32);
            }
            lost_s += self.slice_s * (missing as f64 / plateau_steps as f64);
            lost_steps += missing;
            if *count > 0 {
                // A shortened slice has the plateau's rate. Steps are rounded down, so no rate exceeds the top speed.
                let length_s = lesser(exact.duration_s() - index as f64 * self.slice_s, self.slice_s);
                top_rate = greater(top_rate, lesser((count + missing) as f64 / length_s, top_speed));
            }
            sum += count;
        }
        starts_s.push(exact.duration_s() - lost_s);
        let lost = exact_slice_s * F106::from(lost_steps) / divisor;
        exact_starts_s.push(F106::decimal(exact.duration_s()) - lost);
        sums.push(sum as u32);
        CompensatedSlices { starts_s, exact_starts_s, sums, top_rate }
    }

    /// Steps of each slice without those above `steps`: they are removed from the end of the plateau, then of the tail, then
    /// of the first ramp.
    fn without_excess(&self, top_speed: f64, steps: u64) -> Vec<u64> {
        let mut counts: Vec<u64> =
            (0..self.weights.len()).map(|index| self.steps(index, top_speed)).collect();
        let mut excess = counts.iter().sum::<u64>().saturating_sub(steps);
        let Range { start, end } = self.plateau;
        for index in (start..end).rev().chain((end..counts.len()).rev()).chain((0..start).rev()) {
            let Some(count) = counts.get_mut(index) else { continue };
            let removed = excess.min(*count);
            *count -= removed;
            excess -= removed;
        }
        counts
    }
}
