//! A move (CONTROLLER G4): remaining steps, height on the ramp, and time of the next step.
//!
//! ```text
//! rate   top ┤      ┌────────┐          the height rises by one per step to the top and falls as soon as the
//!            │    ┌─┘        └─┐        remaining steps are no more; a brake falls from the current height
//!          1 ┤  ┌─┘            └─┐
//! next += interval; STEP rises in next >> 16
//! ```

use crate::table::{Row, Table};
use crate::{input::Signal, state::State};
use stepscope_peripheral::segment::FRACTION_BITS;

pub(crate) const ENDLESS: u64 = u64::MAX;

/// I(r) = floor(65536*f/r) in 1/65536 cycle.
pub(crate) const fn interval(clock_hz: u32, rate_hz: u64) -> u64 {
    ((clock_hz as u64) << FRACTION_BITS) / if rate_hz == 0 { 1 } else { rate_hz }
}

/// A part of homing: toward the switch, away from it, and slowly toward it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Leg {
    Seek,
    Off,
    Fine,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    Group,
    Return,
    /// A jog, and the state after it.
    Jog(State),
    Leg(Leg),
    HomeReturn,
}

/// The height to which a move climbs, and the rate there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Climb {
    pub(crate) table: Table,
    pub(crate) top: u64,
    pub(crate) plateau_hz: u32,
}

pub(crate) struct ExecutedStep {
    pub(crate) is_first: bool,
    /// Interval of its rate, also if it came later.
    pub(crate) rate_interval: u64,
}

#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) purpose: Purpose,
    pub(crate) right: bool,
    pub(crate) steps_left: u64,
    /// Steps that have accelerated minus those that have decelerated.
    height: u64,
    climb: Climb,
    clock_hz: u32,
    /// The current row of the table, and its interval.
    row: Option<(Row, u64)>,
    /// Time before the first step, if not the interval of its rate.
    pub(crate) first_interval: Option<u64>,
    /// Number of the `profile` group that gives the intervals.
    pub(crate) profile: Option<u32>,
    /// Time of the pending step in 1/65536 cycle.
    next: u128,
    pub(crate) has_pending_step: bool,
    pub(crate) waits_for_memory: bool,
    pub(crate) is_braking: bool,
    pub(crate) has_hit_limit: bool,
    /// The level that ends the move early.
    pub(crate) until: Option<(Signal, bool)>,
    pub(crate) until_met: bool,
    /// Whether the switch has the level for which a leg of homing waits.
    pub(crate) has_found_switch: bool,
    /// Rate interval of the pending step.
    due_interval: u64,
    pub(crate) last_interval: Option<u64>,
}

impl Motion {
    pub(crate) const fn new(
        purpose: Purpose,
        right: bool,
        steps_left: u64,
        climb: Climb,
        clock_hz: u32,
    ) -> Self {
        Self {
            purpose,
            right,
            steps_left,
            height: 0,
            climb,
            clock_hz,
            row: None,
            first_interval: None,
            profile: None,
            next: 0,
            has_pending_step: false,
            waits_for_memory: false,
            is_braking: false,
            has_hit_limit: false,
            until: None,
            until_met: false,
            has_found_switch: false,
            due_interval: 0,
            last_interval: None,
        }
    }

    /// Begins in cycle `now`: the move's time starts at (now + 1) << 16.
    pub(crate) fn begin(&mut self, now: u64, profile: &[u64]) {
        self.waits_for_memory = false;
        self.next = (u128::from(now) + 1) << FRACTION_BITS;
        self.schedule_next(profile);
    }

    /// Cycle in which the pending step rises; `u64::MAX` without one.
    pub(crate) fn rise(&self) -> u64 {
        if self.has_pending_step {
            u64::try_from(self.next >> FRACTION_BITS).unwrap_or(u64::MAX)
        } else {
            u64::MAX
        }
    }

    /// Executes the pending step and schedules the next one.
    pub(crate) fn step(&mut self, profile: &[u64]) -> ExecutedStep {
        let step = ExecutedStep { is_first: self.last_interval.is_none(), rate_interval: self.due_interval };
        self.last_interval = Some(step.rate_interval);
        self.steps_left = self.steps_left.saturating_sub(1);
        self.schedule_next(profile);
        step
    }

    fn schedule_next(&mut self, profile: &[u64]) {
        self.has_pending_step = self.steps_left > 0 && !(self.is_braking && self.height == 0);
        if !self.has_pending_step {
            return;
        }
        self.due_interval = if self.profile.is_some() {
            let steps_left = usize::try_from(self.steps_left).unwrap_or(usize::MAX);
            let next = profile.len().checked_sub(steps_left).and_then(|done| profile.get(done));
            next.copied().unwrap_or(u64::MAX)
        } else if self.is_braking || self.steps_left <= self.height {
            let interval = self.ramp(self.height);
            self.height -= 1;
            interval
        } else if self.height < self.climb.top && self.steps_left >= self.height + 2 {
            self.height += 1;
            self.ramp(self.height)
        } else if self.height == self.climb.top {
            interval(self.clock_hz, self.climb.plateau_hz.into())
        } else {
            self.ramp(self.height + 1)
        };
        self.next += u128::from(self.first_interval.take().unwrap_or(self.due_interval));
    }

    /// The interval of ramp step `k`.
    fn ramp(&mut self, k: u64) -> u64 {
        match self.row {
            Some((row, interval)) if (row.first..=row.last).contains(&k) => interval,
            _ => {
                let row = self.climb.table.row(k);
                let interval = interval(self.clock_hz, row.rate_hz);
                self.row = Some((row, interval));
                interval
            }
        }
    }

    /// Stops immediately: the pending step is not executed, and remains in `steps_left`.
    pub(crate) const fn stop(&mut self) {
        (self.has_pending_step, self.waits_for_memory) = (false, false);
    }

    /// Brakes, or stops immediately from height 0 and while the move waits. A `profile` does not brake.
    pub(crate) const fn brake(&mut self) {
        if self.is_braking || self.profile.is_some() {
            return;
        }
        self.is_braking = true;
        if self.height == 0 || self.waits_for_memory {
            self.stop();
        }
    }

    /// Whether a step is pending or the move waits for memory, so that switches and levels can end it.
    pub(crate) const fn is_active(&self) -> bool {
        self.has_pending_step || self.waits_for_memory
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{vec, vec::Vec};

    const TABLE: Table = Table { start_speed_hz: 1000, acceleration_hz_s: 1000 };

    /// Rates of the steps of a move that begins to brake after some of them.
    fn rates(steps_left: u64, top: u64, plateau_hz: u32, brakes_after: usize) -> Vec<u64> {
        let climb = Climb { table: TABLE, top, plateau_hz };
        let mut motion = Motion::new(Purpose::Return, true, steps_left, climb, 1_000_000);
        let mut rates = vec![];
        motion.begin(0, &[]);
        if brakes_after == 0 {
            motion.brake();
        }
        while motion.has_pending_step {
            rates.push((1_000_000 << 16) / motion.step(&[]).rate_interval);
            if rates.len() == brakes_after {
                motion.brake();
            }
        }
        rates
    }

    fn runs(rates: &[u64]) -> Vec<(u64, usize)> {
        rates.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
    }

    #[test]
    fn a_move_accelerates_runs_and_decelerates_by_the_table() {
        let never = usize::MAX;
        // Steps, top, plateau, runs of rates.
        let rows = [
            (100, 0, 1000, vec![(1000, 100)]),
            (130, 60, 1050, vec![(1000, 30), (1030, 30), (1050, 10), (1030, 30), (1000, 30)]),
            (120, 60, 1050, vec![(1000, 30), (1030, 60), (1000, 30)]),
            (64, 60, 1050, vec![(1000, 30), (1030, 4), (1000, 30)]),
            (65, 60, 1050, vec![(1000, 30), (1030, 5), (1000, 30)]),
        ];
        for (steps_left, top, plateau_hz, expected) in rows {
            assert_eq!(runs(&rates(steps_left, top, plateau_hz, never)), expected, "{steps_left} {top}");
        }
    }

    #[test]
    fn a_brake_executes_the_pending_step_and_one_more_per_step_of_height() {
        // Steps before the brake, steps in total: the pending one, and one per step of height.
        for (after, expected) in [(0, 1 + 1), (1, 1 + 1 + 2), (35, 35 + 1 + 36), (70, 70 + 1 + 60)] {
            assert_eq!(rates(200, 60, 1050, after).len(), expected, "after {after}");
        }
        assert_eq!(rates(200, 0, 1000, 7).len(), 7, "at height 0 immediately");
        assert_eq!(rates(63, 60, 1050, 32).len(), 63, "it was braking already");
    }
}
