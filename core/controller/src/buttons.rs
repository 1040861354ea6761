//! The effect of each button in each state (CONTROLLER G2).

use crate::{
    controller::{Controller, Edit, NEVER, Paused, Press},
    input::Signal,
    motion::Purpose,
    parameters::Group,
    state::{Alarm, State},
};
use stepscope_peripheral::units::Instant;

const ENTRY: u32 = 1_000_000;

impl Controller {
    /// Handles the buttons pressed or released in this cycle, in their order.
    pub(crate) fn buttons(&mut self, now: u64) {
        if !self.inputs.has_edges() {
            return;
        }
        for button in Signal::ALL.into_iter().filter(|signal| signal.is_button()) {
            if self.inputs.is_pressed(button) && !self.press(now, button) {
                self.ignored.push(Press { cycle: Instant(now), button, state: self.state });
            }
            if self.inputs.is_released(button) && self.jogs(button) {
                self.end_jog();
            }
            // A move that this button ended must end before the next button.
            self.ended(now);
        }
    }

    fn jogs(&self, button: Signal) -> bool {
        let right = match button {
            Signal::JogPlus => true,
            Signal::JogMinus => false,
            _ => return false,
        };
        self.state == State::Jog && self.motion.as_ref().is_some_and(|motion| motion.right == right)
    }

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
                (self.position, self.trust) = (0, 2);
                self.axis.zero_is_set(0);
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
                self.drop_program();
                self.state = State::Ready;
            }
            _ => return false,
        }
        true
    }

    fn start(&mut self, now: u64) -> bool {
        match self.state {
            State::Ready => {
                let homes = self.parameters.groups.first() == Some(&Group::Home);
                if self.trust < self.parameters.least_trust && !homes {
                    self.raise(Alarm::Trust);
                } else {
                    self.begin_program(now);
                }
            }
            State::Paused => self.go_on(now),
            State::Pausing => self.stop_braking(),
            _ => return false,
        }
        true
    }

    /// Continues a pausing move; it keeps braking only for `until`.
    fn stop_braking(&mut self) {
        let Some(motion) = &mut self.motion else { return };
        let inputs = &self.inputs;
        let is_met = motion.until.is_some_and(|(input, level)| inputs.level(input) == level);
        motion.until_met |= motion.is_active() && is_met;
        motion.brakes = motion.until_met;
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
                self.keep_dir_of_stopped();
            }
            State::Running | State::Delay | State::Wait => {
                let left = (self.timer != NEVER).then(|| self.timer.saturating_sub(now));
                self.paused = Some(Paused::Time(self.state, left));
                (self.state, self.timer) = (State::Paused, NEVER);
            }
            _ => return false,
        }
        true
    }

    fn press_jog(&mut self, now: u64, button: Signal) -> bool {
        match self.state {
            State::Ready | State::Debug => self.jog(now, button == Signal::JogPlus),
            State::Jog if !self.jogs(button) => self.end_jog(),
            _ => return false,
        }
        true
    }

    fn zero(&mut self, now: u64) {
        if self.trust >= self.parameters.least_trust.max(1) {
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
                self.edit.entry = Some((entry * 10 + u32::from(digit)) % ENTRY);
            }
            (Signal::System, _) => self.next_number(),
            (Signal::Clear, _) => self.edit.entry = Some(0),
            (Signal::Ok, _) => self.take_entry(),
            (Signal::Back, _) => {
                self.state = State::Ready;
                self.edit = Edit::default();
                self.wants_save |= core::mem::take(&mut self.is_changed);
            }
            _ => return false,
        }
        true
    }

    fn next_number(&mut self) {
        let number = (self.edit.number + 1) % self.parameters.numbers();
        self.edit = Edit { number, entry: None };
    }

    /// Stores an entry that is in range. Then, or without an entry, selects the next number.
    fn take_entry(&mut self) {
        if let Some(entry) = self.edit.entry.take() {
            match self.numbers.store(&self.parameters, self.edit.number, entry) {
                None => return,
                Some(is_changed) => self.is_changed |= is_changed,
            }
        }
        self.next_number();
    }
}
