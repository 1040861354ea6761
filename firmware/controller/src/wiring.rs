//! Which bit of a port is which signal, and at which level.
//!
//! A button pulls its pin low; the emergency stop and the limits are contacts that open, so that a wire that breaks stops
//! the machine; so does what watches the supply: it pulls its pin low when the power falls. EN of most drivers is low
//! while they are on.
//!
//! ```
//! use stepscope_controller::input::Signal;
//! use stepscope_controller_firmware::wiring::{Contact, levels};
//!
//! const PANEL: &[Contact] = &[Contact::closes(Signal::Start, 0), Contact::opens(Signal::Estop, 1)];
//! // Pull-ups hold the pins high: start is not pressed, and the wire of the emergency stop is broken.
//! let levels = levels(PANEL, 0b11);
//! assert!(!levels.level(Signal::Start) && levels.level(Signal::Estop));
//! ```

use stepscope_controller::{chip::RawLevels, input::Signal};
use stepscope_peripheral::signal::Levels;

/// A contact between a pin with a pull-up and ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    signal: Signal,
    /// Of the input port, 0 to 31.
    bit: u8,
    /// Level of the pin at which the signal is 1.
    active: bool,
}

impl Contact {
    /// Closed, the pin low, while the signal is 1.
    #[must_use]
    pub const fn closes(signal: Signal, bit: u8) -> Self {
        Self { signal, bit, active: false }
    }

    /// Open, the pin high, while the signal is 1.
    #[must_use]
    pub const fn opens(signal: Signal, bit: u8) -> Self {
        Self { signal, bit, active: true }
    }
}

/// Levels of the signals that have a contact; the others have none.
#[must_use]
pub fn levels(contacts: &[Contact], port: u32) -> RawLevels {
    contacts.iter().fold(RawLevels::default(), |levels, contact| {
        let pin = port.checked_shr(contact.bit.into()).unwrap_or(0) & 1 != 0;
        levels.with(contact.signal, pin == contact.active)
    })
}

/// Bit of the output port that is STEP.
pub const STEP: u32 = 1 << 0;
/// Bit of the output port that is DIR.
pub const DIR: u32 = 1 << 1;
/// Bit of the output port that is the driver's enable input, low while it is on.
pub const NOT_EN: u32 = 1 << 2;

/// What the output port has to be.
#[must_use]
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
            // Channels that are not there have no pin.
            assert_eq!(port(Levels(levels | 1 << 5 | 1 << 20 | Levels::RX)), expected);
        }
    }

    #[test]
    fn what_has_no_contact_keeps_its_level() {
        let levels = levels(&[Contact::opens(Signal::LimitMax, 31)], 1 << 31);
        assert!(levels.level(Signal::Power) && levels.level(Signal::LimitMax));
        assert!(!levels.level(Signal::Start));
    }
}
