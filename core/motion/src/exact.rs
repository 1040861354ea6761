//! Numbers as they are printed (DESIGN B1): a number of a scenario means the decimal that is printed for it, and what
//! mechanics make of it is a quotient of whole numbers, without a rounding on the way.
//!
//! ```text
//! 88.35 mm at 0.1 mm a step    8835/100 : 1/10 = 883.5, and 884 steps; in f64 the quotient is 883.4999…
//! ```
//!
//! The whole numbers are of any length, but few operations are made of them: products, comparisons, one quotient of 64
//! bits. A library for all operations would make the page 13 kB heavier; the tests hold these against one. None
//! of them is called often, so none is copied into its callers.

use crate::{double::Double, round_half_up};
use alloc::{format, vec, vec::Vec};
use core::cmp::Ordering;

/// Bits of a limb of a [`Natural`].
const LIMB_BITS: u32 = 32;
/// Bits of a quotient from which the nearest f64 is rounded: more than it has, so that the rest only has to be told from
/// nothing.
const QUOTIENT_BITS: u32 = 64;
/// Bits of a quotient that become a [`Double`], of which the first may be 0, and of either half of it.
const DOUBLE_BITS: u32 = 2 * HALF_BITS as u32;
const HALF_BITS: i32 = 53;

/// A quotient of whole numbers.
#[derive(Clone, Debug)]
pub(super) struct Exact {
    negative: bool,
    over: Natural,
    /// Invariant: above 0.
    under: Natural,
}

impl Exact {
    /// The shortest decimal that reads back as `number`, which is finite.
    pub(super) fn of(number: f64) -> Self {
        Self::difference(number, 0.0)
    }

    /// The decimal of a number less that of another.
    #[inline(never)]
    pub(super) fn difference(number: f64, less: f64) -> Self {
        let ((own, own_exponent), (other, other_exponent)) = (decimal(number), decimal(less));
        let exponent = own_exponent.min(other_exponent);
        let whole = |digits: i64, of: i32| {
            let mut whole = Natural::of(digits.unsigned_abs());
            whole.multiply_by_power_of_ten(of.abs_diff(exponent));
            whole
        };
        let (own_whole, other_whole) = (whole(own, own_exponent), whole(other, other_exponent));
        let (negative, over) = if (own < 0) == (other < 0) {
            // The longer one has the sign of the difference, or the other's opposite.
            match own_whole.cmp(&other_whole) {
                Ordering::Less => (own >= 0, other_whole.less(&own_whole)),
                _ => (own < 0, own_whole.less(&other_whole)),
            }
        } else {
            (own < 0 || (own == 0 && other > 0), own_whole.plus(&other_whole))
        };
        let mut exact = Self { negative, over, under: Natural::of(1) };
        exact.scale(exponent);
        exact
    }

    /// The quotient times the decimal of a number from 0 on.
    #[inline(never)]
    pub(super) fn times(mut self, number: f64) -> Self {
        let (digits, exponent) = decimal(number);
        debug_assert!(digits >= 0, "times {number}");
        self.over.multiply_by(digits.unsigned_abs());
        self.scale(exponent);
        self
    }

    /// The quotient divided by the decimal of a number above 0.
    #[inline(never)]
    pub(super) fn divided_by(mut self, number: f64) -> Self {
        let (digits, exponent) = decimal(number);
        debug_assert!(digits > 0, "divided by {number}");
        self.under.multiply_by(digits.unsigned_abs().max(1));
        self.scale(-exponent);
        self
    }

    /// B1's R: the greatest whole number that is at most a half more; the ends of the range beyond it.
    #[inline(never)]
    pub(super) fn rounded(&self) -> i64 {
        let nearest = round_half_up(self.nearest());
        // The last digit of `nearest` may have been on the wrong side of a half.
        let near = nearest.unsigned_abs();
        if near > 1 << 52 {
            return nearest;
        }
        let twice = {
            let mut twice = self.over.clone();
            twice.multiply_by(2);
            twice
        };
        let half = |halves: u64| {
            let mut half = self.under.clone();
            half.multiply_by(halves);
            twice.cmp(&half)
        };
        // The magnitude rounds to `near` from a half below it to a half above it, of which one belongs to it: that which
        // is nearer to minus infinity.
        let (low, high) =
            (if near == 0 { Ordering::Greater } else { half(2 * near - 1) }, half(2 * near + 1));
        let magnitude = match (self.negative, low, high) {
            (_, Ordering::Less, _) | (true, Ordering::Equal, _) => near - 1,
            (_, _, Ordering::Greater) | (false, _, Ordering::Equal) => near + 1,
            _ => near,
        };
        if self.negative { -(magnitude as i64) } else { magnitude as i64 }
    }

    /// The nearest f64, of two as near the one that ends in an even digit.
    #[inline(never)]
    pub(super) fn nearest(&self) -> f64 {
        let (quotient, scale, is_more) = self.digits(QUOTIENT_BITS);
        // Whatever is left counts as a little more than the last bit.
        let nearest = libm::scalbn((quotient as u64 | u64::from(is_more)) as f64, scale);
        if self.negative { -nearest } else { nearest }
    }

    /// The quotient in 106 bits.
    #[inline(never)]
    pub(super) fn double(&self) -> Double {
        let (quotient, scale, _) = self.digits(DOUBLE_BITS);
        let half = |digits: u128, scale: i32| libm::scalbn(digits as u64 as f64, scale);
        let (upper, lower) = (quotient >> HALF_BITS, quotient & ((1 << HALF_BITS) - 1));
        let Double { high, low } = Double::sum(half(upper, scale + HALF_BITS), half(lower, scale));
        if self.negative { Double { high: -high, low: -low } } else { Double { high, low } }
    }

    /// The first bits of the magnitude, so many or one less, as a whole number; the power of two that it is times; and
    /// whether there is more than that.
    fn digits(&self, bits: u32) -> (u128, i32, bool) {
        let (mut over, mut under) = (self.over.clone(), self.under.clone());
        if over.is_zero() {
            return (0, 0, false);
        }
        // Both as long, so that their quotient is 1/2 to 2.
        let ahead = over.bits() as i32 - under.bits() as i32;
        over.shift_left((-ahead).max(0).unsigned_abs());
        under.shift_left(ahead.max(0).unsigned_abs());
        let mut quotient = 0;
        for _ in 0..bits {
            let fits = over.cmp(&under) != Ordering::Less;
            if fits {
                over = over.less(&under);
            }
            quotient = quotient << 1 | u128::from(fits);
            over.shift_left(1);
        }
        (quotient, ahead - (bits as i32 - 1), !over.is_zero())
    }

    /// The greatest whole number that is no more, and the rest in 106 bits; of a quotient from 0 to below 2^64.
    #[inline(never)]
    pub(super) fn whole_and_part(&self) -> (u64, Double) {
        debug_assert!(!self.negative || self.over.is_zero(), "{self:?} is negative");
        let (mut rest, mut whole) = (self.over.clone(), 0);
        for bit in (0..=self.over.bits().saturating_sub(self.under.bits()).min(u64::BITS - 1)).rev() {
            let mut part = self.under.clone();
            part.shift_left(bit);
            if rest.cmp(&part) != Ordering::Less {
                rest = rest.less(&part);
                whole |= 1 << bit;
            }
        }
        (whole, Self { negative: false, over: rest, under: self.under.clone() }.double())
    }

    /// Without its sign, a quotient of whole numbers.
    pub(super) fn magnitude(&self) -> (&Natural, &Natural) {
        (&self.over, &self.under)
    }

    /// The shortest decimal that reads back as a number: its digits as a whole number, times 10 to a power.
    pub(super) fn decimal(number: f64) -> (i64, i32) {
        decimal(number)
    }

    /// Times 10 to this power.
    fn scale(&mut self, exponent: i32) {
        let side = if exponent < 0 { &mut self.under } else { &mut self.over };
        side.multiply_by_power_of_ten(exponent.unsigned_abs());
    }
}

impl Double {
    /// The decimal that is printed for a number, which is finite (DESIGN B1).
    pub(super) fn decimal(number: f64) -> Self {
        Exact::of(number).double()
    }
}

/// A whole number from 0 on, of any length.
///
/// Invariant: the least limb first, the last one not 0; 0 has none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Natural(Vec<u32>);

impl Natural {
    pub(super) fn of(number: u64) -> Self {
        let mut natural = Self(vec![number as u32, (number >> LIMB_BITS) as u32]);
        natural.trim();
        natural
    }

    fn trim(&mut self) {
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
    }

    fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Bits up to the highest that is set.
    fn bits(&self) -> u32 {
        let full = self.0.len() as u32 * LIMB_BITS;
        self.0.last().map_or(0, |last| full - last.leading_zeros())
    }

    fn limb(&self, index: usize) -> u32 {
        self.0.get(index).copied().unwrap_or(0)
    }

    #[inline(never)]
    fn multiply_by(&mut self, factor: u64) {
        let mut carry: u128 = 0;
        for limb in &mut self.0 {
            carry += u128::from(*limb) * u128::from(factor);
            *limb = carry as u32;
            carry >>= LIMB_BITS;
        }
        while carry > 0 {
            self.0.push(carry as u32);
            carry >>= LIMB_BITS;
        }
        self.trim();
    }

    #[inline(never)]
    fn multiply_by_power_of_ten(&mut self, exponent: u32) {
        for _ in 0..exponent {
            self.multiply_by(10);
        }
    }

    #[inline(never)]
    fn shift_left(&mut self, bits: u32) {
        if !self.is_zero() {
            let limbs = (bits / LIMB_BITS) as usize;
            self.multiply_by(1 << (bits % LIMB_BITS));
            self.0.splice(0..0, core::iter::repeat_n(0, limbs));
        }
    }

    /// Their product.
    pub(super) fn times(&self, other: &Self) -> Self {
        let mut product = Self(Vec::new());
        for limb in other.0.iter().rev() {
            product.shift_left(LIMB_BITS);
            let mut part = self.clone();
            part.multiply_by(u64::from(*limb));
            product = product.plus(&part);
        }
        product
    }

    #[inline(never)]
    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut carry: u64 = 0;
        let sum = (0..self.0.len().max(other.0.len()) + 1).map(|index| {
            carry += u64::from(self.limb(index)) + u64::from(other.limb(index));
            let limb = carry as u32;
            carry >>= LIMB_BITS;
            limb
        });
        let mut sum = Self(sum.collect());
        sum.trim();
        sum
    }

    /// This less one that is no greater.
    #[inline(never)]
    fn less(&self, other: &Self) -> Self {
        debug_assert!(self.cmp(other) != Ordering::Less, "{self:?} is less than {other:?}");
        let mut borrow: i64 = 0;
        let rest = (0..self.0.len()).map(|index| {
            borrow += i64::from(self.limb(index)) - i64::from(other.limb(index));
            let limb = borrow as u32;
            borrow >>= LIMB_BITS;
            limb
        });
        let mut rest = Self(rest.collect());
        rest.trim();
        rest
    }

    #[inline(never)]
    pub(super) fn cmp(&self, other: &Self) -> Ordering {
        self.0.len().cmp(&other.0.len()).then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }
}

/// The shortest decimal that reads back as a number: its digits as a whole number, times 10 to a power.
#[inline(never)]
fn decimal(number: f64) -> (i64, i32) {
    debug_assert!(number.is_finite(), "{number} is not printed as a decimal");
    let text = format!("{number}");
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let all = format!("{whole}{fraction}");
    let digits = all.trim_end_matches('0');
    let exponent = (all.len() - digits.len()) as i32 - fraction.len() as i32;
    // None are left of a zero.
    digits.parse().map_or((0, 0), |digits| (digits, exponent))
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_bigint::BigInt;
    use num_integer::Integer;
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
    fn halves_are_rounded_up_as_they_are_printed() {
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

    /// Digits, exponent and number of a random decimal.
    fn drawn(noise: &mut Xoshiro256StarStar, signed: bool) -> (BigInt, i32, f64) {
        let bits = 1 + noise.next_u64() % 50;
        let digits = 1 + (noise.next_u64() >> (64 - bits)) as i64;
        let digits = if signed && noise.next_u64().is_multiple_of(2) { -digits } else { digits };
        let exponent = (noise.next_u64() % 24) as i32 - 16;
        let number: f64 = format!("{digits}e{exponent}").parse().expect("a number");
        (digits.into(), exponent, number)
    }

    #[test]
    fn products_are_those_of_whole_numbers_of_any_length() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(7);
        let mut drawn = || {
            let limbs = noise.next_u64() % 6;
            let mut natural = Natural((0..limbs).map(|_| noise.next_u64() as u32).collect());
            natural.trim();
            natural
        };
        let big = |natural: &Natural| BigInt::from_slice(num_bigint::Sign::Plus, &natural.0);
        for _ in 0..2000 {
            let (a, b) = (drawn(), drawn());
            assert_eq!(big(&a.times(&b)), big(&a) * big(&b), "{a:?} {b:?}");
        }
    }

    /// Held against a library's whole numbers of any length: (a - b)*c/d.
    #[test]
    fn quotients_are_those_of_whole_numbers_of_any_length() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(5);
        let ten = |exponent: i32| BigInt::from(10).pow(exponent.unsigned_abs());
        for round in 0..20_000 {
            let (a, b) = (drawn(&mut noise, true), drawn(&mut noise, true));
            let (c, d) = (drawn(&mut noise, false), drawn(&mut noise, false));
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
            // No f64 beside it is nearer.
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

    /// A number as a whole one times 2 to a power.
    fn decimal_of_bits(number: f64) -> (i64, i32) {
        let bits = number.to_bits();
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
        let (digits, exponent) =
            if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
        (if number < 0.0 { -digits } else { digits }, exponent)
    }

    /// Whole numbers below 2^53 are exact in f64, and IEEE 754 rounds one quotient of two to the nearest.
    #[test]
    fn the_nearest_number_is_that_of_a_single_division() {
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
