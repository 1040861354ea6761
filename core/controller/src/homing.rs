//! Homing (CONTROLLER G6): toward the switch, away from it, and slowly toward it again.
//!
//! ```text
//! switch closed      ────┐┌──────────┐┌───         seek, coarse: until it closes
//! seek         ──────────┘│          ││            off, coarse: until it opens, and pull_off_steps more
//! off               ┌─────┘          ││            fine: until it closes, at position_steps
//! fine              └────────────────┘└ return
//! ```

use crate::controller::Controller;
use crate::motion::{Climb, Leg, Motion, Purpose};
use crate::state::{Alarm, State, trust};

impl Controller {
    /// Begins homing; it skips the search if the switch is closed already.
    pub(crate) fn home(&mut self, now: u64) {
        let Some(home) = &self.parameters.home else { return };
        let leg = if self.inputs.level(home.switch) { Leg::Off } else { Leg::Seek };
        self.state = State::Homing;
        self.begin_leg(now, leg);
    }

    fn begin_leg(&mut self, now: u64, leg: Leg) {
        let Some(home) = &self.parameters.home else { return };
        let toward_switch = home.direction != 0;
        let (right, plateau_hz) = match leg {
            Leg::Seek => (toward_switch, home.coarse_hz),
            Leg::Off => (!toward_switch, home.coarse_hz),
            Leg::Fine => (toward_switch, home.fine_hz),
        };
        let climb = Climb { table: self.table(1), top: 0, plateau_hz };
        let mut motion =
            Motion::new(Purpose::Leg(leg), right, home.max_travel_steps.into(), climb, self.clock_hz);
        if leg == Leg::Off && !self.inputs.level(home.switch) {
            motion.has_found_switch = true;
            motion.steps_left = home.pull_off_steps.into();
        }
        self.begin_move(now, motion);
    }

    /// Checks the switch while a step is pending or the leg waits for memory.
    pub(crate) fn check_homing_switch(&mut self) {
        let (Some(motion), Some(home)) = (&mut self.motion, &self.parameters.home) else { return };
        let Purpose::Leg(leg) = motion.purpose else { return };
        let is_closed = self.inputs.level(home.switch);
        if !motion.is_active() || motion.has_found_switch || is_closed == (leg == Leg::Off) {
            return;
        }
        motion.has_found_switch = true;
        if leg == Leg::Off && home.pull_off_steps > 0 {
            motion.steps_left = home.pull_off_steps.into();
            return;
        }
        if leg == Leg::Off {
            motion.steps_left = 0;
        }
        motion.stop();
        if leg == Leg::Fine {
            // 2^31 wraps to -2^31.
            self.position = home.position_steps as i32;
            self.trust = trust::SURE;
            self.axis.set_zero(self.position);
        }
        self.pins.keep_dir();
    }

    pub(crate) fn end_leg(&mut self, now: u64, leg: Leg, motion: &Motion) {
        let switch = self.parameters.home.as_ref().map(|home| home.switch);
        let is_closed = switch.is_some_and(|switch| self.inputs.level(switch));
        let is_success = motion.has_found_switch
            && !motion.has_hit_limit
            && (leg != Leg::Off || !is_closed && motion.steps_left == 0);
        match leg {
            _ if !is_success => self.raise(Alarm::Homing),
            Leg::Seek => self.begin_leg(now, Leg::Off),
            Leg::Off => self.begin_leg(now, Leg::Fine),
            Leg::Fine if self.home_position() != 0 => self.return_to_zero(now, Purpose::HomeReturn),
            Leg::Fine => self.end_homing(now),
        }
    }

    fn home_position(&self) -> i64 {
        self.parameters.home.as_ref().map_or(0, |home| home.position_steps)
    }

    /// Ends homing: READY, or the program continues.
    pub(crate) fn end_homing(&mut self, now: u64) {
        if self.program.is_some() {
            self.set_base_to_position();
            self.end_group(now, 0, None);
        } else {
            self.state = State::Ready;
        }
    }
}
