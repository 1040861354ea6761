//! Maps port bits to signals. A button pulls its pin low. Emergency stop and limits are contacts that open, so that a
//! broken wire stops the machine; so does the supply monitor, which pulls its pin low on undervoltage.
//!
//! ```
//! use stepscope_controller::input::Signal;
//! use stepscope_controller_firmware::wiring::{Contact, levels};
//!
//! const PANEL: &[Contact] = &[Contact::closes(Signal::Start, 0), Contact::opens(Signal::Estop, 1)];
//! // Pull-ups hold the pins high: start is released, and the wire of the emergency stop is broken.
//! let levels = levels(PANEL, 0b11);
//! assert!(!levels.level(Signal::Start) && levels.level(Signal::Estop));
//! ```

use stepscope_controller::{chip::RawLevels, input::Signal};
use stepscope_peripheral::signal::Levels;

/// A contact between ground and a pin with a pull-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    signal: Signal,
    /// 0 to 31.
    bit: u8,
    /// Level of the pin for signal 1.
    active: bool,
}

impl Contact {
    /// Closed (pin low) while the signal is 1.
    pub const fn closes(signal: Signal, bit: u8) -> Self {
        Self { signal, bit, active: false }
    }

    /// Open (pin high) while the signal is 1.
    pub const fn opens(signal: Signal, bit: u8) -> Self {
        Self { signal, bit, active: true }
    }
}

/// Levels of the signals with a contact.
pub fn levels(contacts: &[Contact], port: u32) -> RawLevels {
    contacts.iter().fold(RawLevels::default(), |levels, contact| {
        let pin = port.checked_shr(contact.bit.into()).unwrap_or(0) & 1 != 0;
        levels.with(contact.signal, pin == contact.active)
    })
}

/// STEP in the output port.
pub const STEP: u32 = 1 << 0;
/// DIR in the output port.
pub const DIR: u32 = 1 << 1;
/// The driver's enable input in the output port, active low.
pub const NOT_EN: u32 = 1 << 2;

/// Value of the output port.
pub const fn port(levels: Levels) -> u32 {
    let step = if levels.step() & 1 != 0 { STEP } else { 0 };
    let dir = if levels.dir() & 1 != 0 { DIR } else { 0 };
    step | dir | if levels.has(Levels::EN) { 0 } else { NOT_EN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_output_has_its_bit() {
        let rows = [(Levels::EN, 0), (0, NOT_EN), (Levels::EN | 1, STEP), (Levels::EN | 1 << 16, DIR)];
        for (levels, expected) in rows {
            // Unused channels have no pin.
            assert_eq!(port(Levels(levels | 1 << 5 | 1 << 20 | Levels::RX)), expected);
        }
    }

    #[test]
    fn signals_without_a_contact_keep_their_default_level() {
        let levels = levels(&[Contact::opens(Signal::LimitMax, 31)], 1 << 31);
        assert!(levels.level(Signal::Power) && levels.level(Signal::LimitMax));
        assert!(!levels.level(Signal::Start));
    }
}
