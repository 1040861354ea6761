//! Raw and debounced levels of the inputs (CONTROLLER G1.3).
//!
//! ```text
//! raw        ___┌─┐_┌────────────   the debounced level changes in the first cycle c
//! debounced  _______________┌────   in which the raw level has been constant for c - N..c
//!                   ╎<- N ->╎
//! ```

use crate::input::{SIGNALS, Signal};

const NEVER: u64 = u64::MAX;
const _: () = assert!(SIGNALS <= 32);

/// Debounce times in cycles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times {
    pub(crate) buttons: u64,
    pub(crate) sensors: u64,
}

impl Times {
    fn of(self, signal: Signal, level: bool) -> u64 {
        match signal {
            Signal::Power => 0,
            Signal::Estop if level => 0,
            _ if signal.is_sensor() => self.sensors,
            _ => self.buttons,
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Inputs {
    times: Times,
    raw: u32,
    debounced: u32,
    /// When each debounced level changes to the raw one; [`NEVER`] if they agree.
    due: [u64; SIGNALS],
    first_due: u64,
    pressed: u32,
    released: u32,
}

const fn bit(signal: Signal) -> u32 {
    1 << signal as u32
}

impl Inputs {
    /// Initially power is 1 and all other inputs are 0.
    pub(crate) fn new(times: Times) -> Self {
        let raw = bit(Signal::Power);
        let due = [NEVER; SIGNALS];
        Self { times, raw, debounced: raw, due, first_due: NEVER, pressed: 0, released: 0 }
    }

    /// Sets the raw level from cycle `now` on. Without power, `debounces` is false.
    pub(crate) fn set(&mut self, now: u64, signal: Signal, level: bool, debounces: bool) {
        if self.raw(signal) == level {
            return;
        }
        self.raw ^= bit(signal);
        if let Some(due) = self.due.get_mut(signal as usize) {
            *due = if debounces && (self.debounced & bit(signal) != 0) != level {
                now.saturating_add(self.times.of(signal, level))
            } else {
                NEVER
            };
        }
        self.first_due = self.due.iter().copied().min().unwrap_or(NEVER);
    }

    /// Updates the debounced levels that are due in cycle `now`.
    pub(crate) fn debounce(&mut self, now: u64) {
        (self.pressed, self.released) = (0, 0);
        if self.first_due > now {
            return;
        }
        let mut changed = 0;
        for (index, due) in self.due.iter_mut().enumerate() {
            if *due <= now {
                *due = NEVER;
                changed |= 1 << index;
            }
        }
        self.debounced ^= changed;
        self.pressed = changed & self.debounced;
        self.released = changed & !self.debounced;
        self.first_due = self.due.iter().copied().min().unwrap_or(NEVER);
    }

    /// Sets the debounced levels to the raw ones without edges, because a self-test begins.
    pub(crate) fn restart(&mut self) {
        self.debounced = self.raw;
        (self.pressed, self.released) = (0, 0);
        (self.due, self.first_due) = ([NEVER; SIGNALS], NEVER);
    }

    /// Cancels pending changes, because the power is off.
    pub(crate) fn stop_debouncing(&mut self) {
        (self.due, self.first_due) = ([NEVER; SIGNALS], NEVER);
    }

    pub(crate) const fn all_raw(&self) -> u32 {
        self.raw
    }

    pub(crate) const fn raw(&self, signal: Signal) -> bool {
        self.raw & bit(signal) != 0
    }

    pub(crate) const fn level(&self, signal: Signal) -> bool {
        self.debounced & bit(signal) != 0
    }

    pub(crate) const fn is_pressed(&self, signal: Signal) -> bool {
        self.pressed & bit(signal) != 0
    }

    pub(crate) const fn is_released(&self, signal: Signal) -> bool {
        self.released & bit(signal) != 0
    }

    pub(crate) const fn has_edges(&self) -> bool {
        self.pressed | self.released != 0
    }

    pub(crate) const fn due(&self) -> u64 {
        self.first_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_must_be_constant_for_n_cycles_after_its_change() {
        let mut inputs = Inputs::new(Times { buttons: 3, sensors: 0 });
        // Cycle, raw level of `start`, whether a press is reported.
        let rows = [
            (1, true, false),
            (2, false, false),
            (3, true, false),
            (5, true, false),
            (6, true, true),
            (7, true, false),
            (8, false, false),
            (10, true, false),
            (13, true, false),
        ];
        for (now, level, expected) in rows {
            inputs.set(now, Signal::Start, level, true);
            inputs.debounce(now);
            assert_eq!(inputs.is_pressed(Signal::Start), expected, "cycle {now}");
        }
        assert!(inputs.level(Signal::Start));
    }

    #[test]
    fn the_e_stop_rises_immediately_and_falls_debounced() {
        let mut inputs = Inputs::new(Times { buttons: 3, sensors: 0 });
        for (now, level, expected) in
            [(1, true, true), (2, false, true), (4, false, true), (5, false, false), (6, true, true)]
        {
            inputs.set(now, Signal::Estop, level, true);
            inputs.debounce(now);
            assert_eq!(inputs.level(Signal::Estop), expected, "cycle {now}");
        }
    }

    #[test]
    fn a_button_held_when_self_test_begins_is_not_pressed() {
        let mut inputs = Inputs::new(Times { buttons: 3, sensors: 0 });
        inputs.set(1, Signal::Start, true, false);
        inputs.debounce(1);
        inputs.restart();
        assert!(inputs.level(Signal::Start) && !inputs.is_pressed(Signal::Start));
        assert_eq!(inputs.due(), NEVER);
    }
}
