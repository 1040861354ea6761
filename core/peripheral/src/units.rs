//! Points and spans of device time in clock cycles since reset (DESIGN A1). They have different types, so adding two
//! points does not compile.
//!
//! ```
//! use stepscope_peripheral::units::{Cycles, Instant};
//!
//! let (rise, width) = (Instant(4000), Cycles(40));
//! assert_eq!(rise + width, Instant(4040));
//! assert_eq!(Instant(4040) - rise, width);
//! assert_eq!(rise.seconds(16_000_000), 0.000_25);
//! ```

use core::ops::{Add, AddAssign, Sub};

/// A span of device time in clock cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cycles(pub u64);

/// A point of device time in clock cycles since reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct Instant(pub u64);

impl Instant {
    /// Cycle 0. Nothing starts before cycle 1.
    pub const RESET: Self = Self(0);
    /// Deadline of an event that never happens.
    pub const NEVER: Self = Self(u64::MAX);

    /// The following cycle.
    pub const fn next(self) -> Self {
        Self(self.0 + 1)
    }

    /// Time since reset in s, for display only.
    pub fn seconds(self, clock_hz: u32) -> f64 {
        self.0 as f64 / f64::from(clock_hz)
    }
}

impl Add<Cycles> for Instant {
    type Output = Self;
    fn add(self, span: Cycles) -> Self {
        Self(self.0 + span.0)
    }
}

impl AddAssign<Cycles> for Instant {
    fn add_assign(&mut self, span: Cycles) {
        self.0 += span.0;
    }
}

impl Sub for Instant {
    type Output = Cycles;
    /// The span from `earlier` to `self`; the caller knows their order.
    fn sub(self, earlier: Self) -> Cycles {
        Cycles(self.0 - earlier.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_spans_add_and_subtract() {
        let mut at = Instant(7);
        assert_eq!((at + Cycles(5), Instant(12) - at, at.next()), (Instant(12), Cycles(5), Instant(8)));
        at += Cycles(3);
        assert_eq!((at, Instant::RESET, Instant::NEVER), (Instant(10), Instant(0), Instant(u64::MAX)));
        assert_eq!(Instant(40_000_000).seconds(16_000_000), 2.5);
    }
}
