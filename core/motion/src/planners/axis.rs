//! The motion of one axis: its moves one after another.
//!
//! ```text
//! position  |        _____ _        each move begins at the end of the one before; the position is
//!           |      /       \        0 before the first move, and constant after the last
//!           |____/          \___
//!            dwell cosine  constant
//! ```

use crate::{
    Peaks, Profile, round_half_up,
    timing::{CycleTime, MoveSteps, ScheduledStep},
};
use alloc::vec::Vec;

#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMove {
    pub start_s: f64,
    pub start_steps: i64,
    pub profile: Profile,
}

#[derive(Clone, Debug, PartialEq)]
pub struct AxisPlan {
    /// Invariant: at least one; each starts at the end of the one before.
    moves: Vec<PlannedMove>,
    duration_s: f64,
    steps: i64,
}

impl AxisPlan {
    pub(crate) fn of(profiles: Vec<Profile>) -> Self {
        let (mut start_s, mut start_steps) = (0.0, 0);
        let moves = profiles
            .into_iter()
            .map(|profile| {
                let planned = PlannedMove { start_s, start_steps, profile };
                start_s += planned.profile.duration_s();
                start_steps += planned.profile.steps();
                planned
            })
            .collect();
        Self { moves, duration_s: start_s, steps: start_steps }
    }

    #[must_use]
    pub fn moves(&self) -> &[PlannedMove] {
        debug_assert!(!self.moves.is_empty(), "an axis without a move was not refused");
        &self.moves
    }

    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    #[must_use]
    pub fn steps(&self) -> i64 {
        self.steps
    }

    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.moves.iter().fold(0, |sum: u64, planned| sum.saturating_add(planned.profile.step_count()))
    }

    /// All steps in the order of their times, in cycles at `clock_hz`.
    pub fn due_steps(&self, clock_hz: u32) -> impl Iterator<Item = ScheduledStep> + '_ {
        self.due_instants(clock_hz).map(|(_, due)| due)
    }

    /// All steps, each with its unrounded time, in cycles at `clock_hz`.
    pub fn due_instants(&self, clock_hz: u32) -> impl Iterator<Item = (f64, ScheduledStep)> + '_ {
        let mut start = CycleTime::default();
        self.moves.iter().flat_map(move |PlannedMove { profile, .. }| {
            let steps = MoveSteps::new(profile.schedule(), start, clock_hz);
            start = start.plus(profile.schedule().length(clock_hz));
            steps
        })
    }

    fn at(&self, t: f64) -> Option<(&PlannedMove, f64)> {
        let after = self.moves.partition_point(|planned| planned.start_s <= t);
        let planned = self.moves.get(after.saturating_sub(1))?;
        Some((planned, t - planned.start_s))
    }

    #[must_use]
    pub fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s {
            return self.steps as f64;
        }
        self.at(t).map_or(0.0, |(planned, t)| planned.start_steps as f64 + planned.profile.position(t))
    }

    /// Steps due by `t` s, in the digits of an f64; [`Self::due_by`] is exact for a cycle. At the very time of a table's
    /// step it counts if it goes to the right, and not yet if it goes to the left.
    ///
    /// A move starts at a whole step, so only its own part is rounded.
    #[must_use]
    pub fn steps_due(&self, t: f64) -> i64 {
        // At the end of a move its last step may still be pending.
        let ended = self.moves.partition_point(|planned| planned.start_s + planned.profile.duration_s() < t);
        if let Some(PlannedMove { profile, start_s, start_steps }) = self.moves.get(ended)
            && profile.last_step_waits()
            && *start_s + profile.duration_s() == t
        {
            return start_steps.saturating_add(profile.steps()).saturating_add(1);
        }
        if t >= self.duration_s {
            return self.steps;
        }
        let Some((PlannedMove { profile, start_steps, .. }, since)) = self.at(t) else { return 0 };
        start_steps.saturating_add(match profile {
            Profile::TrapezoidTable(table) => table.steps_due(since, 0),
            profile => round_half_up(profile.position(since)),
        })
    }

    /// Speed at `t` s in steps/s; 0 outside the motion.
    #[must_use]
    pub fn speed(&self, t: f64) -> f64 {
        self.while_moving(t, |profile, t| profile.speed(t))
    }

    /// Acceleration at `t` s in steps/s^2; 0 outside the motion and where the speed jumps.
    #[must_use]
    pub fn acceleration(&self, t: f64) -> f64 {
        self.while_moving(t, |profile, t| profile.acceleration(t))
    }

    fn while_moving(&self, t: f64, of: fn(&Profile, f64) -> f64) -> f64 {
        if t < 0.0 || t >= self.duration_s {
            return 0.0;
        }
        self.at(t).map_or(0.0, |(planned, t)| of(&planned.profile, t))
    }

    /// Maximum magnitudes of the axis, with the jumps at and between the ends of moves.
    #[must_use]
    pub fn peaks(&self) -> Peaks {
        // Speed and acceleration at the end of the previous move.
        let (mut peaks, mut before) = (Peaks::default(), (0.0, 0.0));
        let jumps = |(speed, acceleration): (f64, f64), from: (f64, f64)| Peaks {
            jump: libm::fabs(speed - from.0),
            acceleration_jump: libm::fabs(acceleration - from.1),
            ..Peaks::default()
        };
        for PlannedMove { profile, .. } in &self.moves {
            let at = |t: f64| (profile.speed(t), profile.acceleration(t));
            peaks = peaks.or(profile.peaks()).or(jumps(at(0.0), before));
            before = at(profile.duration_s());
        }
        peaks.or(jumps((0.0, 0.0), before))
    }
}
