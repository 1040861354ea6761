//! An exact tolerance, so that a step off by exactly that time is accepted.
//!
//! ```
//! use stepscope_inspect::recording::tolerance::Tolerance;
//!
//! let tolerance = Tolerance::from_micros(25, 1).expect("2.5 us");
//! assert_eq!(tolerance.seconds(), 2.5e-6);
//! ```

use serde::{Serialize, Serializer};

/// A time as a fraction of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance {
    numerator: u64,
    denominator: u64,
}

impl Tolerance {
    pub const ZERO: Self = Self { numerator: 0, denominator: 1 };

    /// `mantissa / 10^places` us; `None` with more than 13 decimal places.
    pub const fn from_micros(mantissa: u64, places: u32) -> Option<Self> {
        match 10_u64.checked_pow(places.saturating_add(6)) {
            Some(denominator) => Some(Self { numerator: mantissa, denominator }),
            None => None,
        }
    }

    /// One cycle of the slower of two clocks.
    pub fn cycle(one_hz: u32, other_hz: u32) -> Self {
        Self { numerator: 1, denominator: one_hz.min(other_hz).max(1).into() }
    }

    /// In units of 1/(`one_hz` * `other_hz`) s, in which time differences of both clocks are whole; rounded down.
    pub const fn units(self, one_hz: u64, other_hz: u64) -> u128 {
        let (numerator, denominator) = (self.numerator as u128, self.denominator as u128);
        let per_s = one_hz as u128 * other_hz as u128;
        // In two parts, because the whole product may not fit. Larger values exceed every difference.
        (per_s / denominator)
            .saturating_mul(numerator)
            .saturating_add(per_s % denominator * numerator / denominator)
    }

    /// The tolerance in s, rounded.
    pub const fn seconds(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

impl Serialize for Tolerance {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.seconds())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact_decimals() {
        for (mantissa, places, expected) in [
            (20, 0, Some(20_000)),
            (2000, 2, Some(20_000)),
            (625, 4, Some(62)),
            (0, 13, Some(0)),
            (1_000_000_000, 0, Some(1_000_000_000_000)),
            (u64::MAX, 13, Some(1_844_674_407)),
            (1, 14, None),
            (1, u32::MAX, None),
        ] {
            let units = Tolerance::from_micros(mantissa, places).map(|within| within.units(1_000_000_000, 1));
            assert_eq!(units, expected, "{mantissa} {places}");
        }
        assert_eq!(
            Tolerance::cycle(u32::MAX, 16_000_000).units(u32::MAX.into(), 16_000_000),
            u128::from(u32::MAX)
        );
        assert_eq!(Tolerance::ZERO.units(u64::MAX, u64::MAX), 0);
        let ps = Tolerance::from_micros(1, 6).expect("a time");
        assert_eq!(ps.units(1_000_000_000_000_000, 1_000_000_000), 1_000_000_000_000);
        let hour = Tolerance::from_micros(3_600_000_000, 0).expect("a time");
        assert_eq!(hour.units(1_000_000_000_000_000, 1_000_000_000), 3600 * 10_u128.pow(24));
        let long = Tolerance::from_micros(u64::MAX, 0).expect("a time");
        assert_eq!(long.units(u64::MAX, u64::MAX), u128::MAX);
        assert!((Tolerance::cycle(16_000_000, 2_000_000).seconds() - 5e-7).abs() < 1e-20);
    }
}
