//! Numbers of about 32 digits, as sums of two f64, for an independent check of the planners' f64.
//!
//! ```text
//! x = high + low, |low| at most half of high's last digit
//! a + b, a*b   Knuth's and Dekker's sums and products without error, then put in order again
//! a + b, a*b   Knuth's and Dekker's exact sums and products, then normalized

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A number of about 32 digits.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub(crate) struct Wide {
    high: f64,
    low: f64,
}

/// pi.
pub(crate) const PI: Wide = Wide { high: core::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

/// a + b without an error.
fn two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    let virtual_b = high - a;
    Wide { high, low: (a - (high - virtual_b)) + (b - virtual_b) }
}

/// The same, if |a| is at least |b|.
fn in_order(a: f64, b: f64) -> Wide {
    let high = a + b;
    Wide { high, low: b - (high - a) }
}

/// a*b without an error, for magnitudes that do not overflow Dekker's splitting.
fn two_product(a: f64, b: f64) -> Wide {
    let split = |x: f64| {
        let scaled = 134_217_729.0 * x;
        let top = scaled - (scaled - x);
        (top, x - top)
    };
    let ((a1, a0), (b1, b0)) = (split(a), split(b));
    let high = a * b;
    Wide { high, low: ((a1 * b1 - high) + a1 * b0 + a0 * b1) + a0 * b0 }
}

impl From<f64> for Wide {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl From<u64> for Wide {
    /// Exact.
    fn from(whole: u64) -> Self {
        let top = whole >> 32;
        two_sum((top << 32) as f64, (whole & 0xffff_ffff) as f64)
    }
}

impl Neg for Wide {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for Wide {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (highs, lows) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let first = in_order(highs.high, highs.low + lows.high);
        in_order(first.high, first.low + lows.low)
    }
}

impl Sub for Wide {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        in_order(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Wide {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from(second);
        in_order(first, second) + Self::from(rest.high / other.high)
    }
}

impl Wide {
    /// The nearest f64.
    pub(crate) fn to_f64(self) -> f64 {
        self.high
    }

    /// The square root of a number >= 0.
    pub(crate) fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::from(0.0);
        }
        let root = Self::from(libm::sqrt(self.high));
        root + (self - root * root) / (root + root)
    }

    /// The cube root of a number >= 0.
    pub(crate) fn cbrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::from(0.0);
        }
        let root = Self::from(libm::cbrt(self.high));
        root + (self - root * root * root) / (Self::from(3.0) * root * root)
    }

    /// The sine of 0 to pi, by its series; near pi with an error of 1e-30.
    pub(crate) fn sin(self) -> Self {
        let square = self * self;
        let mut sum = Self::from(1.0);
        for k in (1..28).rev() {
            let k = f64::from(k);
            sum = Self::from(1.0) - sum * square / Self::from((2.0 * k) * (2.0 * k + 1.0));
        }
        sum * self
    }

    /// The minimum.
    pub(crate) fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// The maximum.
    pub(crate) fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn same(found: Wide, expected: Wide) {
        let off = (found - expected).to_f64();
        assert!(off.abs() <= 1e-30 * expected.to_f64().abs(), "{found:?} {expected:?}");
    }

    #[test]
    fn operations_are_exact_to_thirty_digits() {
        let third = Wide::from(1.0) / Wide::from(3.0);
        same(third * Wide::from(3.0), Wide::from(1.0));
        for x in [2.0, 1e-9, 123_456_789.125] {
            let x = Wide::from(x) * third;
            same(x.sqrt() * x.sqrt(), x);
            same(x.cbrt() * x.cbrt() * x.cbrt(), x);
            let off = (x - third + third - x).to_f64();
            assert!(off.abs() <= 1e-31 * (x + third).to_f64(), "{off}");
        }
        assert_eq!(Wide::from(u64::MAX) - Wide::from(u64::MAX - 1), Wide::from(1.0));
        same((PI / Wide::from(6.0)).sin(), Wide::from(0.5));
        same((PI * Wide::from(2.0) * third).sin(), Wide::from(0.75).sqrt());
        assert!(PI.sin().to_f64().abs() < 1e-30);
    }
}
