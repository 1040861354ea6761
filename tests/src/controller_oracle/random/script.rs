//! The script of a random controller: a story of presses, sensors and power cuts; entries for a given cycle.

use std::collections::BTreeMap;

use super::super::numbers::Numbers;
use super::super::parameters::{Case, Controller, Entry, Input, What};
use super::{Dice, homes};

/// A script in progress: at most one level per input and cycle.
pub(super) struct Script {
    entries: BTreeMap<(u64, usize), What>,
    /// It may change power, estop and clear.
    common: bool,
    /// Inputs that the axis does not drive.
    pub(super) free: Vec<Input>,
    /// Cycles of a step at the maximum speed.
    pub(super) step: u64,
    /// W.
    pub(super) pulse: u64,
}

impl Script {
    pub(super) fn new(common: bool, case: &Case, controller: &Controller) -> Self {
        let axis = controller.axis.clone().unwrap_or_default();
        let mut free: Vec<Input> = (0..4).map(Input::In).collect();
        if axis.min_switch_at_steps.is_none() {
            free.push(Input::LimitMin);
        }
        if axis.max_switch_at_steps.is_none() {
            free.push(Input::LimitMax);
        }
        if axis.home_from_steps.is_none() {
            free.push(Input::HomeSwitch);
        }
        let step = case.clock_hz / controller.max_speed_hz as u64 + 1;
        Self { entries: BTreeMap::new(), common, free, step, pulse: case.w }
    }

    pub(super) fn level(&mut self, cycle: u64, input: Input, level: bool) {
        if cycle > 0 && (self.common || !input.is_common()) {
            self.entries.entry((cycle, input.index())).or_insert(What::Level(input, level));
        }
    }

    pub(super) fn push(&mut self, cycle: u64, steps: i64) {
        self.entries.entry((cycle.max(1), usize::MAX)).or_insert(What::Push(steps));
    }

    pub(super) fn entries(&self) -> Vec<Entry> {
        self.entries.iter().map(|((cycle, _), what)| Entry { cycle: *cycle, what: *what }).collect()
    }
}

const EDIT_BUTTONS: [Input; 6] =
    [Input::System, Input::Ok, Input::Ok, Input::Clear, Input::Key(0), Input::Key(1)];

impl Dice {
    /// A debounced press; returns the cycle of its release.
    pub(super) fn press(&mut self, script: &mut Script, of: &Controller, button: Input, at: u64) -> u64 {
        let n = of.debounce_cycles;
        let held = match self.below(12) {
            // A glitch.
            0 if n > 0 => self.between(1, n),
            1 => n + self.between(1, 40 * script.step),
            _ => n + self.between(1, 8),
        };
        script.level(at, button, true);
        script.level(at + held, button, false);
        at + held
    }

    fn gap(&mut self, script: &Script, of: &Controller) -> u64 {
        let write = of.memory.byte_write_cycles;
        match self.below(8) {
            0 => self.between(1, 5),
            1 => self.between(1, of.debounce_cycles + 5),
            2 => self.between(1, 10 * script.step),
            3 => self.between(1, 20 * write),
            4 | 5 => self.between(1, 200 * script.step),
            _ => self.between(1, 1500 * script.step),
        }
    }

    /// The complete story.
    pub(super) fn tell(&mut self, script: &mut Script, of: &Controller) {
        let mut t = of.self_test_cycles + 17 * of.memory.byte_write_cycles + self.between(0, 20);
        if self.chance(20) {
            t = self.between(1, t);
        }
        if self.chance(40) {
            t = self.sets_zero(script, of, t) + self.between(1, 40) + of.debounce_cycles;
        }
        for _ in 0..self.between(1, 14) {
            if self.chance(12) {
                let (button, with) = (self.any_button(), t + self.below(2));
                self.press(script, of, button, with);
            }
            t = self.scene(script, of, t) + self.gap(script, of);
        }
        if self.chance(10) {
            // Power does not return.
            script.level(t, Input::Power, false);
        }
        if self.chance(85) {
            self.sensors(script, t);
        }
        for _ in 0..self.pick(&[0, 0, 0, 2, 6]) {
            let (at, button) = (self.between(1, t), self.any_button());
            self.press(script, of, button, at);
        }
    }

    pub(super) fn any_button(&mut self) -> Input {
        use Input::*;
        let digit = self.below(10) as u8;
        self.pick(&[
            Start,
            Start,
            Pause,
            Pause,
            JogPlus,
            JogMinus,
            Zero,
            Home,
            Debug,
            System,
            Ok,
            Back,
            Clear,
            Key(digit),
        ])
    }

    fn scene(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        match self.below(40) {
            0..=4 => self.press(script, of, Input::Start, t),
            5..=8 => self.pauses(script, of, t),
            9..=12 => self.jogs(script, of, t),
            13 | 14 => self.press(script, of, Input::Zero, t),
            15 | 16 if of.home.is_some() => self.press(script, of, Input::Home, t),
            17 | 18 => self.sets_zero(script, of, t),
            19..=21 => self.edits(script, of, t),
            22..=24 => self.clears(script, of, t),
            25 | 26 => self.stops(script, of, t),
            27 | 28 => self.cuts(script, of, t),
            29 if homes(&of.groups) => self.press(script, of, Input::Start, t),
            29 | 30 => {
                let button = self.any_button();
                self.press(script, of, button, t)
            }
            31 | 32 => self.returns(script, of, t),
            33 | 34 => self.duel(script, of, t),
            35 => self.quick(script, of, t),
            36 | 37 => self.cuts(script, of, t),
            38 => self.edits_one(script, of, t),
            _ => self.clears(script, of, t),
        }
    }

    /// Moves away from zero and back, with a pause.
    fn returns(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let rest = of.debounce_cycles + self.between(1, 20 * script.step);
        let t = self.jogs(script, of, t) + rest;
        let t = self.press(script, of, Input::Zero, t) + self.between(1, 100 * script.step);
        let t = self.press(script, of, Input::Pause, t) + self.between(1, 20 * script.step);
        self.press(script, of, Input::Start, t)
    }

    fn clears(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let t = self.press(script, of, Input::Clear, t) + of.debounce_cycles + self.between(1, 20);
        if self.chance(60) { self.press(script, of, Input::Start, t) } else { t }
    }

    /// Start, pause, and continue or abort.
    fn pauses(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let soon = self.between(1, 150 * script.step);
        let mut t = self.press(script, of, Input::Start, t) + soon;
        for _ in 0..self.between(1, 3) {
            t = self.press(script, of, Input::Pause, t);
            t += if self.chance(50) { self.between(1, 6 * script.step) } else { self.gap(script, of) };
            let button = self.pick(&[Input::Start, Input::Start, Input::Start, Input::Clear]);
            t = self.press(script, of, button, t) + self.gap(script, of);
        }
        t
    }

    pub(super) fn jogs(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let button = self.pick(&[Input::JogPlus, Input::JogMinus]);
        let held = self.pick(&[3, 60, 300, 900]) * script.step;
        let end = t + of.debounce_cycles + self.between(1, held);
        script.level(t, button, true);
        script.level(end, button, false);
        if self.chance(20) {
            let other = if button == Input::JogPlus { Input::JogMinus } else { Input::JogPlus };
            let at = if self.chance(50) { end } else { self.between(t, end) };
            script.level(at, other, true);
            script.level(at + of.debounce_cycles + self.between(1, held), other, false);
        }
        end
    }

    fn sets_zero(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let rest = 2 * of.debounce_cycles + 2;
        let mut t = self.press(script, of, Input::Debug, t) + self.between(1, 30);
        if self.chance(50) {
            t = self.jogs(script, of, t) + rest;
        }
        if self.chance(70) {
            t = self.press(script, of, Input::Ok, t) + self.between(1, rest);
        }
        if self.chance(85) { self.press(script, of, Input::Debug, t + rest) } else { t }
    }

    fn edits(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let rest = of.debounce_cycles + 1;
        let mut t = self.press(script, of, Input::System, t) + rest;
        for _ in 0..self.between(1, 16) {
            let digit = Input::Key(self.below(10) as u8);
            let button = if self.chance(40) { digit } else { self.pick(&EDIT_BUTTONS) };
            t = self.press(script, of, button, t) + rest;
        }
        if self.chance(80) { self.press(script, of, Input::Back, t) } else { t }
    }

    pub(super) fn stops(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let end = t + self.pick(&[1, 2, 30, 400]);
        script.level(t, Input::Estop, true);
        script.level(end, Input::Estop, false);
        if self.chance(85) {
            let at = end + of.debounce_cycles + self.between(0, 20);
            return self.press(script, of, Input::Clear, at);
        }
        end
    }

    pub(super) fn cuts(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let (byte, hold_up) = (of.memory.byte_write_cycles, of.memory.hold_up_cycles);
        let mut t = t;
        for _ in 0..self.pick(&[1, 1, 1, 2]) {
            let off = match self.below(5) {
                0 => self.between(1, 4),
                1 => self.between(1, hold_up + 1),
                2 => hold_up + self.below(3),
                _ => hold_up + self.between(1, 20 * byte),
            };
            script.level(t, Input::Power, false);
            script.level(t + off.max(1), Input::Power, true);
            t += off.max(1) + self.between(1, 3 * byte);
        }
        if self.chance(30) && of.axis.is_some() {
            let steps = self.whole(-40, 40);
            script.push(t.saturating_sub(self.between(1, 4 * byte)), steps);
        }
        t + of.self_test_cycles + 16 * byte
    }

    /// One number gets an allowed value.
    fn edits_one(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let rest = of.debounce_cycles + 1;
        let numbers = Numbers::of_scenario(of);
        let number = self.below(numbers.count().min(14) as u64) as usize;
        let value = loop {
            let value = self.pick(&[1, 2, 3, 12, 50, 123, of.max_speed_hz, of.groups.len() as i64]);
            if numbers.is_in_range(of, number, value) {
                break value;
            }
        };
        let mut buttons = vec![Input::System; number + 1];
        let digits = value.to_string();
        buttons.extend(digits.bytes().map(|digit| Input::Key(digit - b'0')));
        buttons.extend([Input::Ok, Input::Back]);
        let mut t = t;
        for button in buttons {
            script.level(t, button, true);
            script.level(t + rest, button, false);
            t += 2 * rest;
        }
        if self.chance(60) { self.press(script, of, Input::Start, t) } else { t }
    }

    /// Independent sensors and switches during the whole run.
    fn sensors(&mut self, script: &mut Script, end: u64) {
        for input in script.free.clone() {
            let is_limit = matches!(input, Input::LimitMin | Input::LimitMax);
            if self.chance(if is_limit { 65 } else { 30 }) {
                continue;
            }
            let period = self.pick(&[2, 10, 60, 400]) * script.step;
            let mut t = self.between(1, end);
            for _ in 0..self.between(1, 12) {
                let high = if self.chance(20) { self.between(1, 3) } else { self.between(1, period) };
                script.level(t, input, true);
                script.level(t + high, input, false);
                t += high + self.between(1, period * if is_limit { 6 } else { 2 });
                if t > end {
                    break;
                }
            }
        }
    }
}
