//! Runs: the steps of a move in one direction by one formula (DESIGN B1).
//!
//! ```text
//! position  |    .---.              a move is one run or several, one after another:
//!           |   /     \             trapezoid, cosine, …: one; sine: one per half period;
//!           | _/       \_           points: one per piece; staircase: one per row
//!             run 1   run 2
//! ```
//!
//! A curve computes the times of its steps in f64 with their maximum error, and decides in 106 bits whether a step is due
//! before an edge ([`Schedule`]). Shared code rounds the times (`step_loop`) and decides near ties (`rounding`).

use crate::timing::rounding::{IsDueBefore, MAX_ERROR};
use crate::{Curve, timing::cycle_time::CycleTime};
use alloc::boxed::Box;

pub(crate) trait Schedule: Curve {
    fn duration(&self, clock_hz: u32) -> CycleTime;

    /// Times of all steps at `clock_hz`, run by run.
    fn runs(&self, clock_hz: u32) -> Runs<'_>;

    /// The exact decision of near ties at `clock_hz`.
    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_>;

    /// Maximum error of a time in f64, in s.
    fn max_error_s(&self) -> f64 {
        MAX_ERROR * self.duration_s()
    }
}

pub(crate) type Runs<'p> = Box<dyn Iterator<Item = Run<'p>> + 'p>;

pub(crate) struct Run<'p> {
    pub(crate) count: u64,
    pub(crate) right: bool,
    pub(crate) times: Box<dyn Times + 'p>,
}

/// Times of a run's steps in cycles from the start of the move. One dynamic call computes a block of steps, because a call
/// per step would take about three times as long as the square root of a ramp.
pub(crate) trait Times {
    /// Writes the times of the steps from `first` (from 0) on, and returns their maximum error.
    fn fill(&mut self, first: f64, times: &mut [f64]) -> f64;
}

impl<'p> Run<'p> {
    /// Steps whose times follow from a formula, with an error of at most `max_error` cycles.
    pub(crate) fn new(count: u64, right: bool, max_error: f64, time: impl Fn(f64) -> f64 + 'p) -> Self {
        Self { count, right, times: Box::new(Formula { time, max_error }) }
    }
}

struct Formula<F> {
    time: F,
    max_error: f64,
}

impl<F: Fn(f64) -> f64> Times for Formula<F> {
    fn fill(&mut self, first: f64, times: &mut [f64]) -> f64 {
        fill_times(first, times, &self.time);
        self.max_error
    }
}

pub(crate) fn fill_times(first: f64, times: &mut [f64], time: impl Fn(f64) -> f64) {
    for (index, slot) in times.iter_mut().enumerate() {
        *slot = time(first + f64::from(index as i32));
    }
}

/// The single run of a curve without reversals; `time` returns the time of a step in cycles.
pub(crate) fn one_run<'p>(curve: &impl Schedule, clock_hz: u32, time: impl Fn(f64) -> f64 + 'p) -> Runs<'p> {
    let max_error = curve.max_error_s() * f64::from(clock_hz);
    Box::new(core::iter::once(Run::new(curve.steps().unsigned_abs(), curve.steps() >= 0, max_error, time)))
}
