//! G6's homing: the legs seek, off and fine, and the return.

use super::engine::{Motion, Order};
use super::parameters::Home;
use super::room::{Alarm, Room, State};

/// Legs of homing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Leg {
    Seek,
    Off,
    Fine,
    Return,
}

/// State of homing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Homing {
    leg: Leg,
    /// The switch has reached the level that the leg waits for.
    found: bool,
}

impl Homing {
    pub(super) fn is_return(&self) -> bool {
        self.leg == Leg::Return
    }
}

impl Room {
    fn switch(&self) -> bool {
        self.plan.controller.home.as_ref().is_some_and(|home| self.level(home.switch))
    }

    /// Started by a button, or as a group.
    pub(super) fn begin_homing(&mut self) {
        self.s.state = State::Homing;
        self.begin_leg(if self.switch() { Leg::Off } else { Leg::Seek });
    }

    fn begin_leg(&mut self, leg: Leg) {
        let Some(home) = &self.plan.controller.home else { return };
        let Home { right: towards, coarse_hz, fine_hz, pull_off_steps, max_travel_steps, .. } = *home;
        let (right, rate_hz) = match leg {
            Leg::Seek => (towards, coarse_hz),
            Leg::Off => (!towards, coarse_hz),
            Leg::Fine | Leg::Return => (towards, fine_hz),
        };
        let mut rem = i128::from(max_travel_steps);
        let mut found = false;
        if leg == Leg::Off && !self.switch() {
            found = true;
            rem = i128::from(pull_off_steps);
        }
        self.s.homing = Some(Homing { leg, found });
        if leg == Leg::Return {
            self.begin_return(Order::Homing);
        } else {
            self.begin(Motion::constant(Order::Homing, rem, right, rate_hz));
        }
    }

    /// The switch is checked while a step is due or the leg waits.
    pub(super) fn switch_in_homing(&mut self) {
        let (Some(Homing { leg, found }), Some(home)) = (self.s.homing.clone(), &self.plan.controller.home)
        else {
            return;
        };
        let (position, pull_off) = (home.position_steps as i32, i128::from(home.pull_off_steps));
        if found || !self.s.motion.as_ref().is_some_and(Motion::is_heeding) {
            return;
        }
        let switch = self.switch();
        match leg {
            Leg::Seek if switch => self.stop_at_once(),
            Leg::Off if !switch => {
                // Reading: regardless of the rest of `max_travel_steps`.
                if let Some(motion) = &mut self.s.motion {
                    motion.rem = pull_off;
                }
                if pull_off == 0 {
                    self.stop_at_once();
                }
            }
            Leg::Fine if switch => {
                self.zero_is_set(position);
                self.stop_at_once();
            }
            _ => return,
        }
        self.s.homing = Some(Homing { leg, found: true });
    }

    /// A leg begins where the previous one ends.
    pub(super) fn leg_ends(&mut self) {
        let Some(Homing { leg, found }) = self.s.homing.take() else { return };
        let position = self.plan.controller.home.as_ref().map_or(0, |home| home.position_steps);
        match leg {
            Leg::Seek if found => self.begin_leg(Leg::Off),
            Leg::Off if found && !self.switch() => self.begin_leg(Leg::Fine),
            Leg::Fine if found && position != 0 => self.begin_leg(Leg::Return),
            Leg::Fine if found => self.homed(),
            Leg::Return => self.homed(),
            _ => self.alarm(Alarm::Homing),
        }
    }

    fn homed(&mut self) {
        if self.s.program.is_some() {
            self.s.state = State::Running;
            self.home_of_group_ends();
        } else {
            self.s.state = State::Ready;
        }
    }
}
