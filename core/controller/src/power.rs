//! Power, emergency stop and self-test (CONTROLLER G2).

use crate::controller::{Controller, NEVER};
use crate::state::{Alarm, State, trust};
use crate::{input::Signal, parameters::Policy};

impl Controller {
    /// Handles power before all other inputs; returns whether they are handled in this cycle, too.
    pub(crate) fn handle_power(&mut self, now: u64) -> bool {
        let has_power = self.inputs.raw(Signal::Power);
        match self.state {
            State::Off if has_power => self.restart(now),
            State::Off => return false,
            State::PowerLoss if has_power => {
                self.off_at = NEVER;
                if !self.eeprom.is_idle() || self.needs_closing_record() {
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
                (self.needs_opening_record, self.needs_number_save, self.read_at) = (false, false, NEVER);
                self.eeprom.finish_byte_only(now);
                self.writes_journal = false;
                self.hold_up(now);
                return false;
            }
        }
        true
    }

    /// Waits for the end of the hold-up time, then switches off.
    fn hold_up(&mut self, now: u64) {
        if self.off_at == NEVER {
            self.off_at = now.saturating_add(self.parameters.memory.hold_up_cycles);
        }
        if self.off_at > now {
            return;
        }
        self.off_at = NEVER;
        (self.state, self.position, self.trust) = (State::Off, 0, trust::LOST);
        self.pins.clear_dir(now);
        self.eeprom.cut_power(now);
        self.writes_journal = false;
        self.inputs.stop_debouncing();
    }

    /// Resets and begins the self-test; it takes effect in the next cycle.
    fn restart(&mut self, now: u64) {
        (self.state, self.position, self.trust, self.outputs) = (State::SelfTest, 0, trust::LOST, 0);
        self.pins.power_on(now);
        self.pins.clear_dir(now);
        self.inputs.restart();
        (self.is_memory_read, self.has_opening_record, self.is_stopped_in_self_test) = (false, false, false);
        let self_test = self.parameters.self_test_cycles;
        self.read_at = now.saturating_add(1).saturating_add(self_test.into());
        self.newest = self.find_newest();
    }

    pub(crate) fn check_estop(&mut self, now: u64) {
        if !self.inputs.raw(Signal::Estop) || matches!(self.state, State::Off | State::PowerLoss) {
            return;
        }
        self.motor_off(now);
        if self.state == State::SelfTest {
            self.is_stopped_in_self_test = true;
        } else {
            self.raise(Alarm::Estop);
        }
    }

    /// Switches the driver and the outputs off, and drops program, move and timer.
    fn motor_off(&mut self, now: u64) {
        self.pins.power_off(now);
        if let Some(motion) = self.motion.take() {
            self.check_last_step(&motion);
        }
        self.trust = self.trust.min(trust::HELD);
        self.outputs = 0;
        self.cancel_program();
    }

    pub(crate) fn continue_self_test(&mut self, now: u64) {
        if self.state != State::SelfTest {
            return;
        }
        if self.read_at <= now {
            self.read_at = NEVER;
            self.read();
            self.is_memory_read = true;
            self.needs_opening_record = self.parameters.memory.policy == Policy::PowerLoss;
            self.has_opening_record = !self.needs_opening_record;
        }
        if self.is_memory_read && self.has_opening_record {
            if self.is_stopped_in_self_test {
                self.raise(Alarm::Estop);
            } else if self.is_memory_invalid {
                self.raise(Alarm::Memory);
            } else {
                self.state = State::Ready;
            }
        }
    }
}
