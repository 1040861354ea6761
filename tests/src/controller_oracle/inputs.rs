//! Step 3 of G1: raw levels, debounced levels, presses.

use super::parameters::{INPUTS, Input, What};
use super::room::{Room, State};

/// Levels of all inputs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Inputs {
    pub(super) raw: [bool; INPUTS],
    /// Cycle of the last change of each raw level.
    changed: [u64; INPUTS],
    pub(super) debounced: [bool; INPUTS],
    /// Debounced levels that rose and fell in this cycle.
    rose: [bool; INPUTS],
    fell: [bool; INPUTS],
    /// Processed entries of the script.
    entries: usize,
}

impl Inputs {
    /// Before its first entry an input is 0, and power 1.
    pub(super) fn at_reset() -> Self {
        let mut raw = [false; INPUTS];
        raw[Input::Power.index()] = true;
        Self {
            raw,
            changed: [0; INPUTS],
            debounced: raw,
            rose: [false; INPUTS],
            fell: [false; INPUTS],
            entries: 0,
        }
    }

    pub(super) fn set(&mut self, input: Input, level: bool, cycle: u64) {
        let at = input.index();
        if self.raw[at] != level {
            self.raw[at] = level;
            self.changed[at] = cycle;
        }
    }

    pub(super) fn is_raw(&self, input: Input) -> bool {
        self.raw[input.index()]
    }

    /// SELF_TEST begins with debounced = raw; held inputs are no presses.
    pub(super) fn debounce_all(&mut self) {
        self.debounced = self.raw;
        self.forget_edges();
    }

    pub(super) fn forget_edges(&mut self) {
        self.rose = [false; INPUTS];
        self.fell = [false; INPUTS];
    }

    pub(super) fn is_pressed(&self, input: Input) -> bool {
        self.rose[input.index()]
    }

    pub(super) fn is_released(&self, input: Input) -> bool {
        self.fell[input.index()]
    }
}

impl Room {
    // Reading: each controller debounces controller 0's raw power, estop and clear with its own N.
    /// N of an input whose debounced level would become `to`.
    fn debounce_cycles(&self, at: usize, to: bool) -> u64 {
        let controller = &self.plan.controller;
        if at == Input::Power.index() || (at == Input::Estop.index() && to) {
            0
        } else if at >= Input::LimitMin.index() {
            controller.sensor_debounce_cycles
        } else {
            controller.debounce_cycles
        }
    }

    /// The script's entries of c; switches that the axis drives; debouncing.
    pub(super) fn read_inputs(&mut self) {
        while let Some(entry) = self.plan.script.get(self.s.inputs.entries)
            && entry.cycle == self.now
        {
            let what = entry.what;
            self.s.inputs.entries += 1;
            match what {
                What::Level(input, level) => self.s.inputs.set(input, level, self.now),
                What::Push(steps) => self.push(steps),
            }
        }
        self.axis_drives_switches();
        // OFF debounces nothing.
        if self.s.state == State::Off {
            return;
        }
        for at in 0..INPUTS {
            let raw = self.s.inputs.raw[at];
            // It was constant in c - N..c if it changed in c - N or before.
            let stood = self.now - self.s.inputs.changed[at] >= self.debounce_cycles(at, raw);
            if raw != self.s.inputs.debounced[at] && stood {
                self.s.inputs.debounced[at] = raw;
                self.s.inputs.rose[at] = raw;
                self.s.inputs.fell[at] = !raw;
            }
        }
    }

    /// Cycle of the next entry.
    pub(super) fn next_entry(&self) -> Option<u64> {
        self.plan.script.get(self.s.inputs.entries).map(|entry| entry.cycle)
    }

    /// The next cycle in which a debounced level may become its raw one.
    pub(super) fn next_debounced(&self) -> Option<u64> {
        if self.s.state == State::Off {
            return None;
        }
        let inputs = &self.s.inputs;
        (0..INPUTS)
            .filter(|at| inputs.raw[*at] != inputs.debounced[*at])
            .map(|at| inputs.changed[at] + self.debounce_cycles(at, inputs.raw[at]))
            .min()
    }
}
