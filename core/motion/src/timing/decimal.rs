//! Decimal numbers (DESIGN B1): a number of a scenario means its shortest decimal. Conversions by mechanics are fractions of
//! integers, without intermediate rounding.
//!
//! ```text
//! 88.35 mm at 0.1 mm per step    8835/100 : 1/10 = 883.5, and 884 steps; in f64 the quotient is 883.4999…
//! ```

use crate::timing::double::F106;
use alloc::format;
use num_bigint::{BigInt, BigUint};
use num_integer::Integer;

/// Bits of a quotient that is rounded to an f64. They are more than an f64 has, so it only matters whether the remainder is
/// 0.
const QUOTIENT_BITS: u32 = 64;
const DOUBLE_BITS: u32 = 2 * HALF_BITS as u32;
const HALF_BITS: i32 = 53;

#[derive(Clone, Debug)]
pub(crate) struct Exact {
    numerator: BigInt,
    /// Invariant: above 0.
    denominator: BigUint,
}

impl Exact {
    /// The shortest decimal of a finite number.
    pub(crate) fn of(number: f64) -> Self {
        Self::difference(number, 0.0)
    }

    /// The difference of the shortest decimals of two finite numbers.
    pub(crate) fn difference(number: f64, subtrahend: f64) -> Self {
        let decimals = [decimal(number), decimal(subtrahend)];
        let exponent = decimals[0].1.min(decimals[1].1);
        let [first, second] = decimals.map(|(digits, own)| digits * power_of_ten(own.abs_diff(exponent)));
        Self { numerator: first - second, denominator: 1_u8.into() }.scaled(exponent)
    }

    pub(crate) fn times(mut self, number: f64) -> Self {
        let (digits, exponent) = decimal(number);
        self.numerator *= digits;
        self.scaled(exponent)
    }

    pub(crate) fn divided_by(mut self, number: f64) -> Self {
        let (digits, exponent) = decimal(number);
        debug_assert!(digits > 0, "divided by {number}");
        self.denominator *= digits.unsigned_abs().max(1);
        self.scaled(-exponent)
    }

    fn scaled(mut self, exponent: i32) -> Self {
        let power = power_of_ten(exponent.unsigned_abs());
        if exponent < 0 {
            self.denominator *= power.magnitude();
        } else {
            self.numerator *= power;
        }
        self
    }

    /// floor(x + 1/2), saturating.
    pub(crate) fn rounded(&self) -> i64 {
        let (two, denominator) = (BigInt::from(2), BigInt::from(self.denominator.clone()));
        let floor = (&self.numerator * &two + &denominator).div_floor(&(denominator * &two));
        i64::try_from(&floor).unwrap_or(if floor < BigInt::ZERO { i64::MIN } else { i64::MAX })
    }

    pub(crate) fn nearest(&self) -> f64 {
        let (quotient, scale, has_remainder) = self.digits(QUOTIENT_BITS);
        // A remainder sets the last bit, so that a quotient above a tie is rounded up.
        self.signed(libm::scalbn((quotient as u64 | u64::from(has_remainder)) as f64, scale))
    }

    /// The fraction in 106 bits.
    pub(crate) fn double(&self) -> F106 {
        let (quotient, scale, _) = self.digits(DOUBLE_BITS);
        let half = |digits: u128, scale: i32| self.signed(libm::scalbn(digits as u64 as f64, scale));
        F106::sum(
            half(quotient >> HALF_BITS, scale + HALF_BITS),
            half(quotient & ((1 << HALF_BITS) - 1), scale),
        )
    }

    fn signed(&self, magnitude: f64) -> f64 {
        if self.numerator < BigInt::ZERO { -magnitude } else { magnitude }
    }

    /// The first `bits` bits of the magnitude, or one fewer, as an integer; its power of two; and whether there is a
    /// remainder.
    fn digits(&self, bits: u32) -> (u128, i32, bool) {
        let numerator = self.numerator.magnitude();
        let scale = numerator.bits() as i32 - self.denominator.bits() as i32 - (bits as i32 - 1);
        let shift = scale.unsigned_abs();
        let (quotient, remainder) = if scale < 0 {
            (numerator << shift).div_rem(&self.denominator)
        } else {
            numerator.div_rem(&(&self.denominator << shift))
        };
        (u128::try_from(quotient).unwrap_or(u128::MAX), scale, remainder != BigUint::ZERO)
    }

    /// The integer part and the fraction in 106 bits, from 0 to below 2^64.
    pub(crate) fn whole_and_part(&self) -> (u64, F106) {
        let (whole, remainder) = self.numerator.magnitude().div_rem(&self.denominator);
        let part = Self { numerator: remainder.into(), denominator: self.denominator.clone() };
        (u64::try_from(whole).unwrap_or(u64::MAX), part.double())
    }

    pub(crate) fn magnitude(&self) -> (&BigUint, &BigUint) {
        (self.numerator.magnitude(), &self.denominator)
    }
}

impl F106 {
    pub(crate) fn decimal(number: f64) -> Self {
        Exact::of(number).double()
    }
}

fn power_of_ten(exponent: u32) -> BigInt {
    BigInt::from(10).pow(exponent)
}

/// The shortest decimal of a number: its digits as an integer, and the power of 10.
fn decimal(number: f64) -> (i64, i32) {
    debug_assert!(number.is_finite(), "{number} has no decimal");
    let text = format!("{number:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let parsed = (format!("{whole}{fraction}").parse(), exponent.parse::<i32>());
    let (Ok(digits), Ok(exponent)) = parsed else { return (0, 0) };
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
    fn reads_the_shortest_decimal_of_a_number() {
        let rows = [
            (0.0, (0, 0)),
            (88.35, (8835, -2)),
            (-0.1, (-1, -1)),
            (1e22, (1, 22)),
            (1e-7, (1, -7)),
            (9_007_199_254_740_992.0, (9_007_199_254_740_992, 0)),
        ];
        for (number, expected) in rows {
            assert_eq!(decimal(number), expected);
        }
        for number in [1.0, -0.1, 5e-324, 1e-310, f64::MAX, f64::MIN_POSITIVE, 0.3, 123_456.789] {
            assert_eq!(Exact::of(number).nearest(), number);
        }
    }

    #[test]
    fn rounds_decimal_halves_up() {
        let rows =
            [(88.35, 0.1, 884), (-88.35, 0.1, -883), (0.145, 0.01, 15), (0.1449, 0.01, 14), (2.0, 0.01, 200)];
        for (number, unit, expected) in rows {
            assert_eq!(Exact::of(number).divided_by(unit).rounded(), expected, "{number} of {unit}");
        }
        assert_eq!([0.5, -0.5, 0.49, -0.51].map(|number| Exact::of(number).rounded()), [1, 0, 0, -1]);
        assert_eq!(Exact::of(1e300).rounded(), i64::MAX);
        assert_eq!(Exact::of(-1e300).rounded(), i64::MIN);
        assert_eq!(Exact::difference(20.45, 46.95).rounded(), -26, "-26.5, half up");
    }

    fn random_decimal(noise: &mut Xoshiro256StarStar, signed: bool) -> (BigInt, i32, f64) {
        let bits = 1 + noise.next_u64() % 50;
        let digits = 1 + (noise.next_u64() >> (64 - bits)) as i64;
        let digits = if signed && noise.next_u64().is_multiple_of(2) { -digits } else { digits };
        let exponent = (noise.next_u64() % 24) as i32 - 16;
        let number: f64 = format!("{digits}e{exponent}").parse().expect("a number");
        (digits.into(), exponent, number)
    }

    /// Compares (a - b)*c/d with the arithmetic of a library.
    #[test]
    fn quotients_agree_with_big_integers() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(5);
        let ten = |exponent: i32| BigInt::from(10).pow(exponent.unsigned_abs());
        for round in 0..20_000 {
            let (a, b) = (random_decimal(&mut noise, true), random_decimal(&mut noise, true));
            let (c, d) = (random_decimal(&mut noise, false), random_decimal(&mut noise, false));
            // In parts of 10^-40.
            let parts = |(digits, exponent, _): &(BigInt, i32, f64)| digits * ten(exponent + 40);
            let other = if round % 3 == 0 { (BigInt::from(0), 0, 0.0) } else { b };
            let over = (parts(&a) - parts(&other)) * parts(&c);
            let under = parts(&d) * ten(40);
            let exact = Exact::difference(a.2, other.2).times(c.2).divided_by(d.2);
            let doubled: BigInt = &over * 2 + &under;
            let floor = doubled.div_floor(&(&under * 2));
            let expected =
                i64::try_from(&floor).unwrap_or(if floor < BigInt::from(0) { i64::MIN } else { i64::MAX });
            if expected.unsigned_abs() < 1 << 52 {
                assert_eq!(exact.rounded(), expected, "({} - {})*{}/{}", a.2, other.2, c.2, d.2);
            }
            // No other f64 is closer.
            let found = exact.nearest();
            let distance = |number: f64| {
                let (digits, exponent) = decimal_of_bits(number);
                // |number - over/under| in parts of under*10^-1100.
                let own = BigInt::from(digits) * (BigInt::from(1) << (exponent + 1100)) * &under;
                let other: BigInt = &over << 1100;
                BigInt::from((own - other).magnitude().clone())
            };
            assert!(distance(found) <= distance(found.next_up()), "{found}");
            assert!(distance(found) <= distance(found.next_down()), "{found}");
        }
    }

    /// A number as an integer times a power of 2.
    fn decimal_of_bits(number: f64) -> (i64, i32) {
        let bits = number.to_bits();
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
        let (digits, exponent) =
            if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
        (if number < 0.0 { -digits } else { digits }, exponent)
    }

    /// Integers below 2^53 are exact in f64, and IEEE 754 rounds their quotient to the nearest f64.
    #[test]
    fn nearest_agrees_with_a_single_division() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(6);
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
