//! Reactions to the inputs of a cycle, in the order of CONTROLLER G1.4.

use crate::controller::{Controller, NEVER, Paused};
use crate::state::{Alarm, State};

impl Controller {
    pub(crate) fn react(&mut self, now: u64) {
        if !self.handle_power(now) {
            return;
        }
        self.check_estop(now);
        self.check_homing_switch();
        self.check_limits();
        self.check_until();
        self.start_waiting_move(now);
        self.end_stopped_move(now);
        self.handle_timer(now);
        self.handle_buttons(now);
        self.check_wait(now);
        self.continue_self_test(now);
    }

    /// Stops a move that may not continue toward a closed limit switch.
    fn check_limits(&mut self) {
        let Some(motion) = &self.motion else { return };
        if !motion.is_active() || !self.is_blocked_by_limit(motion) {
            return;
        }
        if let Some(motion) = &mut self.motion {
            motion.has_hit_limit = true;
            motion.stop();
            self.pins.keep_dir();
        }
    }

    /// Brakes a move whose `until` level has come.
    fn check_until(&mut self) {
        let inputs = &self.inputs;
        let Some(motion) = &mut self.motion else { return };
        if motion.is_active()
            && !motion.is_braking
            && motion.until.is_some_and(|(input, level)| inputs.level(input) == level)
        {
            motion.until_met = true;
            motion.brake();
            self.keep_dir_if_stopped();
        }
    }

    /// Cancels the change of DIR for a move that stopped before its first step.
    pub(crate) fn keep_dir_if_stopped(&mut self) {
        if self.motion.as_ref().is_some_and(|motion| !motion.is_active()) {
            self.pins.keep_dir();
        }
    }

    /// Begins the group that is due, or ends a `wait` by its timeout.
    fn handle_timer(&mut self, now: u64) {
        if self.timer > now {
            return;
        }
        match self.state {
            State::Running | State::Delay => {
                self.timer = NEVER;
                self.begin_group(now);
            }
            State::Wait if !self.is_wait_met() => self.time_out(now),
            _ => {}
        }
    }

    pub(crate) fn raise(&mut self, alarm: Alarm) {
        self.state = State::Alarm;
        self.alarm = alarm;
        self.cancel_program();
    }

    pub(crate) fn cancel_program(&mut self) {
        self.program = None;
        self.paused = None;
        self.timer = NEVER;
    }

    pub(crate) fn resume(&mut self, now: u64) {
        match self.paused.take() {
            Some(Paused::Move(motion)) => {
                self.state = self.state_of(motion.purpose);
                self.resume_move(now, &motion);
            }
            Some(Paused::Time(state, left)) => {
                self.state = state;
                self.timer = left.map_or(NEVER, |left| now.saturating_add(left));
            }
            None => {}
        }
    }
}
