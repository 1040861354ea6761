//! Numbers of 106 bits as the sum of two f64 (Dekker 1971), for the few steps whose time in f64 is too close to the middle
//! between two cycles (DESIGN B1, `rounding`).
//!
//! ```text
//! high  |53 bits|                     the f64 nearest to the sum
//! low            |53 bits|            at most half of high's last digit
//! ```
//!
//! Each operation has an error of a few 2^-104, each series at most 2^-100. Only + - * / and the square root are used, so
//! every target gets the same bits; a cube root starts from `libm`'s.

use crate::{square_root, timing::number::Number};
use core::ops::{Add, Div, Mul, Sub};

/// A number of 106 bits: the sum of two f64 (a double-double).
// Invariant: `high` is the f64 nearest to the sum, so the derived comparison is right.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(crate) struct F106 {
    pub(crate) high: f64,
    pub(crate) low: f64,
}

/// 2^27 + 1: a multiplication by it splits a number into two halves of 26 bits.
const SPLITTER: f64 = 134_217_729.0;

/// Terms of a series below this part of the sum are ignored.
const MIN_TERM: f64 = 1e-33;
/// The series of e^41 needs 200 terms.
const MAX_TERMS: u32 = 400;

impl From<f64> for F106 {
    fn from(number: f64) -> Self {
        Self { high: number, low: 0.0 }
    }
}

impl From<u64> for F106 {
    fn from(whole: u64) -> Self {
        let upper = (whole >> 32) as f64 * 4_294_967_296.0;
        Self::sum(upper, (whole & 0xffff_ffff) as f64)
    }
}

impl F106 {
    pub(crate) fn sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let from_b = high - a;
        Self { high, low: (a - (high - from_b)) + (b - from_b) }
    }

    fn product(a: f64, b: f64) -> Self {
        let halves = |x: f64| {
            let scaled = SPLITTER * x;
            let upper = scaled - (scaled - x);
            (upper, x - upper)
        };
        let ((a_upper, a_lower), (b_upper, b_lower)) = (halves(a), halves(b));
        let high = a * b;
        let low = ((a_upper * b_upper - high) + a_upper * b_lower + a_lower * b_upper) + a_lower * b_lower;
        Self { high, low }
    }

    fn negated(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }

    /// The sum of `power`/from! and the following terms, each `ratio` times the previous one, divided by the next
    /// `factors_per_term` factors of the factorial.
    fn series(power: Self, from: u32, ratio: Self, factors_per_term: u32) -> Self {
        // `from` is 2 or 3, so two factors are the factorial.
        let mut term = power / f64::from(from * (from - 1));
        let (mut sum, mut factor) = (term, from);
        for _ in 0..MAX_TERMS {
            let divisor: f64 = (factor + 1..=factor + factors_per_term).map(f64::from).product();
            factor += factors_per_term;
            term = term / divisor * ratio;
            sum = sum + term;
            if libm::fabs(term.high) <= MIN_TERM * libm::fabs(sum.high) {
                break;
            }
        }
        sum
    }
}

impl Number for F106 {
    const PI: Self = Self { high: core::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

    fn square_root(self) -> Self {
        let root = square_root(self.high);
        if root <= 0.0 {
            return Self::default();
        }
        // One step of Newton's method doubles the digits.
        let residual = self - Self::product(root, root);
        Self::sum(root, residual.high / (2.0 * root))
    }

    fn cube_root(self) -> Self {
        let root = libm::cbrt(self.high);
        let residual = self - Self::product(root, root) * root;
        Self::sum(root, residual.high / (3.0 * root * root))
    }

    /// x^3/3! - x^5/5! + …, for x from 0 to slightly above pi: the magnitudes of its terms add up to at most three times
    /// their sum.
    fn minus_its_sine(self) -> Self {
        let square = self * self;
        Self::series(square * self, 3, square.negated(), 2)
    }
}

impl F106 {
    /// e^x - 1 - x without cancellation, for x from -20 to slightly above 40.
    pub(crate) fn exponential_remainder(self) -> Self {
        if self.high < -1.0 {
            // From e^-x, whose terms do not cancel.
            let opposite = self.negated();
            return opposite - 1.0 + Self::from(1.0) / (opposite + opposite.exponential_remainder() + 1.0);
        }
        Self::series(self * self, 2, self, 1)
    }
}

impl Add for F106 {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::sum(self.high, other.high), Self::sum(self.low, other.low));
        let sum = Self::sum(high.high, high.low + low.high);
        Self::sum(sum.high, sum.low + low.low)
    }
}

impl Sub for F106 {
    type Output = Self;

    #[allow(clippy::suspicious_arithmetic_impl, reason = "the difference is the sum with the opposite")]
    fn sub(self, other: Self) -> Self {
        self + other.negated()
    }
}

impl Mul for F106 {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = Self::product(self.high, other.high);
        Self::sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for F106 {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        // Long division with three digits of 53 bits.
        let first = self.high / other.high;
        let remainder = self - other * first;
        let second = remainder.high / other.high;
        let remainder = remainder - other * second;
        Self::sum(first, second) + remainder.high / other.high
    }
}

macro_rules! with_f64 {
    ($($operation:ident $name:ident,)*) => {$(
        impl $operation<f64> for F106 {
            type Output = Self;

            fn $name(self, other: f64) -> Self {
                $operation::$name(self, Self::from(other))
            }
        }
    )*};
}

with_f64! { Add add, Sub sub, Mul mul, Div div, }

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares two numbers with a relative tolerance.
    fn check(found: F106, expected: F106) {
        let off = libm::fabs((found - expected).high);
        assert!(off <= 1e-30 * libm::fabs(expected.high), "{found:?} {expected:?}: {off}");
    }

    fn number(number: f64) -> F106 {
        F106::decimal(number)
    }

    #[test]
    fn a_decimal_is_not_its_nearest_f64() {
        let tenth = number(0.1);
        assert!(tenth.high == 0.1 && tenth.low != 0.0);
        check(tenth * 10.0, 1.0.into());
        check(number(-1e22), (-1e22).into());
        assert_eq!(number(0.0), F106::default());
        check(F106::from(u64::MAX) + 1.0, 18_446_744_073_709_551_616.0.into());
    }

    #[test]
    fn operations_are_inverses() {
        for i in 1..2000 {
            let (a, b) = (number(f64::from(i) / 7.0), number(1e9 / f64::from(i * i)));
            check(a * b / b, a);
            check(a.square_root() * a.square_root(), a);
            check(b.cube_root() * b.cube_root() * b.cube_root(), b);
            check(F106::from(1.0) / (F106::from(1.0) / a), a);
        }
        assert_eq!(F106::default().square_root(), F106::default());
        assert!(number(0.3) > number(0.1) + number(0.1) && number(0.1) <= number(0.1));
    }

    /// By sin(2x) = 2*sin(x)*sin(pi/2 - x), and sin(pi/6) = 1/2.
    #[test]
    fn a_sine_has_106_bits() {
        let sine = |x: F106| x - x.minus_its_sine();
        check(sine(F106::PI / 6.0), 0.5.into());
        check(F106::PI.minus_its_sine(), F106::PI);
        for i in 1..50 {
            let x = F106::PI * f64::from(i) / 200.0;
            check(sine(x + x), sine(x) * sine(F106::PI / 2.0 - x) * 2.0);
        }
        // 1e-9^3/6*(1 - 1e-18/20 + …).
        let small = number(1e-9);
        check(small.minus_its_sine(), small * small * small / 6.0 * (F106::from(1.0) - number(5e-20)));
    }

    #[test]
    fn an_exponential_has_106_bits() {
        let exponential = |x: F106| x.exponential_remainder() + x + 1.0;
        // ln(2), so the results are powers of 2.
        let logarithm = F106 { high: core::f64::consts::LN_2, low: 2.319_046_813_846_299_6e-17 };
        for i in [-28.0, -3.0, 1.0, 2.0, 10.0, 59.0] {
            check(exponential(logarithm * i), libm::exp2(i).into());
        }
        // On both sides of 0, and where the formula changes.
        for x in [1e-9, 0.3, 0.999, 1.001] {
            let (above, below) = (number(x).exponential_remainder(), number(-x).exponential_remainder());
            let one = F106::from(1.0);
            check((one + number(x) + above) * (one - number(x) + below), one);
        }
        // x^2/2*(1 + x/3 + x^2/12 + x^3/60 + …).
        let terms = number(1e-9) / 3.0 + number(1e-18) / 12.0 + number(1e-27) / 60.0;
        check(number(1e-9).exponential_remainder(), number(5e-19) * (terms + 1.0));
    }
}
