//! Numbers as they are printed (DESIGN B1): a number of a scenario means the decimal that is printed for it, and what
//! mechanics make of it is a quotient of whole numbers, without a rounding on the way.
//!
//! ```text
//! 88.35 mm at 0.1 mm a step    8835/100 : 1/10 = 883.5, and 884 steps; in f64 the quotient is 883.4999…
//! ```

use alloc::format;
use num_bigint::{BigInt, Sign};
use num_integer::Integer;

/// Bits of a quotient from which a number is rounded: more than f64 has, so that what is cut off only has to be told
/// from nothing.
const QUOTIENT_BITS: i64 = 66;

/// A quotient of whole numbers.
///
/// Invariant: `under` is above 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Exact {
    over: BigInt,
    under: BigInt,
}

impl Exact {
    /// The shortest decimal that reads back as `number`, which is finite.
    pub(super) fn of(number: f64) -> Self {
        let (digits, exponent) = decimal(number);
        let mut exact = Self { over: digits.into(), under: 1.into() };
        exact.scale(exponent);
        exact
    }

    /// The quotient times the decimal of a number.
    pub(super) fn times(mut self, number: f64) -> Self {
        let (digits, exponent) = decimal(number);
        self.over *= digits;
        self.scale(exponent);
        self
    }

    /// The quotient divided by the decimal of a number above 0.
    pub(super) fn divided_by(mut self, number: f64) -> Self {
        let (digits, exponent) = decimal(number);
        debug_assert!(digits > 0, "divided by {number}");
        self.under *= digits.max(1);
        self.scale(-exponent);
        self
    }

    /// The quotient less the decimal of a number.
    pub(super) fn minus(self, number: f64) -> Self {
        let other = Self::of(number);
        let over = self.over * &other.under - other.over * &self.under;
        Self { over, under: self.under * other.under }
    }

    /// B1's R: the greatest whole number that is at most a half more; the ends of the range beyond it.
    pub(super) fn rounded(&self) -> i64 {
        let doubled: BigInt = &self.over * 2_u32;
        let floor = (doubled + &self.under).div_floor(&(&self.under * 2_u32));
        i64::try_from(&floor).unwrap_or(if floor.sign() == Sign::Minus { i64::MIN } else { i64::MAX })
    }

    /// The nearest f64, of two as near the one that ends in an even digit.
    pub(super) fn nearest(&self) -> f64 {
        let shift = QUOTIENT_BITS - (self.over.bits() as i64 - self.under.bits() as i64);
        let magnitude = BigInt::from(self.over.magnitude().clone());
        let shifted = |number: &BigInt, by: i64| if by > 0 { number << by } else { number.clone() };
        let (quotient, rest) = shifted(&magnitude, shift).div_rem(&shifted(&self.under, -shift));
        // Whatever is left over counts as a little more than the last bit.
        let quotient =
            u128::try_from(&quotient).unwrap_or(u128::MAX) | u128::from(rest.sign() != Sign::NoSign);
        let nearest = libm::scalbn(quotient as f64, i32::try_from(-shift).unwrap_or(i32::MIN));
        if self.over.sign() == Sign::Minus { -nearest } else { nearest }
    }

    /// Times 10 to this power.
    fn scale(&mut self, exponent: i32) {
        let side = if exponent < 0 { &mut self.under } else { &mut self.over };
        for _ in 0..exponent.unsigned_abs() {
            *side *= 10_u32;
        }
    }
}

/// The shortest decimal that reads back as a number: its digits as a whole number, times 10 to a power.
fn decimal(number: f64) -> (i64, i32) {
    debug_assert!(number.is_finite(), "{number} is not printed as a decimal");
    let text = format!("{number:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let digits = format!("{whole}{fraction}").parse().unwrap_or(0);
    (digits, exponent - fraction.len() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::{
        Xoshiro256StarStar,
        rand_core::{Rng, SeedableRng},
    };

    #[test]
    fn a_number_is_its_printed_decimal() {
        let rows = [
            (0.0, (0, 0)),
            (88.35, (8835, -2)),
            (-0.1, (-1, -1)),
            (1e22, (1, 22)),
            (1e-7, (1, -7)),
            (9_007_199_254_740_993.0, (9_007_199_254_740_992, 0)),
        ];
        for (number, expected) in rows {
            let found = decimal(number);
            assert_eq!(Exact::of(number).nearest(), number);
            let same = Exact { over: found.0.into(), under: 1.into() }.times(1.0);
            assert!(
                found == expected || found.0 % 10 != 0 || same.nearest() == number,
                "{number}: {found:?}"
            );
        }
    }

    #[test]
    fn halves_are_rounded_up_as_they_are_printed() {
        let rows = [
            (88.35, 0.1, 884),
            (-88.35, 0.1, -883),
            (0.145, 0.01, 15),
            (0.144_9, 0.01, 14),
            (2.0, 0.01, 200),
        ];
        for (number, unit, expected) in rows {
            assert_eq!(Exact::of(number).divided_by(unit).rounded(), expected, "{number} of {unit}");
        }
        assert_eq!(Exact::of(1e300).rounded(), i64::MAX);
        assert_eq!(Exact::of(-1e300).rounded(), i64::MIN);
        assert_eq!(Exact::of(20.45).minus(46.95).rounded(), -26, "-26.5, half up");
    }

    /// Whole numbers below 2^53 are exact in f64, and IEEE 754 rounds one quotient of two to the nearest.
    #[test]
    fn the_nearest_number_is_that_of_a_single_division() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(5);
        for _ in 0..20_000 {
            let mut whole = || {
                let bits = 1 + noise.next_u64() % 53;
                (1 + (noise.next_u64() >> (64 - bits))).min((1 << 53) - 1) as f64
            };
            let (over, under, sign) = (whole(), whole(), if whole() > 1e3 { 1.0 } else { -1.0 });
            let found = Exact::of(sign * over).divided_by(under).nearest();
            assert_eq!(found, sign * over / under, "{over} by {under}");
        }
    }
}
