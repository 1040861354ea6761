//! Homing (CONTROLLER G6): to the switch, off it, and slowly to it again.
//!
//! ```text
//! switch closed      ────┐┌──────────┐┌───         seek, coarse: until it closes
//! seek         ──────────┘│          ││            off, coarse: until it opens, and pull_off_steps more
//! off               ┌─────┘          ││            fine: until it closes, at position_steps
//! fine              └────────────────┘└ return
//! ```

use crate::{
    controller::Controller,
    motion::{Climb, Leg, Motion, Purpose},
    state::{Alarm, State},
};

impl Controller {
    pub(crate) fn home(&mut self, now: u64) {
        let Some(home) = &self.parameters.home else { return };
        let leg = if self.inputs.level(home.switch) { Leg::Off } else { Leg::Seek };
        self.state = State::Homing;
        self.begin_leg(now, leg);
    }

    fn begin_leg(&mut self, now: u64, leg: Leg) {
        let Some(home) = &self.parameters.home else { return };
        let towards = home.direction != 0;
        let (right, plateau_hz) = match leg {
            Leg::Seek => (towards, home.coarse_hz),
            Leg::Off => (!towards, home.coarse_hz),
            Leg::Fine => (towards, home.fine_hz),
        };
        let climb = Climb { table: self.table(1), top: 0, plateau_hz };
        let mut motion =
            Motion::new(Purpose::Leg(leg), right, home.max_travel_steps.into(), climb, self.clock_hz);
        if leg == Leg::Off && !self.inputs.level(home.switch) {
            motion.is_found = true;
            motion.rem = home.pull_off_steps.into();
        }
        self.begin_move(now, motion);
    }

    /// Checks the switch while a step is due or the leg waits.
    pub(crate) fn homing_switch(&mut self) {
        let (Some(motion), Some(home)) = (&mut self.motion, &self.parameters.home) else { return };
        let Purpose::Leg(leg) = motion.purpose else { return };
        let is_closed = self.inputs.level(home.switch);
        if !motion.is_active() || motion.is_found || is_closed == (leg == Leg::Off) {
            return;
        }
        motion.is_found = true;
        if leg == Leg::Off && home.pull_off_steps > 0 {
            motion.rem = home.pull_off_steps.into();
            return;
        }
        if leg == Leg::Off {
            motion.rem = 0;
        }
        motion.stop();
        if leg == Leg::Fine {
            // 2^31 wraps to -2^31.
            self.position = home.position_steps as i32;
            self.trust = 2;
            self.axis.zero_is_set(self.position);
        }
        self.pins.keep_dir();
    }

    pub(crate) fn end_leg(&mut self, now: u64, leg: Leg, motion: &Motion) {
        let switch = self.parameters.home.as_ref().map(|home| home.switch);
        let is_closed = switch.is_some_and(|switch| self.inputs.level(switch));
        let is_good =
            motion.is_found && !motion.is_limited && (leg != Leg::Off || !is_closed && motion.rem == 0);
        match leg {
            _ if !is_good => self.raise(Alarm::Homing),
            Leg::Seek => self.begin_leg(now, Leg::Off),
            Leg::Off => self.begin_leg(now, Leg::Fine),
            Leg::Fine if self.home_position() != 0 => self.return_to_zero(now, Purpose::HomeReturn),
            Leg::Fine => self.end_homing(now),
        }
    }

    fn home_position(&self) -> i64 {
        self.parameters.home.as_ref().map_or(0, |home| home.position_steps)
    }

    /// Homing is done: READY, or the program continues.
    pub(crate) fn end_homing(&mut self, now: u64) {
        if self.program.is_some() {
            self.take_position_as_base();
            self.end_group(now, 0, None);
        } else {
            self.state = State::Ready;
        }
    }
}
