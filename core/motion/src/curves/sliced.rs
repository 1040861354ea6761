//! Cosine S-curve in slices of whole steps, as in the paper (DESIGN B4, `sliced`; Song, Han, Lu 2021, 2.2).
//!
//! Slice i of length TS has floor(f(i*TS)*TS) steps, where f is the cosine S-curve of n' steps ([`Cosine`]). Rounded down
//! they are too few, so the paper compensates in two stages:
//!
//! ```text
//! coarse n' grows by n - N, which raises f_max = n'/(T - t_s), until N, the sum of all slices, reaches n
//! fine   the excess steps are removed from the end of the plateau, which shortens it: the time error;
//!        without a plateau the last steps of the tail are removed, so its last slices stand still
//! ```
//!
//! The steps within a slice are equidistant, so the curve is a polyline that crosses its half-integers at the steps.

mod compensation;

use crate::{
    Curve, Peaks,
    curves::{cosine::Cosine, curve::signed},
    format::{grouped, ramp_up_to},
    timing::{CycleTime, Double, IsDueBefore, MAX_ERROR, ROUNDING, Run, Runs, Schedule},
};
use alloc::{boxed::Box, format, string::String, vec::Vec};
use compensation::{NEARLY, Slices, slices_in};

#[derive(Clone, Debug, PartialEq)]
pub struct Sliced {
    exact: Cosine,
    compensated: u64,
    /// Start of each slice in s, and the end of the last; rising.
    /// Invariant: at least two entries.
    starts_s: Vec<f64>,
    exact_starts: Vec<Double>,
    /// Steps before each slice without sign, and all steps.
    /// Invariant: as long as `starts_s`, from 0 to the move's steps, not decreasing.
    sums: Vec<u32>,
    top_rate: f64,
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
    /// Time of the last step minus that of the exact curve.
    pub last_step_s: f64,
}

impl Sliced {
    /// `steps` (left negative, not 0, at most 1e9) in `duration_s` > 0 with ramps of `ramp_s`, from 0 to half of it, in
    /// slices of `slice_s` > 0, of which the last may be shorter.
    ///
    /// # Errors
    /// [`NotSliced`] if there would be more than `max_slices`, or if they cannot contain the steps.
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
        if rate * slice_s < 1.0 - NEARLY {
            return Err(NotSliced::TooShort { rate });
        }
        let slices = Slices::of(&exact, needed, slice_s);
        let (compensated, top_speed) =
            slices.coarse(&exact, ramp_s).ok_or(NotSliced::TooFew { slices: needed })?;
        let (exact_starts, starts_s, sums, top_rate) = slices.fine(top_speed, &exact);
        debug_assert!(starts_s.len() >= 2 && starts_s.is_sorted_by(|a, b| a < b), "a slice without a length");
        debug_assert!(sums.len() == starts_s.len() && sums.first() == Some(&0) && sums.is_sorted());
        debug_assert!(
            sums.last().copied().map(u64::from) == Some(steps.unsigned_abs()),
            "the slices do not contain all steps"
        );
        Ok(Self { exact, compensated, starts_s, exact_starts, sums, top_rate })
    }

    #[must_use]
    pub fn exact(&self) -> &Cosine {
        &self.exact
    }

    /// n', the steps of the compensated curve.
    #[must_use]
    pub fn compensated_steps(&self) -> u64 {
        self.compensated
    }

    /// Maximum rate of a slice in steps/s, floor(f*TS)/TS, from its steps and length: the difference of two late times
    /// has lost digits.
    #[must_use]
    pub fn top_rate(&self) -> f64 {
        self.top_rate
    }

    /// Number of slices without those that the plateau lost.
    #[must_use]
    pub fn slice_count(&self) -> u64 {
        self.starts_s.len().saturating_sub(1) as u64
    }

    /// Start and end in s and steps without sign of each slice.
    pub fn slices(&self) -> impl Iterator<Item = (f64, f64, u32)> + '_ {
        let ends = self.starts_s.iter().skip(1).zip(self.sums.iter().skip(1));
        let starts = self.starts_s.iter().zip(&self.sums);
        starts.zip(ends).map(|((from, before), (to, after))| (*from, *to, after - before))
    }

    #[must_use]
    pub fn time_error(&self) -> TimeError {
        let requested_s = self.exact.duration_s();
        let end_s = self.duration_s() - requested_s;
        let last = self.exact.steps().unsigned_abs() as f64 - 0.5;
        let last_step_s = self.time_s(last) - self.exact.time_s(last);
        TimeError { end_s, relative: end_s / requested_s, last_step_s }
    }

    fn slice_of(&self, position: f64) -> usize {
        self.sums.partition_point(|sum| f64::from(*sum) <= position).saturating_sub(1)
    }

    fn slice(&self, index: usize) -> Option<(f64, f64, u32, u32)> {
        let (from, to) = (self.starts_s.get(index)?, self.starts_s.get(index + 1)?);
        let (before, after) = (self.sums.get(index)?, self.sums.get(index + 1)?);
        Some((*from, *to, *before, after - before))
    }

    fn at(&self, t: f64) -> Option<(f64, f64, u32, u32)> {
        let after = self.starts_s.partition_point(|start_s| *start_s <= t);
        let last = self.starts_s.len().saturating_sub(2);
        self.slice(after.saturating_sub(1).min(last))
    }
}

impl Schedule for Sliced {
    fn length(&self, clock_hz: u32) -> CycleTime {
        let duration_s = self.exact_starts.last().copied().unwrap_or_default();
        CycleTime::of(duration_s * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let (clock, max_error) = (f64::from(clock_hz), self.max_error_s() * f64::from(clock_hz));
        Box::new(self.slices().map(move |(from, to, count)| {
            let each = (to - from) / f64::from(count.max(1));
            Run::new(count.into(), self.steps() >= 0, max_error, move |step| {
                (from + (step + 0.5) * each) * clock
            })
        }))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        Box::new(move |k, since| {
            let index = self.slice_of(k as f64 - 0.5);
            let (Some(&[from, to]), Some((_, _, before, count))) =
                (self.exact_starts.get(index..index + 2), self.slice(index))
            else {
                return false;
            };
            let halves = Double::from(2 * (k - u64::from(before)) - 1);
            let step_s = from + (to - from) * halves / f64::from(2 * count.max(1));
            since > step_s * f64::from(clock_hz)
        })
    }

    /// Each shortened slice adds its roundings to those before.
    fn max_error_s(&self) -> f64 {
        (MAX_ERROR + 4.0 * ROUNDING * self.starts_s.len() as f64) * self.duration_s()
    }
}

impl Curve for Sliced {
    fn duration_s(&self) -> f64 {
        self.starts_s.last().copied().unwrap_or(0.0)
    }

    fn steps(&self) -> i64 {
        self.exact.steps()
    }

    fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s() {
            return self.steps() as f64;
        }
        let Some((from, to, before, count)) = self.at(t).filter(|_| t > 0.0) else { return 0.0 };
        signed(self.steps(), f64::from(before) + f64::from(count) * ((t - from) / (to - from)))
    }

    fn speed(&self, t: f64) -> f64 {
        signed(self.steps(), self.at(t).map_or(0.0, |(from, to, _, count)| f64::from(count) / (to - from)))
    }

    fn acceleration(&self, _: f64) -> f64 {
        0.0
    }

    /// The speed jumps between slices; acceleration and jerk are 0.
    fn peaks(&self) -> Peaks {
        Peaks::of_rates(None, self.slices().map(|(from, to, count)| f64::from(count) / (to - from)))
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        let inside = 1..self.starts_s.len().saturating_sub(1);
        self.starts_s.get(inside).map_or_else(Vec::new, <[f64]>::to_vec)
    }

    fn time_s(&self, position: f64) -> f64 {
        let (from, to, before, count) = self.slice(self.slice_of(position)).unwrap_or_default();
        from + (position - f64::from(before)) * (to - from) / f64::from(count.max(1))
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        let error = self.time_error();
        let (slices, peak) = (self.slice_count(), self.peaks().speed);
        format!(
            "peak {} steps/s, {} slices of a curve of {} steps; ends {:.3} ms early, time error {:.2} % (exact: 0), \
             the last step {:.3} ms {}{}",
            grouped(peak),
            grouped(slices as f64),
            grouped(self.compensated as f64),
            0.0 - 1e3 * error.end_s,
            0.0 - 100.0 * error.relative,
            1e3 * libm::fabs(error.last_step_s),
            if error.last_step_s > 0.0 { "late" } else { "early" },
            ramp_up_to(self.exact.longest_ramp_s(limit_steps_s), self.exact.duration_s())
        )
    }
}

#[cfg(test)]
mod tests;
