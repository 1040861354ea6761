//! Drives the pins of a chip: a [`Runner`](crate::Runner) needs inputs, STEP, DIR and EN, a panel, an EEPROM, and a
//! free-running timer of `clock_hz` ticks per second. One tick is one cycle of the machine.
//!
//! The chip calls [`Runner::poll`](crate::Runner::poll) at the tick returned by the last call and when an input changes. It
//! may call it more often.
//!
//! ```
//! use stepscope_controller::{Runner, State, chip::{Chip, Face, RawLevels}, input::Signal, parameters::Setup};
//! use stepscope_peripheral::{signal::Levels, units::Instant};
//!
//! /// A chip without pins, whose EEPROM takes no time. Start is pressed at tick 3 000 000.
//! struct Bench { now: u64, rises: u32, memory: Vec<u8> }
//! impl Chip for Bench {
//!     fn now(&mut self) -> Instant { Instant(self.now) }
//!     fn inputs(&mut self) -> RawLevels { RawLevels::default().with(Signal::Start, self.now >= 3_000_000) }
//!     fn write_pins(&mut self, levels: Levels) { self.rises += u32::from(levels.step()); }
//!     fn show(&mut self, _: Face) {}
//!     fn read_byte(&mut self, address: usize) -> u8 { self.memory[address] }
//!     fn begin_byte(&mut self, address: usize, byte: u8) { self.memory[address] = byte; }
//!     fn is_writing(&mut self) -> bool { false }
//! }
//!
//! let checked = Setup::default().check().expect("the defaults are valid");
//! let mut chip = Bench { now: 0, rises: 0, memory: Runner::factory_memory(&checked) };
//! let mut runner = Runner::power_up(Instant(0), &checked, &mut chip).expect("one controller without an axis");
//! // A real chip sleeps until the tick or an input; this one skips the time.
//! let mut wake = Some(Instant(0));
//! while let Some(at) = wake.or((chip.now < 3_000_000).then_some(Instant(3_000_000))) {
//!     chip.now = at.0;
//!     wake = runner.poll(at, &mut chip);
//! }
//! assert_eq!((runner.machine().state(0), chip.rises), (Some(State::Ready), 10_000));
//! ```

use crate::input::{SIGNALS, Signal};
use crate::panel::{self, Led, Word};
use alloc::string::String;
use stepscope_peripheral::{signal::Levels, units::Instant};

/// The hardware that a [`Runner`](crate::Runner) drives: one channel with its inputs, panel and EEPROM.
pub trait Chip {
    /// The current tick of a free-running timer that neither goes back nor wraps. Extend shorter timers in software.
    fn now(&mut self) -> Instant;

    /// Current levels of all inputs, not debounced. Inputs without a pin keep their level of [`RawLevels::default`].
    fn inputs(&mut self) -> RawLevels;

    /// Sets the pins of STEP 0, DIR 0 and EN now. This chip has no RX, TX and DE.
    fn write_pins(&mut self, levels: Levels);

    /// The panel changed: state, alarm, trust, outputs, group, loop or edited number. It is not called for each step of a
    /// move; [`Runner::face`](crate::Runner::face) returns the position at any time. Update a slow display later: an edge
    /// may be due in the same tick.
    fn show(&mut self, face: Face);

    /// Reads a byte of the EEPROM while none is being written.
    fn read_byte(&mut self, address: usize) -> u8;

    /// Begins to write a byte of the EEPROM while none is being written, and does not wait.
    fn begin_byte(&mut self, address: usize, byte: u8);

    /// Whether the last byte is still being written.
    fn is_writing(&mut self) -> bool;
}

/// Levels of all inputs, one bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawLevels(u32);

const _: () = assert!(SIGNALS <= u32::BITS as usize);

impl Default for RawLevels {
    /// No button is pressed, no switch is closed, the power is on.
    fn default() -> Self {
        Self(1 << Signal::Power as u32)
    }
}

impl RawLevels {
    /// The same levels, with `signal` at `level`.
    pub const fn with(self, signal: Signal, level: bool) -> Self {
        let bit = 1 << signal as u32;
        Self(if level { self.0 | bit } else { self.0 & !bit })
    }

    pub const fn level(self, signal: Signal) -> bool {
        self.0 >> signal as u32 & 1 != 0
    }

    /// The signals whose levels differ from those in `before`.
    pub(crate) fn changed(self, before: Self) -> impl Iterator<Item = Signal> {
        Signal::ALL.into_iter().filter(move |&signal| self.level(signal) != before.level(signal))
    }
}

/// Contents of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// Tick of the change.
    pub at: Instant,
    /// State, alarm, trust, outputs, group and loop.
    pub word: Word,
    /// In steps.
    pub position: i64,
    /// The displayed number without its decimal point.
    pub display: i64,
    /// Decimal places of a length, 0 to 3.
    pub decimals: u8,
}

impl Face {
    /// The six characters of the LCD. An edited number has no decimal point.
    pub fn lcd(self) -> String {
        let is_length = self.word.state() != crate::State::Edit;
        panel::lcd(self.display, if is_length { self.decimals } else { 0 })
    }

    /// The signal of the LED.
    pub fn led(self) -> Led {
        self.word.led()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_input_has_its_level_and_changes_are_named() {
        let levels = RawLevels::default().with(Signal::Estop, true).with(Signal::In3, true);
        assert!(levels.level(Signal::Power) && levels.level(Signal::In3) && !levels.level(Signal::Start));
        let changed: Vec<Signal> = levels.with(Signal::Estop, false).changed(levels).collect();
        assert_eq!(changed, [Signal::Estop]);
    }

    #[test]
    fn a_length_has_its_decimal_point_and_an_edited_number_has_none() {
        let face = |state| Face { at: Instant(0), word: Word(state), position: 0, display: 305, decimals: 1 };
        assert_eq!((face(2).lcd().as_str(), face(12).lcd().as_str()), ("  30.5", "   305"));
    }
}
