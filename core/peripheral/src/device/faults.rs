//! Fault flags (DESIGN A6) with the bits and names of the register FAULTS.

use stepscope_registers::faults;

const KNOWN: u16 = {
    let (mut bits, mut flags) = (0, faults::REGISTER.fields);
    while let [flag, rest @ ..] = flags {
        bits |= flag.mask() as u16;
        flags = rest;
    }
    bits
};

/// Faults so far; RESYNC or firmware clears them. The map of [`faults`] describes each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faults(u16);

impl Faults {
    pub const FRAMING: Self = Self(faults::FRAMING.mask() as u16);
    /// A gap cut a packet short, or a frame was invalid COBS or decoded to fewer than 6 bytes.
    pub const SHORT_PACKET: Self = Self(faults::SHORT_PACKET.mask() as u16);
    pub const CRC: Self = Self(faults::CRC.mask() as u16);
    /// A frame had more than 600 decoded bytes.
    pub const OVERLONG: Self = Self(faults::OVERLONG.mask() as u16);
    pub const QUEUE_OVERFLOW: Self = Self(faults::QUEUE_OVERFLOW.mask() as u16);
    pub const TOO_MANY_STEPS: Self = Self(faults::TOO_MANY_STEPS.mask() as u16);
    /// TICKS had neither the expected sequence number nor, as a repeat, the one before it.
    pub const BAD_SEQ: Self = Self(faults::BAD_SEQ.mask() as u16);
    pub const UNDERRUN: Self = Self(faults::UNDERRUN.mask() as u16);
    pub const OVERLOAD: Self = Self(faults::OVERLOAD.mask() as u16);
    pub const SELF_TEST: Self = Self(faults::SELF_TEST.mask() as u16);

    pub const ALL: Self = Self::from_bits(u16::MAX);

    pub(super) const fn set(&mut self, fault: Self) {
        self.0 |= fault.0;
    }

    pub(super) const fn clear(&mut self, which: Self) {
        self.0 &= !which.0;
    }

    /// The faults of these bits; unknown bits are ignored.
    pub const fn from_bits(bits: u16) -> Self {
        Self(bits & KNOWN)
    }

    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Bits as in the register FAULTS.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// Whether all faults of `other` are set.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Names of the faults that are set, lowest bit first.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let flags = faults::REGISTER.fields.iter();
        flags.filter(move |flag| u32::from(self.0) & flag.mask() != 0).map(|flag| flag.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn each_fault_has_the_bit_and_name_of_its_register() {
        let rows = [
            (Faults::FRAMING, "FRAMING"),
            (Faults::SHORT_PACKET, "SHORT_PACKET"),
            (Faults::CRC, "CRC"),
            (Faults::OVERLONG, "OVERLONG"),
            (Faults::QUEUE_OVERFLOW, "QUEUE_OVERFLOW"),
            (Faults::TOO_MANY_STEPS, "TOO_MANY_STEPS"),
            (Faults::BAD_SEQ, "BAD_SEQ"),
            (Faults::UNDERRUN, "UNDERRUN"),
            (Faults::OVERLOAD, "OVERLOAD"),
            (Faults::SELF_TEST, "SELF_TEST"),
        ];
        for (bit, (fault, name)) in rows.into_iter().enumerate() {
            assert_eq!((fault.bits(), fault.names().collect::<Vec<_>>()), (1 << bit, vec![name]));
        }
        assert_eq!(Faults::ALL.names().count(), rows.len());
        assert_eq!(Faults::from_bits(0xfc00 | Faults::CRC.bits()), Faults::CRC, "unknown bits are ignored");
    }

    #[test]
    fn faults_are_set_merged_and_cleared_independently() {
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
