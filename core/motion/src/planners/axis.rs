//! The motion of one axis: its moves one after another.
//!
//! ```text
//! position  |        _____ _        each move begins at the end of the previous one; the position is
//!           |      /       \        0 before the first move, and constant after the last
//!           |____/          \___
//!            dwell cosine  constant
//! ```

use crate::timing::{CycleTime, MoveSteps, ScheduledStep};
use crate::{Peaks, Profile, round_half_up};
use alloc::vec::Vec;

/// A move and where it begins.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMove {
    pub start_s: f64,
    pub start_steps: i64,
    pub profile: Profile,
}

/// The planned motion of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisPlan {
    /// Invariant: at least one; each starts at the end of the previous one.
    moves: Vec<PlannedMove>,
    duration_s: f64,
    steps: i64,
    /// The exact end position minus the whole one; not 0 if the axis stops between two steps.
    end_offset: f64,
}

impl AxisPlan {
    /// `end_offset` is the exact end position minus the whole one.
    pub(crate) fn new(moves: Vec<PlannedMove>, duration_s: f64, steps: i64, end_offset: f64) -> Self {
        Self { moves, duration_s, steps, end_offset }
    }

    /// The moves, at least one.
    pub fn moves(&self) -> &[PlannedMove] {
        debug_assert!(!self.moves.is_empty(), "an axis without moves was accepted");
        &self.moves
    }

    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Position after all moves, in steps.
    pub fn steps(&self) -> i64 {
        self.steps
    }

    /// Exact position after all moves, in steps.
    pub(crate) fn end_position(&self) -> f64 {
        self.steps as f64 + self.end_offset
    }

    /// Number of steps in both directions.
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
            start = start.plus(profile.schedule().duration(clock_hz));
            steps
        })
    }

    fn move_at(&self, t: f64) -> Option<(&PlannedMove, f64)> {
        let after = self.moves.partition_point(|planned| planned.start_s <= t);
        let planned = self.moves.get(after.saturating_sub(1))?;
        Some((planned, t - planned.start_s))
    }

    /// Position at `t` s in steps.
    pub fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s {
            return self.end_position();
        }
        self.move_at(t).map_or(0.0, |(planned, t)| planned.start_steps as f64 + planned.profile.position(t))
    }

    /// Steps due by `t` s, with the error of an f64; [`Self::due_by`] is exact for a cycle. A table's step that is due exactly
    /// at `t` counts if it goes to the right, and not yet if it goes to the left.
    pub fn steps_due(&self, t: f64) -> i64 {
        // At the end of a move its last step may not be due yet.
        let ended = self.moves.partition_point(|planned| planned.start_s + planned.profile.duration_s() < t);
        if let Some(PlannedMove { profile, start_s, start_steps }) = self.moves.get(ended)
            && profile.last_step_is_after_end()
            && *start_s + profile.duration_s() == t
        {
            return start_steps.saturating_add(profile.steps()).saturating_add(1);
        }
        if t >= self.duration_s {
            return self.steps;
        }
        let Some((PlannedMove { profile, start_steps, .. }, since_start)) = self.move_at(t) else { return 0 };
        start_steps.saturating_add(match profile {
            Profile::TrapezoidTable(table) => table.steps_due(since_start, 0),
            profile => round_half_up(profile.position(since_start)),
        })
    }

    /// Speed at `t` s in steps/s; 0 outside the motion.
    pub fn speed(&self, t: f64) -> f64 {
        self.value_while_moving(t, |profile, t| profile.speed(t))
    }

    /// Acceleration at `t` s in steps/s^2; 0 outside the motion and where the speed jumps.
    pub fn acceleration(&self, t: f64) -> f64 {
        self.value_while_moving(t, |profile, t| profile.acceleration(t))
    }

    fn value_while_moving(&self, t: f64, of: fn(&Profile, f64) -> f64) -> f64 {
        if t < 0.0 || t >= self.duration_s {
            return 0.0;
        }
        self.move_at(t).map_or(0.0, |(planned, t)| of(&planned.profile, t))
    }

    /// Maximum magnitudes of the axis, with the jumps at and between the ends of moves.
    pub fn peaks(&self) -> Peaks {
        let (mut peaks, mut last_speed, mut last_acceleration) = (Peaks::default(), 0.0, 0.0);
        let jumps = |speed: f64, acceleration: f64| Peaks {
            jump: libm::fabs(speed),
            acceleration_jump: libm::fabs(acceleration),
            ..Peaks::default()
        };
        for PlannedMove { profile, .. } in &self.moves {
            let (speed, acceleration) = (profile.speed(0.0), profile.acceleration(0.0));
            peaks =
                peaks.max(profile.peaks()).max(jumps(speed - last_speed, acceleration - last_acceleration));
            last_speed = profile.speed(profile.duration_s());
            last_acceleration = profile.acceleration(profile.duration_s());
        }
        peaks.max(jumps(last_speed, last_acceleration))
    }
}
