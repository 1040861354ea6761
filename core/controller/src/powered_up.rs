//! Power-up of a machine on a chip, and EEPROM timing by the chip: internals for a [`Runner`](crate::Runner)
//! (CONTROLLER G2, G7).

use crate::{
    chip::RawLevels,
    controller::{Begun, Controller},
    input::{Change, Input, Signal},
    machine::StandAlone,
};
use alloc::vec::Vec;
use stepscope_peripheral::units::Instant;

impl StandAlone {
    /// A machine before cycle 0 of a power-up, with these raw levels and this memory, and without a script.
    pub(crate) fn power_up(checked: &crate::CheckedSetup, levels: RawLevels, memory: &[u8]) -> Self {
        let mut machine = Self::new(checked);
        machine.drop_inputs();
        for controller in &mut machine.controllers {
            controller.power_up(levels, memory);
        }
        machine
    }

    /// Enters the level of an input of the first controller from cycle `at` on, unless the input has an entry in that
    /// cycle; returns whether it did. `at` has not been run.
    pub(crate) fn enter_level(&mut self, at: Instant, signal: Signal, level: bool) -> bool {
        let input = Input { cycle: at, change: Change::Level(signal, level) };
        let is_free = self.controllers.first().is_some_and(|controller| !controller.script.has(input));
        if is_free {
            self.insert(0, input);
        }
        is_free
    }

    pub(crate) fn forget(&mut self) {
        for controller in &mut self.controllers {
            controller.panel.clear();
            controller.ignored.clear();
            controller.begun = Begun::default();
        }
        self.begun = 0;
    }

    pub(crate) fn byte_due(&self) -> u64 {
        self.controllers.first().map_or(u64::MAX, |controller| controller.eeprom.due())
    }

    /// When that byte was begun, its address, and the byte.
    pub(crate) fn byte_under_way(&self) -> Option<(Instant, usize, u8)> {
        let (begun, address, byte) = self.controllers.first()?.eeprom.under_way()?;
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
    /// SELF_TEST begins with the raw levels debounced, so held buttons are no presses; an active E-stop keeps EN at 0.
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
