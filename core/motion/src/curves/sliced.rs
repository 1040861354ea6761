//! Cosine S-curve in slices of whole steps, as in the paper (DESIGN B4, `sliced`; Song, Han, Lu 2021, 2.2).
//!
//! Slice i of length TS has floor(f(i*TS)*TS) steps, where f is the cosine S-curve of n' steps ([`Cosine`]). Rounding down
//! leaves too few steps, so the paper compensates in two stages:
//!
//! ```text
//! coarse n' grows by n - N, which raises f_max = n'/(T - t_s), until N, the sum of all slices, reaches n
//! fine   the excess steps are removed from the end of the plateau, which shortens it: the time error;
//!        without a plateau they are removed from the end of the tail, so its last slices have no steps
//! ```
//!
//! The steps within a slice are equidistant, so the curve is a polyline that crosses its half-integers at the steps.

mod compensation;

use crate::curves::{cosine::Cosine, curve::signed};
use crate::format::{grouped, ramp_up_to};
use crate::timing::{CycleTime, F106, IsDueBefore, MAX_ERROR, ROUNDING, Run, Runs, Schedule};
use crate::{Curve, Peaks};
use alloc::{boxed::Box, format, string::String, vec::Vec};
use compensation::{CompensatedSlices, ROUNDING_TOLERANCE, UncompensatedSlices, slices_in};

/// A cosine S-curve in slices of whole steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Sliced {
    exact: Cosine,
    compensated_steps: u64,
    slices: CompensatedSlices,
}

/// A slice of a move. Its steps have no sign.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slice {
    pub from_s: f64,
    pub to_s: f64,
    /// Steps of the move before the slice.
    pub steps_before: u32,
    pub steps: u32,
}

impl Slice {
    fn rate(self) -> f64 {
        f64::from(self.steps) / (self.to_s - self.from_s)
    }
}

/// Why a move cannot be sliced.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum NotSliced {
    /// It needs more slices than allowed.
    Slices { needed: u64 },
    /// At its top speed in steps/s a slice has less than one step.
    TooShort { rate: f64 },
    /// The slices cannot contain all steps, however high the top speed.
    TooFew { slices: u64 },
}

/// Time error of a sliced move; negative is early.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeError {
    /// End of the move minus the requested end.
    pub end_s: f64,
    /// The same in units of the requested duration: the paper's time error.
    pub relative: f64,
    /// Time of the last step minus its time on the exact curve.
    pub last_step_s: f64,
}

impl Sliced {
    /// `steps` (left negative, not 0, at most 1e9) in `duration_s` > 0 with ramps of `ramp_s`, from 0 to half of it, in
    /// slices of `slice_s` > 0, of which the last may be shorter.
    /// Errors: [`NotSliced`] if there would be more than `max_slices`, or if they cannot contain the steps.
    pub fn new(
        steps: i64,
        duration_s: f64,
        ramp_s: f64,
        slice_s: f64,
        max_slices: u64,
    ) -> Result<Self, NotSliced> {
        let exact = Cosine::new(steps, duration_s, ramp_s);
        let needed = slices_in(duration_s / slice_s);
        if needed > max_slices {
            return Err(NotSliced::Slices { needed });
        }
        let rate = exact.top_speed();
        if rate * slice_s < 1.0 - ROUNDING_TOLERANCE {
            return Err(NotSliced::TooShort { rate });
        }
        let uncompensated = UncompensatedSlices::of(&exact, needed, slice_s);
        let (compensated_steps, top_speed) =
            uncompensated.coarse(&exact, ramp_s).ok_or(NotSliced::TooFew { slices: needed })?;
        let slices = uncompensated.fine(top_speed, &exact);
        let CompensatedSlices { starts_s, sums, .. } = &slices;
        debug_assert!(starts_s.len() >= 2 && starts_s.is_sorted_by(|a, b| a < b), "a slice without a length");
        debug_assert!(sums.len() == starts_s.len() && sums.first() == Some(&0) && sums.is_sorted());
        debug_assert!(
            sums.last().copied().map(u64::from) == Some(steps.unsigned_abs()),
            "the slices do not contain all steps"
        );
        Ok(Self { exact, compensated_steps, slices })
    }

    /// The curve without slices.
    pub fn exact(&self) -> &Cosine {
        &self.exact
    }

    /// n', the steps of the compensated curve.
    pub fn compensated_steps(&self) -> u64 {
        self.compensated_steps
    }

    /// Maximum rate of a slice in steps/s, floor(f*TS)/TS. It is computed from steps and length, because the difference of two
    /// late times has lost digits.
    pub fn top_rate(&self) -> f64 {
        self.slices.top_rate
    }

    /// Number of slices, without those that were removed from the plateau.
    pub fn slice_count(&self) -> u64 {
        self.starts_s().len().saturating_sub(1) as u64
    }

    /// The slices in the order of their times.
    pub fn slices(&self) -> impl Iterator<Item = Slice> + '_ {
        (0..self.starts_s().len()).map_while(|index| self.slice(index))
    }

    /// How much earlier or later the move ends than requested.
    pub fn time_error(&self) -> TimeError {
        let requested_s = self.exact.duration_s();
        let end_s = self.duration_s() - requested_s;
        let last = self.exact.steps().unsigned_abs() as f64 - 0.5;
        let last_step_s = self.time_s(last) - self.exact.time_s(last);
        TimeError { end_s, relative: end_s / requested_s, last_step_s }
    }

    fn starts_s(&self) -> &[f64] {
        &self.slices.starts_s
    }

    /// Index of the slice in which the curve passes `position`, in steps without sign. At the end it is no slice's.
    fn slice_index(&self, position: f64) -> usize {
        self.slices.sums.partition_point(|sum| f64::from(*sum) <= position).saturating_sub(1)
    }

    fn last_index_with_steps(&self) -> usize {
        let sums = &self.slices.sums;
        sums.partition_point(|sum| Some(sum) < sums.last()).saturating_sub(1)
    }

    fn slice(&self, index: usize) -> Option<Slice> {
        let (from_s, to_s) = (*self.starts_s().get(index)?, *self.starts_s().get(index + 1)?);
        let sums = &self.slices.sums;
        let (steps_before, steps_after) = (*sums.get(index)?, *sums.get(index + 1)?);
        Some(Slice { from_s, to_s, steps_before, steps: steps_after - steps_before })
    }

    fn slice_at(&self, t: f64) -> Option<Slice> {
        let after = self.starts_s().partition_point(|start_s| *start_s <= t);
        let last = self.starts_s().len().saturating_sub(2);
        self.slice(after.saturating_sub(1).min(last))
    }
}

impl Schedule for Sliced {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        let duration_s = self.slices.exact_starts_s.last().copied().unwrap_or_default();
        CycleTime::of(duration_s * f64::from(clock_hz))
    }

    /// One run per slice, because each has its own rate.
    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let (clock, max_error) = (f64::from(clock_hz), self.max_error_s() * f64::from(clock_hz));
        Box::new(self.slices().map(move |Slice { from_s, to_s, steps, .. }| {
            let interval_s = (to_s - from_s) / f64::from(steps.max(1));
            Run::new(steps.into(), self.steps() >= 0, max_error, move |step| {
                (from_s + (step + 0.5) * interval_s) * clock
            })
        }))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        Box::new(move |k, since| {
            let index = self.slice_index(k as f64 - 0.5);
            let (Some(&[from_s, to_s]), Some(slice)) =
                (self.slices.exact_starts_s.get(index..index + 2), self.slice(index))
            else {
                return false;
            };
            let half_intervals = F106::from(2 * (k - u64::from(slice.steps_before)) - 1);
            let step_s = from_s + (to_s - from_s) * half_intervals / f64::from(2 * slice.steps.max(1));
            since > step_s * f64::from(clock_hz)
        })
    }

    /// Each shortened slice adds roundings to the starts of the slices after it.
    fn max_error_s(&self) -> f64 {
        (MAX_ERROR + 4.0 * ROUNDING * self.starts_s().len() as f64) * self.duration_s()
    }
}

impl Curve for Sliced {
    fn duration_s(&self) -> f64 {
        self.starts_s().last().copied().unwrap_or(0.0)
    }

    fn steps(&self) -> i64 {
        self.exact.steps()
    }

    fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s() {
            return self.steps() as f64;
        }
        if t <= 0.0 {
            return 0.0;
        }
        let Some(Slice { from_s, to_s, steps_before, steps }) = self.slice_at(t) else { return 0.0 };
        let part = (t - from_s) / (to_s - from_s);
        signed(self.steps(), f64::from(steps_before) + f64::from(steps) * part)
    }

    fn speed(&self, t: f64) -> f64 {
        signed(self.steps(), self.slice_at(t).map_or(0.0, Slice::rate))
    }

    /// The speed jumps between slices; acceleration and jerk are 0.
    fn peaks(&self) -> Peaks {
        Peaks::of_rates(None, self.slices().map(Slice::rate))
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        let inside = 1..self.starts_s().len().saturating_sub(1);
        self.starts_s().get(inside).map_or_else(Vec::new, <[f64]>::to_vec)
    }

    fn time_s(&self, position: f64) -> f64 {
        let index = self.slice_index(position).min(self.last_index_with_steps());
        let slice = self.slice(index).unwrap_or_default();
        let steps = position - f64::from(slice.steps_before);
        slice.from_s + steps * (slice.to_s - slice.from_s) / f64::from(slice.steps.max(1))
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        let error = self.time_error();
        let (slices, peak) = (self.slice_count(), self.peaks().speed);
        // Not a negation, which would print -0.
        let (early_ms, early_percent) = (0.0 - 1e3 * error.end_s, 0.0 - 100.0 * error.relative);
        format!(
            "peak {} steps/s, {} slices of a curve of {} steps; ends {early_ms:.3} ms early, time error \
             {early_percent:.2} % (exact: 0), \
             the last step {:.3} ms {}{}",
            grouped(peak),
            grouped(slices as f64),
            grouped(self.compensated_steps as f64),
            1e3 * libm::fabs(error.last_step_s),
            if error.last_step_s > 0.0 { "late" } else { "early" },
            ramp_up_to(self.exact.longest_ramp_s(limit_steps_s), self.exact.duration_s())
        )
    }
}

#[cfg(test)]
mod tests;
