//! A move (CONTROLLER G4): remaining steps, height of the climb, and time of the next step.
//!
//! ```text
//! rate   top ┤      ┌────────┐          u rises by one per step to the top, runs on the plateau, and falls
//!            │    ┌─┘        └─┐        while rem <= u; a brake falls from the current height
//!          1 ┤  ┌─┘            └─┐
//! next += interval; STEP rises in next >> 16
//! ```

use crate::{
    input::Signal,
    state::State,
    table::{Row, Table},
};
use stepscope_peripheral::segment::FRACTION_BITS;

pub(crate) const ENDLESS: u64 = u64::MAX;

/// I(r) = floor(65536*f/r) in 1/65536 cycle.
pub(crate) const fn interval(clock_hz: u32, rate_hz: u64) -> u64 {
    ((clock_hz as u64) << FRACTION_BITS) / if rate_hz == 0 { 1 } else { rate_hz }
}

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

#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub(crate) purpose: Purpose,
    pub(crate) right: bool,
    pub(crate) rem: u64,
    height: u64,
    climb: Climb,
    clock_hz: u32,
    row: Option<(Row, u64)>,
    /// Time before the first step, if not the interval of its rate.
    pub(crate) first_interval: Option<u64>,
    pub(crate) profile: Option<u32>,
    /// Time of the pending step in 1/65536 cycle.
    next: u128,
    pub(crate) is_due: bool,
    pub(crate) waits: bool,
    pub(crate) brakes: bool,
    pub(crate) is_limited: bool,
    /// The level that ends the move early.
    pub(crate) until: Option<(Signal, bool)>,
    pub(crate) until_met: bool,
    /// Whether the switch did what a leg of homing waits for.
    pub(crate) is_found: bool,
    /// Rate interval of the pending step.
    due_interval: u64,
    pub(crate) last_interval: Option<u64>,
}

impl Motion {
    pub(crate) const fn new(purpose: Purpose, right: bool, rem: u64, climb: Climb, clock_hz: u32) -> Self {
        Self {
            purpose,
            right,
            rem,
            height: 0,
            climb,
            clock_hz,
            row: None,
            first_interval: None,
            profile: None,
            next: 0,
            is_due: false,
            waits: false,
            brakes: false,
            is_limited: false,
            until: None,
            until_met: false,
            is_found: false,
            due_interval: 0,
            last_interval: None,
        }
    }

    /// Begins in cycle `now`: the move's time starts at (now + 1) << 16.
    pub(crate) fn begin(&mut self, now: u64, profile: &[u64]) {
        self.waits = false;
        self.next = (u128::from(now) + 1) << FRACTION_BITS;
        self.decide(profile);
    }

    /// Cycle in which the pending step rises; `u64::MAX` without one.
    pub(crate) fn rise(&self) -> u64 {
        if self.is_due { u64::try_from(self.next >> FRACTION_BITS).unwrap_or(u64::MAX) } else { u64::MAX }
    }

    /// Executes the pending step and schedules the next; returns whether it was the first, and its rate interval.
    pub(crate) fn step(&mut self, profile: &[u64]) -> (bool, u64) {
        let (is_first, made) = (self.last_interval.is_none(), self.due_interval);
        self.last_interval = Some(made);
        self.rem = self.rem.saturating_sub(1);
        self.decide(profile);
        (is_first, made)
    }

    fn decide(&mut self, profile: &[u64]) {
        self.is_due = self.rem > 0 && !(self.brakes && self.height == 0);
        if !self.is_due {
            return;
        }
        self.due_interval = if self.profile.is_some() {
            let rem = usize::try_from(self.rem).unwrap_or(usize::MAX);
            profile.len().checked_sub(rem).and_then(|made| profile.get(made)).copied().unwrap_or(u64::MAX)
        } else if self.brakes || self.rem <= self.height {
            let interval = self.ramp(self.height);
            self.height -= 1;
            interval
        } else if self.height < self.climb.top && self.rem >= self.height + 2 {
            self.height += 1;
            self.ramp(self.height)
        } else if self.height == self.climb.top {
            interval(self.clock_hz, self.climb.plateau_hz.into())
        } else {
            self.ramp(self.height + 1)
        };
        self.next += u128::from(self.first_interval.take().unwrap_or(self.due_interval));
    }

    /// I(R(k)) of ramp step `k`, with the current row cached.
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

    /// Stops at once: the pending step does not rise, and stays in `rem`.
    pub(crate) const fn stop(&mut self) {
        (self.is_due, self.waits) = (false, false);
    }

    /// Brakes; at once from height 0 or while it waits. A `profile` does not brake.
    pub(crate) const fn brake(&mut self) {
        if self.brakes || self.profile.is_some() {
            return;
        }
        self.brakes = true;
        if self.height == 0 || self.waits {
            self.stop();
        }
    }

    /// Whether a step is due or the move waits, so that switches and levels have an effect.
    pub(crate) const fn is_active(&self) -> bool {
        self.is_due || self.waits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{vec, vec::Vec};

    const TABLE: Table = Table { start_speed_hz: 1000, acceleration_hz_s: 1000 };

    /// Rates of the steps of a move that begins to brake after some of them.
    fn rates(rem: u64, top: u64, plateau_hz: u32, brakes_after: usize) -> Vec<u64> {
        let climb = Climb { table: TABLE, top, plateau_hz };
        let mut motion = Motion::new(Purpose::Return, true, rem, climb, 1_000_000);
        let mut rates = vec![];
        motion.begin(0, &[]);
        if brakes_after == 0 {
            motion.brake();
        }
        while motion.is_due {
            let (_, interval) = motion.step(&[]);
            rates.push((1_000_000 << 16) / interval);
            if rates.len() == brakes_after {
                motion.brake();
            }
        }
        rates
    }

    /// Runs of equal rates.
    fn runs(rates: &[u64]) -> Vec<(u64, usize)> {
        rates.chunk_by(|a, b| a == b).map(|run| (run[0], run.len())).collect()
    }

    #[test]
    fn a_move_climbs_runs_and_comes_down_by_the_table() {
        let never = usize::MAX;
        // Steps, top, plateau, runs of rates.
        let rows = [
            (100, 0, 1000, vec![(1000, 100)]),
            (130, 60, 1050, vec![(1000, 30), (1030, 30), (1050, 10), (1030, 30), (1000, 30)]),
            (120, 60, 1050, vec![(1000, 30), (1030, 60), (1000, 30)]),
            (64, 60, 1050, vec![(1000, 30), (1030, 4), (1000, 30)]),
            (65, 60, 1050, vec![(1000, 30), (1030, 5), (1000, 30)]),
        ];
        for (rem, top, plateau_hz, expected) in rows {
            assert_eq!(runs(&rates(rem, top, plateau_hz, never)), expected, "{rem} {top}");
        }
    }

    #[test]
    fn a_brake_makes_the_step_that_is_due_and_as_many_more_as_it_has_climbed() {
        // After so many steps, how many are made in all: the due one, and u more.
        for (after, expected) in [(0, 1 + 1), (1, 1 + 1 + 2), (35, 35 + 1 + 36), (70, 70 + 1 + 60)] {
            assert_eq!(rates(200, 60, 1050, after).len(), expected, "after {after}");
        }
        assert_eq!(rates(200, 0, 1000, 7).len(), 7, "at height 0 at once");
        assert_eq!(rates(63, 60, 1050, 32).len(), 63, "what it had to make anyway");
    }
}
