//! What a [`Runner`](crate::Runner) needs of its machine: power-up, and EEPROM timing by the chip (CONTROLLER G2, G7).

use crate::controller::{Controller, GroupCounter};
use crate::input::{Change, Input, Signal};
use crate::{chip::RawLevels, machine::StandAlone};
use alloc::vec::Vec;
use stepscope_peripheral::units::Instant;

impl StandAlone {
    /// A machine before cycle 0 of a power-up, with the inputs and the memory of a chip and without a script.
    pub(crate) fn power_up(checked: &crate::CheckedSetup, levels: RawLevels, memory: &[u8]) -> Self {
        let mut machine = Self::new(checked);
        machine.drop_inputs();
        for controller in &mut machine.controllers {
            controller.power_up(levels, memory);
        }
        machine
    }

    /// Enters an input of the first controller in a future cycle; false if the input already has an entry in that cycle.
    pub(crate) fn enter_level(&mut self, at: Instant, signal: Signal, level: bool) -> bool {
        let input = Input { cycle: at, change: Change::Level(signal, level) };
        let is_free = self.controllers.first().is_some_and(|controller| !controller.script.has(input));
        if is_free {
            self.insert(0, input);
        }
        is_free
    }

    pub(crate) fn clear_history(&mut self) {
        for controller in &mut self.controllers {
            controller.panel.clear();
            controller.ignored.clear();
            controller.group_counter = GroupCounter::default();
        }
        self.groups_begun = 0;
    }

    pub(crate) fn byte_due(&self) -> u64 {
        self.controllers.first().map_or(u64::MAX, |controller| controller.eeprom.due())
    }

    /// When the byte in progress was begun, its address, and the byte.
    pub(crate) fn byte_in_progress(&self) -> Option<(Instant, usize, u8)> {
        let (begun, address, byte) = self.controllers.first()?.eeprom.byte_in_progress()?;
        Some((Instant(begun), address, byte))
    }

    pub(crate) fn postpone_byte(&mut self, cycle: u64) {
        if let (Some(controller), Some(due)) = (self.controllers.first_mut(), self.due.first_mut()) {
            controller.eeprom.postpone(cycle);
            *due = controller.due().max(self.now);
        }
    }
}

impl Controller {
    /// The self-test begins with debounced inputs, so held buttons are not pressed. An active emergency stop keeps EN at 0.
    fn power_up(&mut self, levels: RawLevels, memory: &[u8]) {
        self.eeprom.load(memory);
        self.newest = self.find_newest();
        let changed: Vec<Signal> = levels.changed(RawLevels::default()).collect();
        for signal in changed {
            self.inputs.set(0, signal, levels.level(signal), false);
        }
        self.inputs.restart();
        if levels.level(Signal::Estop) {
            self.pins.stay_off();
        }
    }
}
