//! Reactions to the inputs of a cycle, in the order of CONTROLLER G1.4.

use crate::{
    controller::{Controller, NEVER, Paused},
    state::{Alarm, State},
};

impl Controller {
    pub(crate) fn react(&mut self, now: u64) {
        if !self.power(now) {
            return;
        }
        self.estop(now);
        self.homing_switch();
        self.limits();
        self.until();
        self.waiting(now);
        self.ended(now);
        self.time(now);
        self.buttons(now);
        self.wait_condition(now);
        self.self_test(now);
    }

    /// Checks the limits while a step is due or the move waits.
    fn limits(&mut self) {
        let Some(motion) = &self.motion else { return };
        if !motion.is_active() || !self.is_limited(motion) {
            return;
        }
        if let Some(motion) = &mut self.motion {
            motion.is_limited = true;
            motion.stop();
            self.pins.keep_dir();
        }
    }

    /// Checks `until` while a step is due or the move waits, unless it brakes already.
    fn until(&mut self) {
        let inputs = &self.inputs;
        let Some(motion) = &mut self.motion else { return };
        if motion.is_active()
            && !motion.brakes
            && motion.until.is_some_and(|(input, level)| inputs.level(input) == level)
        {
            motion.until_met = true;
            motion.brake();
            self.keep_dir_of_stopped();
        }
    }

    pub(crate) fn keep_dir_of_stopped(&mut self) {
        if self.motion.as_ref().is_some_and(|motion| !motion.is_active()) {
            self.pins.keep_dir();
        }
    }

    /// Begins a group, or ends a `wait` by its timeout.
    fn time(&mut self, now: u64) {
        if self.timer > now {
            return;
        }
        match self.state {
            State::Running | State::Delay => {
                self.timer = NEVER;
                self.begin_group(now);
            }
            State::Wait if !self.is_waited() => self.time_out(now),
            _ => {}
        }
    }

    pub(crate) fn raise(&mut self, alarm: Alarm) {
        self.state = State::Alarm;
        self.alarm = alarm;
        self.drop_program();
    }

    pub(crate) fn drop_program(&mut self) {
        self.program = None;
        self.paused = None;
        self.timer = NEVER;
    }

    pub(crate) fn go_on(&mut self, now: u64) {
        match self.paused.take() {
            Some(Paused::Move(motion)) => {
                self.state = self.state_of(motion.purpose);
                self.begin_rest(now, &motion);
            }
            Some(Paused::Time(state, left)) => {
                self.state = state;
                self.timer = left.map_or(NEVER, |left| now.saturating_add(left));
            }
            None => {}
        }
    }
}
