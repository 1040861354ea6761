//! The moves of an axis while they are planned: each begins at the exact position where the previous one ended.

use crate::curves::constant_velocity::Dwell;
use crate::curves::{numeric::Numeric, phases::Phase, phases::Phases};
use crate::planners::start::Start;
use crate::timing::Exact;
use crate::{AxisPlan, Curve, PlannedMove, Profile};
use alloc::{string::String, vec::Vec};

/// Shorter gaps in s between the ends of two axes are roundings.
const MIN_GAP_S: f64 = 1e-12;

/// A pause between two steps.
fn standing(offset: f64, duration_s: f64) -> Numeric<Phases> {
    let phases = Phases::new(offset, 0.0, [Phase::cruise(duration_s)]);
    Numeric::new(phases, offset, Exact::of(duration_s).double())
}

/// Planned moves, and the state after them.
#[derive(Debug, Default)]
pub(crate) struct Chain {
    moves: Vec<PlannedMove>,
    /// Path of each move; empty for a pause before a group.
    paths: Vec<String>,
    duration_s: f64,
    steps: i64,
    start: Start,
    /// Whether a move could not be planned: positions after it are unknown.
    pub(crate) is_broken: bool,
}

impl Chain {
    /// Appends a move, whose end speed along the axis is given or 0.
    pub(crate) fn push(&mut self, profile: Profile, path: String, end_speed: f64) {
        let (start_s, start_steps, offset) = (self.duration_s, self.steps, self.start.offset);
        let profile = match profile {
            Profile::Dwell(dwell) if offset != 0.0 => Profile::Phases(standing(offset, dwell.duration_s())),
            profile => profile,
        };
        self.duration_s += profile.duration_s();
        self.steps = self.steps.saturating_add(profile.steps());
        self.start = Start { offset: profile.end_offset(), speed: end_speed };
        self.moves.push(PlannedMove { start_s, start_steps, profile });
        self.paths.push(path);
    }

    /// Removes the last move, to append another one instead.
    pub(crate) fn pop(&mut self) -> Option<(Profile, String)> {
        let PlannedMove { start_s, start_steps, profile } = self.moves.pop()?;
        (self.duration_s, self.steps) = (start_s, start_steps);
        Some((profile, self.paths.pop()?))
    }

    /// Appends a pause, if the axis ends earlier.
    pub(crate) fn pause_until(&mut self, time_s: f64) {
        let gap_s = time_s - self.duration_s;
        if gap_s > MIN_GAP_S {
            self.push_dwell(gap_s);
        }
    }

    /// Appends a pause.
    pub(crate) fn push_dwell(&mut self, duration_s: f64) {
        self.push(Profile::Dwell(Dwell::new(duration_s)), String::new(), 0.0);
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// The whole position at the end.
    pub(crate) fn steps(&self) -> i64 {
        self.steps
    }

    /// The exact position at the end.
    pub(crate) fn position(&self) -> f64 {
        self.steps as f64 + self.start.offset
    }

    pub(crate) fn start(&self) -> Start {
        self.start
    }

    /// The moves, each with its path.
    pub(crate) fn moves(&self) -> impl Iterator<Item = (&PlannedMove, &str)> {
        self.moves.iter().zip(self.paths.iter().map(String::as_str))
    }

    pub(crate) fn last(&self) -> Option<&Profile> {
        self.moves.last().map(|last| &last.profile)
    }

    pub(crate) fn into_moves(self) -> Vec<PlannedMove> {
        self.moves
    }

    pub(crate) fn into_plan(self) -> AxisPlan {
        AxisPlan::new(self.moves, self.duration_s, self.steps, self.start.offset)
    }
}
