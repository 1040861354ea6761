//! G2: estop, power, restart.

use super::parameters::Input;
use super::room::{Alarm, Room, SelfTest, State};

impl Room {
    /// EN = 0 and STEP = 0 (a cut pulse counts), DIR stays, outputs 0; program, move and timer are dropped.
    fn motor_off(&mut self) {
        self.jump_costs_trust();
        self.s.trust = self.s.trust.min(1);
        self.s.en = false;
        if self.s.step {
            self.s.step = false;
            self.s.fall_at = None;
            // A cut in c is a fall in c + 1.
            self.s.last_fall = Some(self.now + 1);
        }
        self.s.dir_at = None;
        self.s.outputs = 0;
        self.drop_program();
    }

    /// Raw 1, except in OFF and POWER_LOSS.
    pub(super) fn estop(&mut self) {
        if !self.s.inputs.is_raw(Input::Estop) || matches!(self.s.state, State::Off | State::PowerLoss) {
            return;
        }
        self.motor_off();
        if self.s.state == State::SelfTest {
            // Reading: in the cycle of a restart this comes after the restart, so EN stays 0.
            self.s.self_test.estop = true;
        } else {
            self.alarm(Alarm::Estop);
        }
    }

    /// The power's reaction; `false`: no other reaction in c.
    pub(super) fn power(&mut self) -> bool {
        let power = self.s.inputs.is_raw(Input::Power);
        match self.s.state {
            State::Off => {
                if power {
                    self.restart();
                }
                true
            }
            State::PowerLoss => self.power_while_lost(power),
            _ if power => true,
            _ => {
                self.motor_off();
                self.s.state = State::PowerLoss;
                self.s.alarm = Alarm::None;
                self.drop_writes();
                self.power_falls();
                false
            }
        }
    }

    /// `hold_up_cycles` are counted from here.
    fn power_falls(&mut self) {
        let dies_at = self.now + self.plan.controller.memory.hold_up_cycles;
        self.s.dies_at = Some(dies_at);
        if dies_at == self.now {
            // Reading: without hold-up it is OFF in the cycle of the fall.
            self.die();
        }
    }

    fn power_while_lost(&mut self, power: bool) -> bool {
        if power {
            // If power is back by then, this count ends.
            // Reading: even in the cycle in which the controller would switch off.
            self.s.dies_at = None;
            if self.s.eeprom.is_idle() && !self.closing_record_is_wanted() {
                self.restart();
            }
            return true;
        }
        match self.s.dies_at {
            // Another fall starts a new count.
            None => self.power_falls(),
            Some(dies_at) if dies_at == self.now => self.die(),
            Some(_) => {}
        }
        self.s.state != State::Off
    }

    /// It switches off: OFF; DIR = 0, position, trust 0.
    fn die(&mut self) {
        self.s.dies_at = None;
        self.s.state = State::Off;
        self.s.dir = false;
        self.s.position = 0;
        self.s.trust = 0;
        self.byte_dies();
    }

    /// SELF_TEST, reset state from s = c + 1 on.
    fn restart(&mut self) {
        self.s.state = State::SelfTest;
        self.s.alarm = Alarm::None;
        self.s.en = true;
        self.s.dir = false;
        self.s.outputs = 0;
        self.s.position = 0;
        self.s.trust = 0;
        self.s.self_test = SelfTest { begun: self.now + 1, estop: false, none_valid: false, opened: false };
        self.s.memory_read = false;
        self.s.inputs.debounce_all();
    }
}
