//! When the bits and bytes of a sender begin (DESIGN A4).
//!
//! ```text
//! bit k of a byte      t0 + floor(k * clock_hz / baud)
//! byte j back to back  t0 + floor(10 * j * clock_hz / baud)
//! ```

use crate::units::Cycles;

/// Bits of a byte on the line: start, eight data bits, stop.
pub const BYTE_BITS: u64 = 10;

/// Bit and byte times at one bit rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitTimes {
    clock_hz: u64,
    baud: u64,
}

impl BitTimes {
    /// At `baud` bits per second; 0 counts as 1.
    pub const fn new(clock_hz: u32, baud: u32) -> Self {
        Self { clock_hz: clock_hz as u64, baud: if baud == 0 { 1 } else { baud as u64 } }
    }

    /// From the start of a byte to its bit `index`: 0 the start bit, 10 the end of the stop bit. Saturates.
    pub const fn bit(self, index: u64) -> Cycles {
        // At 1 GHz the product exceeds 64 bits after 1.8e9 bytes in a row.
        let Some(product) = index.checked_mul(self.clock_hz) else {
            let cycles = index as u128 * self.clock_hz as u128 / self.baud as u128;
            return Cycles(if cycles > u64::MAX as u128 { u64::MAX } else { cycles as u64 });
        };
        Cycles(product / self.baud)
    }

    /// From the start of the first byte to the start of byte `index` of bytes in a row. Saturates.
    pub const fn byte(self, index: u64) -> Cycles {
        self.bit(BYTE_BITS.saturating_mul(index))
    }

    /// Time that `count` bytes in a row take, to the end of the last stop bit. Saturates.
    pub const fn bytes(self, count: u64) -> Cycles {
        match count {
            0 => Cycles(0),
            _ => Cycles(self.byte(count - 1).0.saturating_add(self.bit(BYTE_BITS).0)),
        }
    }

    /// Of bytes in a row, the one whose start is nearest to `after` the start of the first.
    pub const fn nearest_byte(self, after: Cycles) -> u64 {
        let clock_hz = if self.clock_hz == 0 { 1 } else { self.clock_hz as u128 };
        let bits = self.baud as u128 * after.0 as u128 / clock_hz;
        ((bits + BYTE_BITS as u128 / 2) / BYTE_BITS as u128) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bit_and_byte_time_is_rounded_down_by_itself() {
        // 11.1 cycles per bit, 111.1 per byte.
        let times = BitTimes::new(1000, 90);
        assert_eq!([0, 1, 9, 10].map(|bit| times.bit(bit).0), [0, 11, 100, 111]);
        assert_eq!([0, 1, 9, 10].map(|byte| times.byte(byte).0), [0, 111, 1000, 1111]);
        assert_eq!([0, 1, 10].map(|count| times.bytes(count).0), [0, 111, 1111]);
        assert_eq!(
            [0, 55, 56, 111, 160, 170].map(|after| times.nearest_byte(Cycles(after))),
            [0, 0, 1, 1, 1, 2]
        );
        assert_eq!(BitTimes::new(7, 0).bit(1), Cycles(7));
    }

    #[test]
    fn late_bytes_of_a_fast_clock_do_not_overflow() {
        let times = BitTimes::new(1_000_000_000, 1_000_000);
        for byte in [1_800_000_000, 1_900_000_000, 1 << 50] {
            assert_eq!(times.byte(byte), Cycles(10_000 * byte));
            assert_eq!(times.nearest_byte(times.byte(byte)), byte);
        }
        assert_eq!((times.byte(1 << 60), times.bytes(u64::MAX)), (Cycles(u64::MAX), Cycles(u64::MAX)));
    }
}
