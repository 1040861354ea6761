//! The 36 signals of the peripheral and their place in a trace's levels (DESIGN A3).

/// Most channels that one controller drives.
pub const MAX_CHANNELS: usize = 16;

/// Levels of all signals in one cycle, as the bits of DESIGN A3.
///
/// | bits | signal |
/// | --- | --- |
/// | 0..=15 | STEP of channel 0..=15 |
/// | 16..=31 | DIR of channel 0..=15 |
/// | 32 | EN, high = windings powered |
/// | 33 | RX, the line as the controller hears it |
/// | 34 | TX, the controller's reply |
/// | 35 | DE, the transceiver's transmit enable |
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Levels(pub u64);

impl Levels {
    /// Bit of channel 0's DIR.
    pub const DIR_SHIFT: u32 = 16;
    /// EN, common to all drivers.
    pub const EN: u64 = 1 << 32;
    /// RX, idle high.
    pub const RX: u64 = 1 << 33;
    /// TX, idle high.
    pub const TX: u64 = 1 << 34;
    /// DE, high while the controller drives the line.
    pub const DE: u64 = 1 << 35;
    /// At reset the drivers are powered and the line is idle.
    pub const RESET: Self = Self(Self::EN | Self::RX | Self::TX);

    /// STEP levels, channel 0 in bit 0.
    #[must_use]
    pub const fn step(self) -> u16 {
        self.0 as u16
    }

    /// DIR levels, channel 0 in bit 0.
    #[must_use]
    pub const fn dir(self) -> u16 {
        (self.0 >> Self::DIR_SHIFT) as u16
    }

    /// Whether every signal of `mask` is high.
    #[must_use]
    pub const fn has(self, mask: u64) -> bool {
        self.0 & mask == mask
    }
}

/// Name of the signal that stands at `bit` of the levels, as the page, VCD and CSV print it.
#[must_use]
pub fn name(bit: u32) -> Option<alloc::string::String> {
    match bit {
        0..=15 => Some(alloc::format!("STEP{bit}")),
        16..=31 => Some(alloc::format!("DIR{}", bit - 16)),
        32 => Some("EN".into()),
        33 => Some("RX".into()),
        34 => Some("TX".into()),
        35 => Some("DE".into()),
        _ => None,
    }
}
