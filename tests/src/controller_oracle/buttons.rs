//! G2: the effect of a press; G6: the jog; G2 and G8: EDIT.

use super::engine::{Motion, Order};
use super::parameters::{Input, Release};
use super::room::{Alarm, Room, State};

/// The order of the buttons within a cycle (G1).
pub(super) const ORDER: [Input; 21] = [
    Input::Clear,
    Input::Start,
    Input::Pause,
    Input::JogPlus,
    Input::JogMinus,
    Input::Zero,
    Input::Home,
    Input::Debug,
    Input::System,
    Input::Ok,
    Input::Back,
    Input::Key(0),
    Input::Key(1),
    Input::Key(2),
    Input::Key(3),
    Input::Key(4),
    Input::Key(5),
    Input::Key(6),
    Input::Key(7),
    Input::Key(8),
    Input::Key(9),
];

/// Number and entry of EDIT.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Edit {
    pub(super) number: usize,
    /// `None`: nothing entered.
    pub(super) entry: Option<i64>,
}

/// Steps of a jog without limit.
const WITHOUT_END: i128 = i128::MAX / 4;

impl Room {
    /// A press or a release.
    pub(super) fn button(&mut self, button: Input) {
        if let Input::JogPlus | Input::JogMinus = button
            && self.s.inputs.is_released(button)
        {
            self.jog_is_released(button == Input::JogPlus);
        }
        if !self.s.inputs.is_pressed(button) {
            return;
        }
        match button {
            Input::Clear => self.clear(),
            Input::Start => self.start(),
            Input::Pause => self.pause(),
            Input::JogPlus => self.jog_is_pressed(true),
            Input::JogMinus => self.jog_is_pressed(false),
            Input::Zero => self.zero(),
            Input::Home => {
                if let State::Ready | State::Debug = self.s.state
                    && self.plan.controller.home.is_some()
                {
                    self.begin_homing();
                }
            }
            Input::Debug => match self.s.state {
                State::Ready => self.s.state = State::Debug,
                State::Debug => self.s.state = State::Ready,
                _ => {}
            },
            Input::System => self.system(),
            Input::Ok => match self.s.state {
                State::Debug => self.zero_is_set(0),
                State::Edit => self.enter(),
                _ => {}
            },
            Input::Back => self.back(),
            Input::Key(digit) => self.digit(digit),
            _ => {}
        }
    }

    fn clear(&mut self) {
        match self.s.state {
            State::Alarm if !self.level(Input::Estop) => {
                self.s.state = State::Ready;
                self.s.alarm = Alarm::None;
                self.s.en = true;
            }
            State::Paused => {
                self.s.state = State::Ready;
                self.drop_program();
            }
            State::Edit => self.s.edit.entry = Some(0),
            _ => {}
        }
    }

    fn start(&mut self) {
        match self.s.state {
            State::Ready => self.start_program(),
            State::Paused => {
                let Some(kept) = self.s.kept.take() else { return };
                if kept.rem > 0 {
                    self.begin_rest(kept.rem, kept.right);
                } else {
                    self.s.state = kept.state;
                    self.s.timer = kept.left.map(|left| self.now + left);
                }
            }
            State::Pausing => {
                let program = self.s.program.is_some();
                self.s.state = if program { State::Running } else { State::Returning };
                self.brakes_no_longer();
            }
            _ => {}
        }
    }

    fn pause(&mut self) {
        match self.s.state {
            State::Running | State::Returning if self.s.motion.is_some() => {
                self.s.state = State::Pausing;
                self.brake();
            }
            State::Running | State::Delay | State::Wait => {
                // Reading: a wait whose time ends in this cycle, while its level is present, keeps 0 cycles, and after
                // `start` waits without limit (like a wait of 0).
                let left = self.s.timer.take().map(|timer| timer - self.now);
                let state = self.s.state;
                self.s.kept = Some(super::room::Kept { rem: 0, right: false, state, left });
                self.s.state = State::Paused;
            }
            _ => {}
        }
    }

    fn zero(&mut self) {
        if self.s.state != State::Ready {
            return;
        }
        if self.s.trust >= self.plan.controller.least_trust.max(1) {
            self.begin_return(Order::Return);
        } else if self.plan.controller.home.is_some() {
            self.begin_homing();
        } else {
            self.alarm(Alarm::Trust);
        }
    }

    fn jog_is_pressed(&mut self, right: bool) {
        match self.s.state {
            State::Ready | State::Debug => self.begin_jog(right),
            State::Jog if self.s.motion.as_ref().is_some_and(|motion| motion.right != right) => {
                self.brake();
            }
            _ => {}
        }
    }

    fn jog_is_released(&mut self, right: bool) {
        if self.s.state == State::Jog && self.s.motion.as_ref().is_some_and(|motion| motion.right == right) {
            self.brake();
        }
    }

    fn begin_jog(&mut self, right: bool) {
        self.s.jog_from_debug = self.s.state == State::Debug;
        self.s.state = State::Jog;
        let [speed_hz, fine_hz] = self.s.numbers.jog();
        let rate_hz = if self.s.jog_from_debug { fine_hz } else { speed_hz };
        let controller = &self.plan.controller;
        let position = i128::from(self.s.position);
        let rem = match &controller.soft_limits {
            Some(limits) if self.s.trust >= 1 => {
                let (least, most) = (i128::from(limits.min_steps), i128::from(limits.max_steps));
                if right { (most - position).max(0) } else { (position - least).max(0) }
            }
            _ => WITHOUT_END,
        };
        let mut motion = Motion::constant(Order::Jog, rem, right, rate_hz);
        motion.first_is_least = true;
        // Reading: `short_move` does not apply to a jog, even if soft limits make it short.
        // `at_once`: u stays 0, so braking stops at once.
        if controller.jog.release == Release::Ramp {
            motion.level = controller.jog.level;
            motion.top = self.plan.table(motion.level).steps_to(rate_hz);
        }
        self.begin(motion);
    }

    fn system(&mut self) {
        match self.s.state {
            State::Ready => {
                self.s.state = State::Edit;
                self.s.edit = Edit::default();
            }
            State::Edit => self.next_number(),
            _ => {}
        }
    }

    fn next_number(&mut self) {
        let number = (self.s.edit.number + 1) % self.s.numbers.count();
        self.s.edit = Edit { number, entry: None };
    }

    /// READY; the numbers are saved if `ok` has changed one since they were read or saved.
    fn back(&mut self) {
        if self.s.state != State::Edit {
            return;
        }
        self.s.state = State::Ready;
        if std::mem::take(&mut self.s.numbers.changed) {
            self.s.eeprom.save_is_wanted = true;
        }
    }

    /// Appends a digit to the entry, which keeps its last six.
    fn digit(&mut self, digit: u8) {
        if self.s.state == State::Edit {
            let before = self.s.edit.entry.unwrap_or(0);
            self.s.edit.entry = Some((before * 10 + i64::from(digit)) % 1_000_000);
        }
    }

    /// `ok` in EDIT.
    fn enter(&mut self) {
        if let Some(entry) = self.s.edit.entry {
            if !self.s.numbers.is_in_range(&self.plan.controller, self.s.edit.number, entry) {
                // Reading: without an entry the number does not change.
                self.s.edit.entry = None;
                return;
            }
            self.s.numbers.store(self.s.edit.number, entry);
        }
        self.next_number();
    }
}
