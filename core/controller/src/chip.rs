//! What a chip has to offer so that the machine drives real pins: levels of its inputs, STEP, DIR and EN, a panel, an
//! EEPROM, and a timer that runs freely. A [`Runner`](crate::Runner) does the rest; a cycle of the machine is a tick of
//! that timer, `clock_hz` of them a second.
//!
//! The chip calls [`Runner::poll`](crate::Runner::poll) when the tick comes that the call before named, and when an input
//! changes. It may call it more often.
//!
//! ```
//! use stepscope_controller::{Runner, State, chip::{Chip, Face, RawLevels}, input::Signal, parameters::Setup};
//! use stepscope_peripheral::{signal::Levels, units::Instant};
//!
//! /// A chip without pins, whose EEPROM takes no time, and somebody who presses start at tick 3 000 000.
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
//! let checked = Setup::default().check().expect("the defaults hold");
//! let mut chip = Bench { now: 0, rises: 0, memory: Runner::factory_memory(&checked) };
//! let mut runner = Runner::power_up(Instant(0), &checked, &mut chip).expect("it is one controller");
//! // A chip sleeps until a tick or an input comes; this one has no time to lose.
//! let mut wake = Some(Instant(0));
//! while let Some(at) = wake.or((chip.now < 3_000_000).then_some(Instant(3_000_000))) {
//!     chip.now = at.0;
//!     wake = runner.poll(at, &mut chip);
//! }
//! assert_eq!((runner.machine().state(0), chip.rises), (Some(State::Ready), 10_000));
//! ```

use crate::{
    input::{SIGNALS, Signal},
    panel::{self, Led, Word},
};
use alloc::string::String;
use stepscope_peripheral::{signal::Levels, units::Instant};

/// A chip with one controller on it.
pub trait Chip {
    /// The tick that it is: a timer that runs freely, never back, and never around. A timer of fewer bits is counted on
    /// in software.
    fn now(&mut self) -> Instant;

    /// Levels of all inputs as they are now, not debounced. What has no pin keeps its level of
    /// [`RawLevels::default`].
    fn inputs(&mut self) -> RawLevels;

    /// Puts the levels of STEP 0, DIR 0 and EN on their pins, now. RX, TX and DE are none of this chip's.
    fn write_pins(&mut self, levels: Levels);

    /// The panel shows something else: state, alarm, trust, outputs, group or loop, or what is edited. While it moves the
    /// position changes with each step and this is not called; [`Runner::face`](crate::Runner::face) tells it at any time.
    /// An edge may be due in the very tick, so a slow display is written elsewhere.
    fn show(&mut self, face: Face);

    /// A byte of the EEPROM, while none is being written.
    fn read_byte(&mut self, address: usize) -> u8;

    /// Begins to write a byte of the EEPROM and does not wait; none is being written.
    fn begin_byte(&mut self, address: usize, byte: u8);

    /// Whether the byte that was begun last is still being written.
    fn is_writing(&mut self) -> bool;
}

/// Levels of all inputs, a bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RawLevels(u32);

const _: () = assert!(SIGNALS <= u32::BITS as usize);

impl Default for RawLevels {
    /// Nothing is pressed and no switch is closed; the power is there.
    fn default() -> Self {
        Self(1 << Signal::Power as u32)
    }
}

impl RawLevels {
    /// The same, with this level of one of them.
    #[must_use]
    pub const fn with(self, signal: Signal, level: bool) -> Self {
        let bit = 1 << signal as u32;
        Self(if level { self.0 | bit } else { self.0 & !bit })
    }

    /// The level of one of them.
    #[must_use]
    pub const fn level(self, signal: Signal) -> bool {
        self.0 >> signal as u32 & 1 != 0
    }

    pub(crate) fn changed(self, before: Self) -> impl Iterator<Item = Signal> {
        Signal::ALL.into_iter().filter(move |&signal| self.level(signal) != before.level(signal))
    }
}

/// What stands on the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Face {
    pub at: Instant,
    /// State, alarm, trust, outputs, group and loop.
    pub word: Word,
    /// Position in steps.
    pub position: i64,
    /// What the display shows, in its digits.
    pub display: i64,
    pub decimals: u8,
}

impl Face {
    /// Six characters of the LCD. A number that is edited has no decimal point.
    #[must_use]
    pub fn lcd(self) -> String {
        let is_length = self.word.state() != crate::State::Edit;
        panel::lcd(self.display, if is_length { self.decimals } else { 0 })
    }

    /// What the LED does.
    #[must_use]
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
