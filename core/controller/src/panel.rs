//! The panel (CONTROLLER G8): records, their digest, LCD and LED.
//!
//! ```
//! use stepscope_controller::panel::{lcd, Led, Word};
//! use stepscope_controller::{Alarm, State};
//!
//! let word = Word(13 | 2 << 4 | 1 << 8 | 3 << 16);
//! assert_eq!((word.state(), word.alarm(), word.trust(), word.group()), (State::Alarm, Alarm::Limit, 1, 3));
//! assert_eq!(word.led(), Led::Quick);
//! assert_eq!((lcd(305, 1).as_str(), lcd(1_000_000, 1).as_str()), ("  30.5", "------"));
//! ```

use crate::state::{Alarm, State};
use alloc::{format, string::String};
use core::hash::Hasher;
use stepscope_peripheral::units::Instant;
use twox_hash::XxHash64;

/// The contents of the panel from a cycle on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PanelRecord {
    /// Cycle 0, or the cycle after a change of the word or, in EDIT, of the display.
    pub cycle: Instant,
    /// State, alarm, trust, outputs, group and loop.
    pub word: Word,
    /// In steps.
    pub position: i64,
    /// The position as displayed, without its decimal point; in EDIT the entry or the value of a number.
    pub display: i64,
}

/// State, alarm, trust, outputs, group and loop in one word.
///
/// | bits | content |
/// | --- | --- |
/// | 0..=3 | state |
/// | 4..=7 | alarm |
/// | 8..=9 | trust |
/// | 12..=15 | outputs |
/// | 16..=24 | group, in EDIT the index (from 0) of the edited number; 0 without program |
/// | 32..=47 | loop; 0 without program |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Word(pub u64);

/// The status LED of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Led {
    /// Blinks quickly: an alarm.
    Quick,
    /// On: idle with trust 2.
    On,
    /// Blinks slowly.
    Slow,
}

impl Word {
    pub(crate) fn new(state: State, alarm: Alarm, trust: u8, outputs: u8, group: u64, loop_: u64) -> Self {
        let low = state as u64 | (alarm as u64) << 4 | u64::from(trust & 3) << 8;
        Self(low | u64::from(outputs & 15) << 12 | (group & 0x1ff) << 16 | (loop_ & 0xffff) << 32)
    }

    pub fn state(self) -> State {
        State::ALL.get(self.0 as usize & 15).copied().unwrap_or(State::Off)
    }

    pub fn alarm(self) -> Alarm {
        Alarm::ALL.get((self.0 >> 4) as usize & 15).copied().unwrap_or(Alarm::None)
    }

    /// Trust in the position: 0 LOST, 1 HELD, 2 SURE.
    pub const fn trust(self) -> u8 {
        (self.0 >> 8) as u8 & 3
    }

    /// Outputs 0 to 3, one bit each.
    pub const fn outputs(self) -> u8 {
        (self.0 >> 12) as u8 & 15
    }

    /// Current group from 1, in EDIT the index (from 0) of the edited number; 0 without a program.
    pub const fn group(self) -> u16 {
        (self.0 >> 16) as u16 & 0x1ff
    }

    /// Current loop from 1; 0 without a program.
    pub const fn loop_(self) -> u16 {
        (self.0 >> 32) as u16
    }

    pub fn led(self) -> Led {
        match self.state() {
            State::Alarm => Led::Quick,
            State::Ready | State::Debug | State::Edit | State::Paused if self.trust() == 2 => Led::On,
            _ => Led::Slow,
        }
    }
}

/// The six characters of the LCD: `display` with `decimals` (0 to 3) decimal places, dashes above 999999 and below -99999.
pub fn lcd(display: i64, decimals: u8) -> String {
    if !(-99_999..=999_999).contains(&display) {
        return "------".into();
    }
    let (sign, digits) = (if display < 0 { "-" } else { "" }, display.unsigned_abs());
    let text = if decimals == 0 {
        format!("{sign}{digits}")
    } else {
        let (places, scale) = (usize::from(decimals.min(3)), 10_u64.pow(decimals.min(3).into()));
        format!("{sign}{}.{:0places$}", digits / scale, digits % scale)
    };
    // The decimal point shares a digit's character, so the text may be one longer.
    format!("{text:>6}")
}

/// Digest of the panels of all controllers: XXH64, seed 0, over four little-endian words per record.
pub fn digest<'a>(panels: impl IntoIterator<Item = &'a [PanelRecord]>) -> u64 {
    let mut hasher = XxHash64::with_seed(0);
    for record in panels.into_iter().flatten() {
        for word in [record.cycle.0, record.word.0, record.position as u64, record.display as u64] {
            hasher.write(&word.to_le_bytes());
        }
    }
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lcd_has_six_digits() {
        let rows = [
            (0, 1, "   0.0"),
            (305, 1, "  30.5"),
            (-5, 1, "  -0.5"),
            (7, 3, " 0.007"),
            (42, 0, "    42"),
            (999_999, 0, "999999"),
            (999_999, 1, "99999.9"),
            (1_000_000, 1, "------"),
            (-99_999, 0, "-99999"),
            (-100_000, 0, "------"),
        ];
        for (display, decimals, expected) in rows {
            assert_eq!(lcd(display, decimals), expected, "{display} {decimals}");
        }
    }

    #[test]
    fn the_fields_of_a_word_are_read_back() {
        let word = Word::new(State::Paused, Alarm::None, 2, 0b1010, 258, 9999);
        assert_eq!(word.0, 7 | 2 << 8 | 10 << 12 | 258 << 16 | 9999 << 32);
        assert_eq!(
            (word.state(), word.outputs(), word.group(), word.loop_()),
            (State::Paused, 10, 258, 9999)
        );
        assert_eq!((word.alarm(), word.led()), (Alarm::None, Led::On));
    }
}
