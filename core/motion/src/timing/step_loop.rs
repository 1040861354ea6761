//! The loop that all curves share (DESIGN B1): computes the cycle of one step after another.
//!
//! ```text
//! cycle = floor(t*clock_hz + 1/2)     t where s(t) = k - 1/2, or a time from a table
//! ```
//!
//! The times of a move count from its start. Their sum with the start is rounded only once. If an f64 does not decide the
//! rounding, `rounding` does.

use crate::timing::cycle_time::CycleTime;
use crate::timing::rounding::{IsDueBefore, decide_cycle};
use crate::timing::run::{Run, Runs, Schedule};

const BLOCK: usize = 256;
/// Maximum error in cycles of the fractional start of a move.
const MAX_START_ERROR: f64 = 4.0 * f64::EPSILON;

/// A step and its cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScheduledStep {
    pub cycle: u64,
    pub right: bool,
}

/// Iterates over the steps of a move, each with its unrounded time.
pub(crate) struct MoveSteps<'p> {
    start: CycleTime,
    is_due_before: IsDueBefore<'p>,
    runs: Runs<'p>,
    run: Option<Run<'p>>,
    computed: u64,
    times: [f64; BLOCK],
    /// Index of the next of these times, and their number.
    next: usize,
    len: usize,
    /// Steps of the move before the next one.
    steps_before: u64,
    /// An f64 decides up to this distance from the middle between two edges, in cycles.
    certain_distance: f64,
    right: bool,
}

impl<'p> MoveSteps<'p> {
    pub(crate) fn new(schedule: &'p dyn Schedule, start: CycleTime, clock_hz: u32) -> Self {
        Self {
            start,
            is_due_before: schedule.is_due_before(clock_hz),
            runs: schedule.runs(clock_hz),
            run: None,
            computed: 0,
            times: [0.0; BLOCK],
            next: 0,
            len: 0,
            steps_before: 0,
            certain_distance: 0.0,
            right: false,
        }
    }

    /// The step after `steps_before` steps, without computing these.
    pub(crate) fn step_after(mut self, steps_before: u64) -> Option<ScheduledStep> {
        let mut index_in_run = steps_before;
        loop {
            let run = self.next_run()?;
            if index_in_run < run.count {
                (self.computed, self.steps_before) = (index_in_run, steps_before);
                return self.next().map(|(_, step)| step);
            }
            index_in_run -= run.count;
        }
    }

    fn next_run(&mut self) -> Option<&mut Run<'p>> {
        let run = self.run.insert(self.runs.next()?);
        (self.computed, self.right) = (0, run.right);
        Some(run)
    }

    /// Computes the next block of times; `None` after the last step.
    fn fill(&mut self) -> Option<()> {
        while self.run.as_ref().is_none_or(|run| self.computed >= run.count) {
            self.next_run()?;
        }
        let run = self.run.as_mut()?;
        self.len = usize::try_from(run.count - self.computed).map_or(BLOCK, |left| left.min(BLOCK));
        let max_error = run.times.fill(self.computed as f64, self.times.get_mut(..self.len)?);
        self.certain_distance = 0.5 - MAX_START_ERROR - max_error;
        self.computed += self.len as u64;
        self.next = 0;
        Some(())
    }
}

impl Iterator for MoveSteps<'_> {
    type Item = (f64, ScheduledStep);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.next >= self.len {
            self.fill()?;
        }
        let cycles = *self.times.get(self.next)?;
        self.next += 1;
        self.steps_before += 1;
        let since_whole = self.start.part.high + cycles;
        let nearest = (since_whole + 0.5) as i64;
        let cycle = self.start.whole.wrapping_add_signed(nearest);
        let is_certain = libm::fabs(since_whole - nearest as f64) < self.certain_distance;
        let cycle = if is_certain {
            cycle
        } else {
            decide_cycle(self.start, cycle, |since| (self.is_due_before)(self.steps_before, since))
        };
        Some((self.start.cycles() + cycles, ScheduledStep { cycle, right: self.right }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moves::{
        Cosine, CosineMethod, JerkLimited, Move, Points, RampShape, Ramps, Sine, SineSegments, Staircase,
        Trapezoid, TrapezoidMethod,
    };
    use crate::{mechanics::Distance, mechanics::Speed, plan_move};
    use core::cell::Cell;

    /// Deciding in 106 bits takes hundreds of times as long, so an unnecessarily large maximum error costs time.
    #[test]
    fn an_f64_decides_almost_every_step() {
        // A prime number of steps and odd times avoid ties by construction.
        let distance = || Distance::Steps(2999.0);
        let (duration_s, ramp_s) = (0.412_345_671, 0.171_234_567);
        let ramps = |shape| {
            Move::Ramps(Ramps { distance: distance(), duration_s, ramp_s, shape, ..Ramps::default() })
        };
        let trapezoid =
            |method| Move::Trapezoid(Trapezoid { distance: distance(), method, ..Trapezoid::default() });
        let cosine = |method| {
            Move::Cosine(Cosine { distance: distance(), duration_s, ramp_s, method, ..Cosine::default() })
        };
        let end_speed = || Some(Speed::StepsPerSecond(431.0));
        let (amplitude, period_s) = (Distance::Steps(499.0), 0.312_345_671);
        let moves = [
            trapezoid(TrapezoidMethod::Exact),
            trapezoid(TrapezoidMethod::Table),
            Move::Staircase(Staircase { distance: distance(), ..Staircase::default() }),
            cosine(CosineMethod::Exact),
            cosine(CosineMethod::Sliced),
            ramps(RampShape::Sigmoid),
            ramps(RampShape::Bezier),
            ramps(RampShape::Straight),
            ramps(RampShape::Exponential),
            Move::Sine(Sine { amplitude, period_s, periods: 2 }),
            Move::SineSegments(SineSegments { period_s, periods: 2, ..SineSegments::default() }),
            Move::JerkLimited(JerkLimited { distance: distance(), ..JerkLimited::default() }),
            Move::JerkLimited(JerkLimited { end_speed: end_speed(), ..JerkLimited::default() }),
            Move::Cosine(Cosine { end_speed: end_speed(), duration_s, ramp_s, ..Cosine::default() }),
            Move::Points(Points::default()),
        ];
        for given in moves {
            let (plan, decisions) = (plan_move(&given, "x").expect("a valid move"), Cell::new(0));
            let (profile, counter) = (&plan.moves()[0].profile, &decisions);
            let mut steps = MoveSteps::new(profile.schedule(), CycleTime::default(), 15_999_989);
            let is_due_before = steps.is_due_before;
            steps.is_due_before = alloc::boxed::Box::new(move |k, since| {
                counter.set(counter.get() + 1);
                is_due_before(k, since)
            });
            let count = steps.count();
            assert_eq!(count as u64, profile.step_count());
            assert!(
                decisions.get() * 100 <= count,
                "{} decisions for {count} steps of {given:?}",
                decisions.get()
            );
        }
    }
}
