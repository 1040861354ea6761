//! Curves of phases of constant jerk: ramps between two speeds, changed targets and waypoints.
//!
//! ```text
//! acceleration |  .--.            each phase is a cubic about its reference, which is its start or its end: the one
//!              | /    \      /    nearer to rest, so no digits cancel there
//!              +------------/-
//! ```

use crate::curves::curve::greater;
use alloc::vec::Vec;

/// Position in steps, speed in steps/s and acceleration in steps/s^2 at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    pub position: f64,
    pub speed: f64,
    pub acceleration: f64,
}

/// A state whose position counts from `origin`, so that no digits cancel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeState {
    pub origin: f64,
    pub state: State,
}

impl RelativeState {
    pub(crate) fn absolute(self) -> State {
        State { position: self.origin + self.state.position, ..self.state }
    }
}

impl State {
    /// The state `time_s` later, or earlier if negative, under a constant jerk.
    fn after(self, time_s: f64, jerk: f64) -> Self {
        let Self { position, speed, acceleration } = self;
        Self {
            position: position + travel(self, time_s, jerk),
            speed: speed + time_s * (acceleration + time_s * (jerk / 2.0)),
            acceleration: acceleration + time_s * jerk,
        }
    }
}

fn travel(from: State, time_s: f64, jerk: f64) -> f64 {
    time_s * (from.speed + time_s * (from.acceleration / 2.0 + time_s * (jerk / 6.0)))
}

/// A span of constant jerk. Its acceleration at the start may differ from that at the end of the previous span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Phase {
    pub(crate) time_s: f64,
    pub(crate) acceleration: f64,
    pub(crate) jerk: f64,
}

impl Phase {
    pub(crate) fn mirrored(self) -> Self {
        Self { time_s: self.time_s, acceleration: -self.acceleration, jerk: -self.jerk }
    }

    /// A span at a constant speed.
    pub(crate) fn cruise(time_s: f64) -> Self {
        Self { time_s, acceleration: 0.0, jerk: 0.0 }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct PlacedPhase {
    start_s: f64,
    end_s: f64,
    /// Time at which the curve has the state of reference.
    reference_s: f64,
    reference: State,
    jerk: f64,
}

/// Phases one after another.
#[derive(Clone, Debug, PartialEq)]
pub struct Phases {
    /// Invariant: each lasts longer than 0 and starts at the end of the previous one.
    placed: Vec<PlacedPhase>,
    duration_s: f64,
    end: State,
}

impl Phases {
    pub(crate) fn new(position: f64, speed: f64, phases: impl IntoIterator<Item = Phase>) -> Self {
        let end = State { position, speed, acceleration: 0.0 };
        let mut all = Self { placed: Vec::new(), duration_s: 0.0, end };
        all.extend(phases);
        all
    }

    pub(crate) fn extend(&mut self, phases: impl IntoIterator<Item = Phase>) {
        for phase in phases {
            self.push(phase);
        }
    }

    fn push(&mut self, phase: Phase) {
        let start = State { acceleration: phase.acceleration, ..self.end };
        let (start_s, end_s) = (self.duration_s, self.duration_s + phase.time_s);
        if end_s > start_s {
            let reference = start;
            self.placed.push(PlacedPhase {
                start_s,
                end_s,
                reference_s: start_s,
                reference,
                jerk: phase.jerk,
            });
            self.end = start.after(phase.time_s, phase.jerk);
            self.duration_s = end_s;
        } else {
            self.end.acceleration = phase.acceleration;
        }
    }

    /// The same phases with an exact end: those from the last speed maximum on count from their ends. All phases must count
    /// from their starts before.
    pub(crate) fn ending_at(mut self, position: f64, speed: f64) -> Self {
        let mut end = State { position, speed, acceleration: self.end.acceleration };
        self.end = end;
        for placed in self.placed.iter_mut().rev() {
            let at_end = placed.reference.after(placed.end_s - placed.reference_s, placed.jerk);
            if libm::fabs(at_end.speed) > libm::fabs(placed.reference.speed) {
                break;
            }
            let length_s = placed.end_s - placed.start_s;
            let acceleration = placed.reference.acceleration + placed.jerk * length_s;
            placed.reference = State { acceleration, ..end };
            placed.reference_s = placed.end_s;
            end = placed.reference.after(-length_s, placed.jerk);
        }
        self
    }

    /// The same phases with an exact end position, from which theirs differs by roundings.
    pub(crate) fn with_end(mut self, position: f64) -> Self {
        self.end.position = position;
        self
    }

    /// The first of these phases, up to a time; the speed is constant after the last one.
    pub(crate) fn until(mut self, time_s: f64) -> Self {
        let end = self.state(time_s);
        if time_s > self.duration_s {
            self.push(Phase::cruise(time_s - self.duration_s));
        }
        self.placed.retain(|placed| placed.start_s < time_s);
        if let Some(last) = self.placed.last_mut() {
            last.end_s = time_s;
        }
        (self.end, self.duration_s) = (end, time_s);
        self
    }

    /// Appends a section that lasts exactly `duration_s`. It counts positions from the end of this one.
    pub(crate) fn append(&mut self, section: &Self, duration_s: f64) {
        let (start_s, position) = (self.duration_s, self.end.position);
        let shifted = |state: State| State { position: position + state.position, ..state };
        let end_s = start_s + duration_s;
        let count = section.placed.len();
        self.placed.extend(section.placed.iter().enumerate().map(|(index, placed)| PlacedPhase {
            start_s: start_s + placed.start_s,
            end_s: if index + 1 == count { end_s } else { start_s + placed.end_s },
            reference_s: start_s + placed.reference_s,
            reference: shifted(placed.reference),
            jerk: placed.jerk,
        }));
        (self.duration_s, self.end) = (end_s, shifted(section.end));
    }

    /// The same curve with all positions times `factor`, from `start` on.
    pub(crate) fn scaled(mut self, factor: f64, start: f64) -> Self {
        let scaled = |state: State| State {
            position: start + factor * state.position,
            speed: factor * state.speed,
            acceleration: factor * state.acceleration,
        };
        for placed in &mut self.placed {
            (placed.reference, placed.jerk) = (scaled(placed.reference), factor * placed.jerk);
        }
        self.end = scaled(self.end);
        self
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.duration_s
    }

    pub(crate) fn end(&self) -> State {
        self.end
    }

    /// Ends of the phases in s, rising.
    pub(crate) fn ends_s(&self) -> impl Iterator<Item = f64> + '_ {
        self.placed.iter().map(|placed| placed.end_s)
    }

    /// The state just before `time_s`; after the end the speed stays.
    pub(crate) fn state(&self, time_s: f64) -> State {
        if time_s > self.duration_s {
            return State { acceleration: 0.0, ..self.end }.after(time_s - self.duration_s, 0.0);
        }
        self.state_by(time_s, time_s).absolute()
    }

    /// The state at `time_s` by the formula of the phase before `within_s`.
    pub(crate) fn state_by(&self, time_s: f64, within_s: f64) -> RelativeState {
        let after = self.placed.partition_point(|placed| placed.start_s < within_s);
        match self.placed.get(after.saturating_sub(1)) {
            Some(PlacedPhase { reference_s, reference, jerk, .. }) => {
                let from_reference = State { position: 0.0, ..*reference };
                let state = from_reference.after(time_s - reference_s, *jerk);
                RelativeState { origin: reference.position, state }
            }
            None => RelativeState { origin: self.end.position, state: State { position: 0.0, ..self.end } },
        }
    }

    /// Maximum magnitude of the jerk.
    pub(crate) fn peak_jerk(&self) -> f64 {
        self.placed.iter().fold(0.0, |max, placed| greater(max, libm::fabs(placed.jerk)))
    }
}
