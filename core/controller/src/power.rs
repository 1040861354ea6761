//! Power, emergency stop and self-test (CONTROLLER G2).

use crate::{
    controller::{Controller, NEVER},
    input::Signal,
    parameters::Policy,
    state::{Alarm, State},
};

impl Controller {
    /// Reacts to the power before anything else; returns whether the other reactions of this cycle follow.
    pub(crate) fn power(&mut self, now: u64) -> bool {
        let has_power = self.inputs.raw(Signal::Power);
        match self.state {
            State::Off if has_power => self.restart(now),
            State::Off => return false,
            State::PowerLoss if has_power => {
                self.dies = NEVER;
                if !self.eeprom.is_idle() || self.wants_closing() {
                    return false;
                }
                self.restart(now);
            }
            State::PowerLoss => {
                self.hold_up(now);
                return false;
            }
            _ if has_power => {}
            _ => {
                self.motor_off(now);
                (self.state, self.alarm) = (State::PowerLoss, Alarm::None);
                (self.wants_opening, self.wants_save, self.reads) = (false, false, NEVER);
                self.eeprom.drop_rest(now);
                self.writes_journal = false;
                self.hold_up(now);
                return false;
            }
        }
        true
    }

    /// Without power: the hold-up time, then power-off.
    fn hold_up(&mut self, now: u64) {
        if self.dies == NEVER {
            self.dies = now.saturating_add(self.parameters.memory.hold_up_cycles);
        }
        if self.dies > now {
            return;
        }
        self.dies = NEVER;
        (self.state, self.position, self.trust) = (State::Off, 0, 0);
        self.pins.clear_dir(now);
        self.eeprom.die(now);
        self.writes_journal = false;
        self.inputs.die();
    }

    /// SELF_TEST and the reset state from the next cycle on.
    fn restart(&mut self, now: u64) {
        (self.state, self.position, self.trust, self.outputs) = (State::SelfTest, 0, 0, 0);
        self.pins.power_on(now);
        self.pins.clear_dir(now);
        self.inputs.restart();
        (self.is_read, self.is_opened, self.is_stopped) = (false, false, false);
        let self_test = self.parameters.self_test_cycles;
        self.reads = now.saturating_add(1).saturating_add(self_test.into());
        self.newest = self.find_newest();
    }

    pub(crate) fn estop(&mut self, now: u64) {
        if !self.inputs.raw(Signal::Estop) || matches!(self.state, State::Off | State::PowerLoss) {
            return;
        }
        self.motor_off(now);
        if self.state == State::SelfTest {
            self.is_stopped = true;
        } else {
            self.raise(Alarm::Estop);
        }
    }

    /// EN = 0 and STEP = 0 at once; outputs 0; program, move and timer dropped.
    fn motor_off(&mut self, now: u64) {
        self.pins.power_off(now);
        if let Some(motion) = self.motion.take() {
            self.check_last_step(&motion);
        }
        self.trust = self.trust.min(1);
        self.outputs = 0;
        self.drop_program();
    }

    pub(crate) fn self_test(&mut self, now: u64) {
        if self.state != State::SelfTest {
            return;
        }
        if self.reads <= now {
            self.reads = NEVER;
            self.read();
            self.is_read = true;
            self.wants_opening = self.parameters.memory.policy == Policy::PowerLoss;
            self.is_opened = !self.wants_opening;
        }
        if self.is_read && self.is_opened {
            if self.is_stopped {
                self.raise(Alarm::Estop);
            } else if self.is_unknown {
                self.raise(Alarm::Memory);
            } else {
                self.state = State::Ready;
            }
        }
    }
}
