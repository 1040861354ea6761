//! When the steps of an axis are due, one after another (DESIGN B1): the one loop that all planners share.
//!
//! ```text
//! cycle = floor(t*clock_hz + 1/2)     t where s(t) = k - 1/2, or the time that a table gives
//! ```
//!
//! A move's own times count from its start; that start is added with all its digits, and the sum is rounded once. Where
//! the digits of an f64 do not decide that, `rounding` does.

use crate::{
    timing::cycle_time::CycleTime,
    timing::rounding::{IsDueBefore, decided},
    timing::run::{Run, Runs, Schedule},
};

const BLOCK: usize = 256;
/// Maximum error in cycles of the part of a cycle in which a move starts.
const MAX_START_OFF: f64 = 4.0 * f64::EPSILON;

/// A step that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScheduledStep {
    /// Its cycle, from the motion's start on.
    pub cycle: u64,
    /// Whether it goes to the right.
    pub right: bool,
}

pub(crate) struct MoveSteps<'p> {
    start: CycleTime,
    is_due_before: IsDueBefore<'p>,
    runs: Runs<'p>,
    /// The present run; `None` before the first.
    run: Option<Run<'p>>,
    /// Steps of the run whose times were formed.
    formed: u64,
    times: [f64; BLOCK],
    /// Of these times the next one, and their number.
    at: usize,
    len: usize,
    /// Steps of the move before the next one.
    past: u64,
    /// Maximum distance from the middle between two edges at which a time in f64 decides.
    room: f64,
    right: bool,
}

impl<'p> MoveSteps<'p> {
    pub(crate) fn new(schedule: &'p impl Schedule, start: CycleTime, clock_hz: u32) -> Self {
        Self {
            start,
            is_due_before: schedule.is_due_before(clock_hz),
            runs: schedule.runs(clock_hz),
            run: None,
            formed: 0,
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
                (self.formed, self.past) = (left, past);
                return self.next().map(|(_, step)| step);
            }
            left -= run.count;
        }
    }

    fn next_run(&mut self) -> Option<&mut Run<'p>> {
        let run = self.run.insert(self.runs.next()?);
        (self.formed, self.right) = (0, run.right);
        Some(run)
    }

    fn fill(&mut self) -> Option<()> {
        while self.run.as_ref().is_none_or(|run| self.formed >= run.count) {
            self.next_run()?;
        }
        let run = self.run.as_mut()?;
        self.len = usize::try_from(run.count - self.formed).map_or(BLOCK, |left| left.min(BLOCK));
        let off = run.times.fill(self.formed as f64, self.times.get_mut(..self.len)?);
        self.room = 0.5 - MAX_START_OFF - off;
        self.formed += self.len as u64;
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
