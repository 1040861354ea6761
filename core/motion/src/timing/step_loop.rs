//! The loop that all planners share (DESIGN B1): when the steps of an axis are due, one after another.
//!
//! ```text
//! cycle = floor(t*clock_hz + 1/2)     t where s(t) = k - 1/2, or a time from a table
//! ```
//!
//! The times of a move count from its start, which is added with all its digits; the sum is rounded once. If an f64 does
//! not decide the rounding, `rounding` does.

use crate::{
    timing::cycle_time::CycleTime,
    timing::rounding::{IsDueBefore, decided},
    timing::run::{Run, Runs, Schedule},
};

const BLOCK: usize = 256;
/// Maximum error in cycles of the fractional start of a move.
const MAX_START_ERROR: f64 = 4.0 * f64::EPSILON;

/// A step and when it is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScheduledStep {
    /// From the motion's start on.
    pub cycle: u64,
    pub right: bool,
}

pub(crate) struct MoveSteps<'p> {
    start: CycleTime,
    is_due_before: IsDueBefore<'p>,
    runs: Runs<'p>,
    run: Option<Run<'p>>,
    /// Steps of the run whose times are computed.
    computed: u64,
    times: [f64; BLOCK],
    /// Index of the next of these times, and their number.
    at: usize,
    len: usize,
    /// Steps of the move before the next one.
    past: u64,
    /// Maximum distance from the middle between two edges at which an f64 decides.
    room: f64,
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
            at: 0,
            len: 0,
            past: 0,
            room: 0.0,
            right: false,
        }
    }

    pub(crate) fn after(mut self, past: u64) -> Option<ScheduledStep> {
        let mut left = past;
        loop {
            let run = self.next_run()?;
            if left < run.count {
                (self.computed, self.past) = (left, past);
                return self.next().map(|(_, step)| step);
            }
            left -= run.count;
        }
    }

    fn next_run(&mut self) -> Option<&mut Run<'p>> {
        let run = self.run.insert(self.runs.next()?);
        (self.computed, self.right) = (0, run.right);
        Some(run)
    }

    fn fill(&mut self) -> Option<()> {
        while self.run.as_ref().is_none_or(|run| self.computed >= run.count) {
            self.next_run()?;
        }
        let run = self.run.as_mut()?;
        self.len = usize::try_from(run.count - self.computed).map_or(BLOCK, |left| left.min(BLOCK));
        let max_error = run.times.fill(self.computed as f64, self.times.get_mut(..self.len)?);
        self.room = 0.5 - MAX_START_ERROR - max_error;
        self.computed += self.len as u64;
        self.at = 0;
        Some(())
    }
}

impl Iterator for MoveSteps<'_> {
    type Item = (f64, ScheduledStep);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.at >= self.len {
            self.fill()?;
        }
        let cycles = *self.times.get(self.at)?;
        self.at += 1;
        self.past += 1;
        let since_whole = self.start.part.high + cycles;
        let near = (since_whole + 0.5) as i64;
        let cycle = self.start.whole.wrapping_add_signed(near);
        let is_certain = libm::fabs(since_whole - near as f64) < self.room;
        let cycle = if is_certain {
            cycle
        } else {
            decided(self.start, cycle, |since| (self.is_due_before)(self.past, since))
        };
        Some((self.start.cycles() + cycles, ScheduledStep { cycle, right: self.right }))
    }
}
