//! Entries in cycles in which something happens in the story's run.

use super::super::parameters::{Case, Controller, Group, Input};
use super::super::run::Outcome;
use super::Dice;
use super::script::Script;

/// The most interesting states.
const RUNNING: u64 = 3;
const WAIT: u64 = 5;
const PAUSING: u64 = 6;
const JOG: u64 = 8;
const RETURNING: u64 = 9;
const HOMING: u64 = 10;

impl Dice {
    /// Entries in the cycles of records, or shortly before or after them.
    pub(super) fn aim(&mut self, scripts: &mut [Script], case: &Case, outcome: &Outcome) {
        for _ in 0..self.between(1, 6) {
            let index = self.below(scripts.len() as u64) as usize;
            let panel = &outcome.controllers[index].panel;
            let record = panel[self.below(panel.len() as u64) as usize];
            // States that are left in this record's cycle: the cause was one cycle earlier.
            let is_lively =
                |word: u64| [RUNNING, WAIT, PAUSING, JOG, RETURNING, HOMING].contains(&(word & 15));
            let lively: Vec<(u64, u64)> = panel
                .windows(2)
                .filter(|pair| is_lively(pair[0].word))
                .map(|pair| (pair[0].word, pair[1].cycle - 1))
                .collect();
            let controller = &case.controllers[index];
            let writes = 17 * controller.memory.byte_write_cycles;
            let later = self.pick(&[0, 0, 0, 1, writes]);
            let near = self.pick(&[0, 0, 1, 2, 3, 4]);
            if self.chance(20) && self.aim_at_dir(scripts, case, outcome, index) {
                continue;
            }
            if self.chance(50) && !lively.is_empty() {
                let (word, at) = self.pick(&lively);
                let (after, ahead) = self.pick(&[(0, 0), (0, 0), (0, 0), (1, 0), (2, 0), (0, 1)]);
                let at = (at + after + self.below(later + 1)).saturating_sub(ahead);
                self.strike_state(&mut scripts[index], controller, word, at);
                continue;
            }
            let at = if self.chance(60) {
                record.cycle
            } else {
                outcome.trace[self.below(outcome.trace.len() as u64) as usize].0
            };
            let at = (at + near).saturating_sub(2) + self.below(later + 1);
            let to = if self.chance(50) { 0 } else { index };
            self.strike(&mut scripts[to], &case.controllers[to], at);
        }
    }

    /// A stop between the start of a move and its change of DIR; `false`: DIR never changes.
    fn aim_at_dir(&mut self, scripts: &mut [Script], case: &Case, outcome: &Outcome, index: usize) -> bool {
        let dir = |levels: u64| levels >> (16 + index) & 1;
        let changes: Vec<u64> = outcome
            .trace
            .windows(2)
            .filter(|pair| dir(pair[0].1) != dir(pair[1].1))
            .map(|pair| pair[1].0)
            .collect();
        if changes.is_empty() {
            return false;
        }
        let at = self.pick(&changes).saturating_sub(self.between(1, case.h + 1)).max(1);
        let controller = &case.controllers[index];
        match self.below(4) {
            0 => {
                self.stops(&mut scripts[0], controller, at);
            }
            1 => {
                let (limit, level) = (self.pick(&[Input::LimitMin, Input::LimitMax]), true);
                self.sense(&mut scripts[index], controller, limit, level, at);
            }
            2 => {
                let button = self.pick(&[Input::JogPlus, Input::JogMinus]);
                self.press_at(&mut scripts[index], controller, button, at);
            }
            _ => {
                self.press_at(&mut scripts[index], controller, Input::Pause, at);
            }
        }
        true
    }

    /// The most interesting input in a state, near the cycle in which it ends.
    fn strike_state(&mut self, script: &mut Script, of: &Controller, word: u64, at: u64) {
        let group = of.groups.get((word >> 16 & 0x1FF).wrapping_sub(1) as usize);
        let before =
            self.pick(&[0, 0, 0, 1, of.debounce_cycles, script.step, 4 * script.step, 20 * script.step]);
        let at = at.saturating_sub(self.below(before + 1)).max(1);
        match word & 15 {
            WAIT => {
                if let Some(Group::Wait { input, level, .. }) = group {
                    self.sense(script, of, *input, *level, at);
                }
                if self.chance(30) {
                    self.press_at(script, of, Input::Pause, at);
                }
            }
            PAUSING if self.chance(50) => {
                // While the last pulse is still high.
                let early = self.between(0, script.pulse);
                self.press_at(script, of, Input::Start, at.saturating_sub(early));
            }
            RUNNING | PAUSING | RETURNING if self.chance(70) => {
                self.press_at(script, of, Input::Pause, at);
                if self.chance(70) {
                    let soon = self.pick(&[2, of.debounce_cycles + 1, 3 * script.step, 30 * script.step]);
                    let soon = self.between(0, soon);
                    self.press_at(script, of, Input::Start, at + soon);
                }
            }
            HOMING => {
                let switches = [Input::HomeSwitch, Input::LimitMin, Input::LimitMax];
                let (input, level) = (self.pick(&switches), self.chance(60));
                self.sense(script, of, input, level, at);
            }
            JOG => {
                let button = self.pick(&[Input::JogPlus, Input::JogMinus, Input::Debug, Input::Start]);
                self.press_at(script, of, button, at);
            }
            _ => self.strike(script, of, at),
        }
    }

    /// A press whose debounced rise is in cycle `at`.
    fn press_at(&mut self, script: &mut Script, of: &Controller, button: Input, at: u64) -> u64 {
        self.press(script, of, button, at.saturating_sub(of.debounce_cycles).max(1))
    }

    /// A sensor whose debounced change is in cycle `at`, if the script may change it.
    fn sense(&mut self, script: &mut Script, of: &Controller, input: Input, level: bool, at: u64) {
        if script.free.contains(&input) {
            let from = at.saturating_sub(of.sensor_debounce_cycles).max(1);
            script.level(from, input, level);
            script.level(from + self.between(1, 40 * script.step), input, !level);
        }
    }

    /// Start, and near one cycle of its move: `until`, pause and start again.
    pub(super) fn duel(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let until = of.groups.iter().find_map(|group| match group {
            Group::Move(order) => order.until,
            _ => None,
        });
        let end = self.press(script, of, Input::Start, t);
        let middle = end + self.between(1, 300 * script.step);
        let mut last = end;
        for button in [Input::Pause, Input::Start] {
            let near = self.pick(&[2, 3, 20]) * script.step;
            let at = middle + self.between(0, near);
            last = self.press_at(script, of, button, at).max(last);
        }
        if let Some(until) = until {
            let near = self.pick(&[2, 10, 40]) * script.step;
            let at = (middle + near).saturating_sub(self.between(0, 2 * near));
            self.sense(script, of, until.input, until.level, at);
        }
        last + self.between(1, 100 * script.step)
    }

    /// An E-stop stops a motion for a cycle or two, is cleared, and another motion begins immediately.
    pub(super) fn quick(&mut self, script: &mut Script, of: &Controller, t: u64) -> u64 {
        let t = self.jogs(script, of, t);
        let estop = t.saturating_sub(self.between(0, 5 * script.step)).max(1);
        let off = estop + self.between(1, 2);
        script.level(estop, Input::Estop, true);
        script.level(off, Input::Estop, false);
        let clear = off + self.between(0, 2) + of.debounce_cycles;
        let end = self.press_at(script, of, Input::Clear, clear);
        let button = self.pick(&[Input::JogMinus, Input::JogPlus, Input::Start]);
        let soon = clear + self.below(3);
        self.press_at(script, of, button, soon).max(end)
    }

    /// One entry with an effect in cycle `at`.
    fn strike(&mut self, script: &mut Script, of: &Controller, at: u64) {
        let at = at.max(1);
        let pressed = at.saturating_sub(of.debounce_cycles).max(1);
        match self.below(10) {
            0..=2 => {
                self.cuts(script, of, at);
            }
            3 => {
                self.stops(script, of, at);
            }
            4 | 5 => {
                let (input, level) = (self.pick(&script.free.clone()), self.chance(70));
                self.sense(script, of, input, level, at);
            }
            6 if of.axis.is_some() => {
                let steps = self.whole(-60, 60);
                script.push(at, steps);
            }
            _ => {
                let button = self.any_button();
                let end = self.press(script, of, button, pressed);
                if self.chance(30) {
                    let button = self.any_button();
                    let before = self.between(0, 3);
                    self.press(script, of, button, end.saturating_sub(before));
                }
            }
        }
    }
}
