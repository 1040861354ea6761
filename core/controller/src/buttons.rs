//! The effect of each button in each state (CONTROLLER G2).

use crate::controller::{Controller, Edit, NEVER, Paused, Press};
use crate::state::{Alarm, State, trust};
use crate::{input::Signal, motion::Purpose, parameters::Group};
use stepscope_peripheral::units::Instant;

/// An entry has its last six digits.
const ENTRY_MODULUS: u32 = 1_000_000;

impl Controller {
    /// Handles the buttons that were pressed or released in this cycle, in the order of [`Signal::ALL`].
    pub(crate) fn handle_buttons(&mut self, now: u64) {
        if !self.inputs.has_edges() {
            return;
        }
        for button in Signal::ALL.into_iter().filter(|signal| signal.is_button()) {
            if self.inputs.is_pressed(button) && !self.press(now, button) {
                self.ignored.push(Press { cycle: Instant(now), button, state: self.state });
            }
            if self.inputs.is_released(button) && self.is_jogging_with(button) {
                self.end_jog();
            }
            // A move that this button stopped must end before the next button is handled.
            self.end_stopped_move(now);
        }
    }

    /// Whether this is the button of the current jog.
    fn is_jogging_with(&self, button: Signal) -> bool {
        let right = match button {
            Signal::JogPlus => true,
            Signal::JogMinus => false,
            _ => return false,
        };
        self.state == State::Jog && self.motion.as_ref().is_some_and(|motion| motion.right == right)
    }

    /// Handles a press; returns whether it had an effect.
    fn press(&mut self, now: u64, button: Signal) -> bool {
        if self.state == State::Edit {
            return self.press_in_edit(button);
        }
        match button {
            Signal::Clear => return self.clear(now),
            Signal::Start => return self.start(now),
            Signal::Pause => return self.pause(now),
            Signal::JogPlus | Signal::JogMinus => return self.press_jog(now, button),
            Signal::Zero if self.state == State::Ready => self.zero(now),
            Signal::Home if matches!(self.state, State::Ready | State::Debug) => {
                self.home(now);
                return self.parameters.home.is_some();
            }
            Signal::Debug if self.state == State::Ready => self.state = State::Debug,
            Signal::Debug if self.state == State::Debug => self.state = State::Ready,
            Signal::Ok if self.state == State::Debug => {
                (self.position, self.trust) = (0, trust::SURE);
                self.axis.set_zero(0);
            }
            Signal::System if self.state == State::Ready => {
                (self.state, self.edit) = (State::Edit, Edit::default());
            }
            _ => return false,
        }
        true
    }

    fn clear(&mut self, now: u64) -> bool {
        match self.state {
            State::Alarm if !self.inputs.level(Signal::Estop) => {
                (self.state, self.alarm) = (State::Ready, Alarm::None);
                self.pins.power_on(now);
            }
            State::Paused => {
                self.cancel_program();
                self.state = State::Ready;
            }
            _ => return false,
        }
        true
    }

    fn start(&mut self, now: u64) -> bool {
        match self.state {
            State::Ready => {
                let begins_with_homing = self.parameters.groups.first() == Some(&Group::Home);
                if self.trust < self.parameters.least_trust && !begins_with_homing {
                    self.raise(Alarm::Trust);
                } else {
                    self.begin_program(now);
                }
            }
            State::Paused => self.resume(now),
            State::Pausing => self.stop_braking(),
            _ => return false,
        }
        true
    }

    /// Continues a pausing move, unless it must brake for its `until`.
    fn stop_braking(&mut self) {
        let Some(motion) = &mut self.motion else { return };
        let inputs = &self.inputs;
        let is_met = motion.until.is_some_and(|(input, level)| inputs.level(input) == level);
        motion.until_met |= motion.is_active() && is_met;
        motion.is_braking = motion.until_met;
        let purpose = motion.purpose;
        self.state = self.state_of(purpose);
    }

    fn pause(&mut self, now: u64) -> bool {
        match self.state {
            State::Running | State::Returning if self.motion.is_some() => {
                self.state = State::Pausing;
                if let Some(motion) = &mut self.motion {
                    motion.brake();
                }
                self.keep_dir_if_stopped();
            }
            State::Running | State::Delay | State::Wait => {
                let time_left = (self.timer != NEVER).then(|| self.timer.saturating_sub(now));
                self.paused = Some(Paused::Time(self.state, time_left));
                (self.state, self.timer) = (State::Paused, NEVER);
            }
            _ => return false,
        }
        true
    }

    fn press_jog(&mut self, now: u64, button: Signal) -> bool {
        match self.state {
            State::Ready | State::Debug => self.jog(now, button == Signal::JogPlus),
            State::Jog if !self.is_jogging_with(button) => self.end_jog(),
            _ => return false,
        }
        true
    }

    fn zero(&mut self, now: u64) {
        if self.trust >= self.parameters.least_trust.max(trust::HELD) {
            self.return_to_zero(now, Purpose::Return);
        } else if self.parameters.home.is_some() {
            self.home(now);
        } else {
            self.raise(Alarm::Trust);
        }
    }

    fn press_in_edit(&mut self, button: Signal) -> bool {
        match (button, button.digit()) {
            (_, Some(digit)) => {
                let entry = self.edit.entry.unwrap_or(0);
                self.edit.entry = Some((entry * 10 + u32::from(digit)) % ENTRY_MODULUS);
            }
            (Signal::System, _) => self.next_number(),
            (Signal::Clear, _) => self.edit.entry = Some(0),
            (Signal::Ok, _) => self.store_entry(),
            (Signal::Back, _) => {
                self.state = State::Ready;
                self.edit = Edit::default();
                self.needs_number_save |= core::mem::take(&mut self.has_unsaved_numbers);
            }
            _ => return false,
        }
        true
    }

    fn next_number(&mut self) {
        let number = (self.edit.number + 1) % self.parameters.number_count();
        self.edit = Edit { number, entry: None };
    }

    /// Stores the entry and selects the next number. An entry that is out of range is dropped.
    fn store_entry(&mut self) {
        if let Some(entry) = self.edit.entry.take() {
            match self.numbers.store(&self.parameters, self.edit.number, entry) {
                None => return,
                Some(has_changed) => self.has_unsaved_numbers |= has_changed,
            }
        }
        self.next_number();
    }
}
