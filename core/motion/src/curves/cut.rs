//! The first part of a move that a new target replaces.

use crate::curves::move_curve::MoveCurve;
use crate::curves::phases::State;
use crate::timing::{CycleTime, Exact, IsDueBefore, Run, Runs, Schedule};
use crate::{Curve, Peaks};
use alloc::{boxed::Box, string::String, vec::Vec};

/// A move up to a time within it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut<P> {
    base: P,
    at_s: f64,
    end: State,
    steps: i64,
    count: u64,
}

impl<P: MoveCurve> Cut<P> {
    /// The first `at_s` of a move, from above 0 to its duration.
    pub(crate) fn new(base: P, at_s: f64) -> Self {
        let end = base.state_before(at_s);
        let (steps, count) = base.due_within(at_s);
        Self { base, at_s, end, steps, count }
    }

    pub(crate) fn base(&self) -> &P {
        &self.base
    }

    /// The state at the cut, with the position from the start of the move.
    pub(crate) fn end(&self) -> State {
        self.end
    }

    /// Number of steps in both directions.
    pub fn step_count(&self) -> u64 {
        self.count
    }

    /// Period in s and number of whole periods before the cut, if there are any.
    pub(crate) fn repeats(&self) -> Option<(f64, u32)> {
        let (period_s, _) = self.base.repeats()?;
        let periods = (self.at_s / period_s) as u32;
        (periods > 0).then_some((period_s, periods))
    }
}

impl<P: MoveCurve> Schedule for Cut<P> {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::exact(&Exact::of(self.at_s).times(clock_hz.into()))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let mut left = self.count;
        Box::new(self.base.runs(clock_hz).map_while(move |run| {
            let count = run.count.min(left);
            left -= count;
            (count > 0).then_some(Run { count, ..run })
        }))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        self.base.is_due_before(clock_hz)
    }

    fn max_error_s(&self) -> f64 {
        self.base.max_error_s()
    }
}

impl<P: MoveCurve> Curve for Cut<P> {
    fn duration_s(&self) -> f64 {
        self.at_s
    }

    fn steps(&self) -> i64 {
        self.steps
    }

    fn position(&self, t: f64) -> f64 {
        if t >= self.at_s { self.end.position } else { self.base.position(t) }
    }

    fn speed(&self, t: f64) -> f64 {
        if t >= self.at_s { self.end.speed } else { self.base.speed(t) }
    }

    fn acceleration(&self, t: f64) -> f64 {
        if t >= self.at_s { self.end.acceleration } else { self.base.acceleration(t) }
    }

    /// Jumps and jerk apply to the whole move.
    fn peaks(&self) -> Peaks {
        let of = |t: f64| Peaks {
            speed: libm::fabs(self.speed(t)),
            acceleration: libm::fabs(self.acceleration(t)),
            ..Peaks::default()
        };
        let Peaks { jump, jerk, acceleration_jump, .. } = self.base.peaks();
        let all = Peaks { jump, jerk, acceleration_jump, ..Peaks::default() };
        let times_s = self.breakpoints_s();
        times_s.into_iter().chain([0.0]).fold(all, |peaks, t| peaks.max(of(t)))
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        let mut all = self.base.breakpoints_s();
        all.retain(|breakpoint| *breakpoint < self.at_s);
        if self.repeats().is_none() {
            all.push(self.at_s);
        }
        all
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        self.base.detail(limit_steps_s)
    }
}
