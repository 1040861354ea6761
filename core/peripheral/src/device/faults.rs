//! Fault flags (DESIGN A6).

/// Faults that a peripheral has seen; they stay until RESYNC or firmware clears them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(u16);

impl Faults {
    /// A stop bit was low.
    pub const FRAMING: Self = Self(1 << 0);
    /// A gap cut a packet short.
    pub const SHORT_PACKET: Self = Self(1 << 1);
    /// A frame's check failed.
    pub const CRC: Self = Self(1 << 2);
    /// A frame had more than 600 decoded bytes.
    pub const OVERLONG: Self = Self(1 << 3);
    /// A packet found the queue full.
    pub const QUEUE_OVERFLOW: Self = Self(1 << 4);
    /// A packet ordered more steps than a tick has slots.
    pub const TOO_MANY_STEPS: Self = Self(1 << 5);
    /// TICKS had neither the expected sequence number nor the one before it.
    pub const BAD_SEQ: Self = Self(1 << 6);
    /// A tick with steps ended and none was there to follow (framed protocol).
    pub const UNDERRUN: Self = Self(1 << 7);

    const NAMES: [&'static str; 8] = [
        "FRAMING",
        "SHORT_PACKET",
        "CRC",
        "OVERLONG",
        "QUEUE_OVERFLOW",
        "TOO_MANY_STEPS",
        "BAD_SEQ",
        "UNDERRUN",
    ];

    /// All of them.
    pub const ALL: Self = Self::from_bits(u16::MAX);

    pub(super) const fn set(&mut self, fault: Self) {
        self.0 |= fault.0;
    }

    pub(super) const fn clear(&mut self, which: Self) {
        self.0 &= !which.0;
    }

    /// The faults whose bits, as A6 numbers them, are set; bits of no fault are left out.
    #[must_use]
    pub const fn from_bits(bits: u16) -> Self {
        Self(bits & ((1 << Self::NAMES.len()) - 1))
    }

    /// The faults of both.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The flags as A6 numbers their bits.
    #[must_use]
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// Whether all faults of `other` have been seen.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Names of the faults, in the order of their bits.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        Self::NAMES.into_iter().enumerate().filter(move |(bit, _)| self.0 >> bit & 1 != 0).map(|(_, n)| n)
    }
}
