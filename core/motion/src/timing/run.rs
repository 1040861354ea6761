//! Runs: the steps of a move that go one way by one formula (DESIGN B1).
//!
//! ```text
//! position  |    .---.              a move is one run or several, one after another:
//!           |   /     \             trapezoid, cosine, … one; a sine one for each half period;
//!           | _/       \_           points one for each piece; a staircase one for each row
//!             run 1   run 2
//! ```
//!
//! A planner gives the steps' times in f64 and their greatest error, and decides in 106 bits whether a step is due
//! before an edge ([`Schedule`]). All else is the same for every planner: `step_loop` rounds the times, and `rounding`
//! asks the planner where f64 does not decide.

use crate::{
    Curve,
    timing::cycle_time::CycleTime,
    timing::rounding::{IsDueBefore, MAX_OFF},
};
use alloc::boxed::Box;

pub(crate) trait Schedule: Curve {
    /// How long the move lasts in cycles, with all digits.
    fn length(&self, clock_hz: u32) -> CycleTime;

    fn runs(&self, clock_hz: u32) -> Runs<'_>;

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_>;

    /// Maximum error of a time in f64, in s.
    fn off_s(&self) -> f64 {
        MAX_OFF * self.duration_s()
    }
}

pub(crate) type Runs<'p> = Box<dyn Iterator<Item = Run<'p>> + 'p>;

pub(crate) struct Run<'p> {
    pub(crate) count: u64,
    pub(crate) right: bool,
    pub(crate) times: Box<dyn Times + 'p>,
}

/// Times of a run's steps in cycles from the start of the move.
///
/// Many at a time, so that a run costs one dynamic call for a block of steps; one call for each step would take about
/// three times as long as the square root of a ramp.
pub(crate) trait Times {
    /// Writes the times of the steps from `first` (from 0) on, and returns their greatest error.
    fn fill(&mut self, first: f64, times: &mut [f64]) -> f64;
}

impl<'p> Run<'p> {
    /// Steps of which a formula gives the time with an error of `off` at most.
    pub(crate) fn new(count: u64, right: bool, off: f64, time: impl Fn(f64) -> f64 + 'p) -> Self {
        Self { count, right, times: Box::new(Formula { time, off }) }
    }
}

struct Formula<F> {
    time: F,
    off: f64,
}

impl<F: Fn(f64) -> f64> Times for Formula<F> {
    fn fill(&mut self, first: f64, times: &mut [f64]) -> f64 {
        put(first, times, &self.time);
        self.off
    }
}

pub(crate) fn put(first: f64, times: &mut [f64], time: impl Fn(f64) -> f64) {
    for (index, put) in times.iter_mut().enumerate() {
        *put = time(first + f64::from(index as i32));
    }
}

/// The one run of a curve that goes one way, of which `time` gives the time of a step in cycles.
pub(crate) fn one_run<'p>(curve: &impl Schedule, clock_hz: u32, time: impl Fn(f64) -> f64 + 'p) -> Runs<'p> {
    let off = curve.off_s() * f64::from(clock_hz);
    Box::new(core::iter::once(Run::new(curve.steps().unsigned_abs(), curve.steps() >= 0, off, time)))
}
