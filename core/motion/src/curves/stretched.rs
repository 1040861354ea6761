//! A move that runs more slowly, so that it lasts as long as the other moves of its group.
//!
//! ```text
//! s(t) = S(f*t), f = T_S/T       speeds times f, accelerations times f^2, jerks times f^3
//! ```

use crate::curves::move_curve::MoveCurve;
use crate::curves::phases::State;
use crate::timing::{CycleTime, F106, IsDueBefore, MAX_ERROR, Run, Runs, Schedule, Times};
use crate::{Curve, Peaks, format::grouped};
use alloc::{boxed::Box, format, string::String, vec::Vec};

/// A move that lasts longer than planned.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretched<P> {
    base: P,
    duration: F106,
    /// Duration of the move divided by this duration, up to 1.
    factor: F106,
}

impl<P: MoveCurve> Stretched<P> {
    /// A move that lasts `duration` s, at least its own duration.
    pub(crate) fn new(base: P, duration: F106) -> Self {
        let own = base.duration(1).double();
        Self { base, duration, factor: own / duration }
    }

    pub(crate) fn base(&self) -> &P {
        &self.base
    }

    pub(crate) fn factor(&self) -> F106 {
        self.factor
    }

    pub(crate) fn repeats(&self) -> Option<(f64, u32)> {
        self.base.repeats().map(|(period_s, periods)| (period_s / self.factor.high, periods))
    }

    pub(crate) fn state(&self, t: f64, within_s: f64) -> State {
        let f = self.factor.high;
        let State { position, speed, acceleration } = self.base.state(f * t, f * within_s);
        State { position, speed: f * speed, acceleration: f * f * acceleration }
    }
}

struct Slower<'p> {
    times: Box<dyn Times + 'p>,
    per_factor: f64,
    max_error: f64,
}

impl Times for Slower<'_> {
    fn fill(&mut self, first: f64, times: &mut [f64]) -> f64 {
        let max_error = self.times.fill(first, times);
        for time in times {
            *time *= self.per_factor;
        }
        max_error * self.per_factor + self.max_error
    }
}

impl<P: MoveCurve> Schedule for Stretched<P> {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::of(self.duration * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let per_factor = 1.0 / self.factor.high;
        let max_error = MAX_ERROR * self.duration_s() * f64::from(clock_hz);
        Box::new(self.base.runs(clock_hz).map(move |run| {
            let times = Slower { times: run.times, per_factor, max_error };
            Run { count: run.count, right: run.right, times: Box::new(times) }
        }))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let (base, factor) = (self.base.is_due_before(clock_hz), self.factor);
        Box::new(move |k, since| base(k, since * factor))
    }

    fn max_error_s(&self) -> f64 {
        self.base.max_error_s() / self.factor.high + MAX_ERROR * self.duration_s()
    }
}

impl<P: MoveCurve> Curve for Stretched<P> {
    fn duration_s(&self) -> f64 {
        self.duration.high
    }

    fn steps(&self) -> i64 {
        self.base.steps()
    }

    fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s() { self.steps() as f64 } else { self.base.position(self.factor.high * t) }
    }

    fn speed(&self, t: f64) -> f64 {
        self.factor.high * self.base.speed(self.factor.high * t)
    }

    fn acceleration(&self, t: f64) -> f64 {
        self.factor.high * self.factor.high * self.base.acceleration(self.factor.high * t)
    }

    fn peaks(&self) -> Peaks {
        let (f, peaks) = (self.factor.high, self.base.peaks());
        Peaks {
            speed: f * peaks.speed,
            acceleration: f * f * peaks.acceleration,
            jump: f * peaks.jump,
            jerk: f * f * f * peaks.jerk,
            acceleration_jump: f * f * peaks.acceleration_jump,
        }
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        let per_factor = 1.0 / self.factor.high;
        self.base.breakpoints_s().into_iter().map(|breakpoint| breakpoint * per_factor).collect()
    }

    fn detail(&self, _: f64) -> String {
        let slower = grouped(100.0 * (1.0 - self.factor.high));
        format!("{}; {slower}\u{202f}% slower, to end with its group", self.peaks().to_text())
    }
}
