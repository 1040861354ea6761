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

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn each_fault_has_the_contracts_bit_and_name() {
        let rows = [
            (Faults::FRAMING, "FRAMING"),
            (Faults::SHORT_PACKET, "SHORT_PACKET"),
            (Faults::CRC, "CRC"),
            (Faults::OVERLONG, "OVERLONG"),
            (Faults::QUEUE_OVERFLOW, "QUEUE_OVERFLOW"),
            (Faults::TOO_MANY_STEPS, "TOO_MANY_STEPS"),
            (Faults::BAD_SEQ, "BAD_SEQ"),
            (Faults::UNDERRUN, "UNDERRUN"),
        ];
        for (bit, (fault, name)) in rows.into_iter().enumerate() {
            assert_eq!((fault.bits(), fault.names().collect::<Vec<_>>()), (1 << bit, vec![name]));
        }
        assert_eq!(Faults::ALL.names().count(), rows.len());
        assert_eq!(
            Faults::from_bits(0xff00 | Faults::CRC.bits()),
            Faults::CRC,
            "bits of no fault are left out"
        );
    }

    #[test]
    fn faults_are_set_united_and_cleared_one_by_one() {
        let mut faults = Faults::default();
        faults.set(Faults::CRC);
        faults.set(Faults::BAD_SEQ);
        let both = Faults::CRC.union(Faults::BAD_SEQ);
        assert_eq!(faults, both);
        assert!(both.contains(Faults::CRC) && both.contains(both) && both.contains(Faults::default()));
        assert!(!Faults::CRC.contains(both) && !both.contains(Faults::UNDERRUN));
        faults.clear(Faults::CRC.union(Faults::FRAMING));
        assert_eq!(faults, Faults::BAD_SEQ);
    }
}
