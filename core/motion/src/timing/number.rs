//! The number type of a curve's formula (DESIGN B1): in f64 the formula computes the curve and the times of its steps, in 106
//! bits (`double`) it decides near ties.

use crate::square_root;
use core::ops::{Add, Div, Mul, Sub};

pub(crate) trait Number:
    Copy
    + PartialOrd
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    const PI: Self;

    fn square_root(self) -> Self;

    fn cube_root(self) -> Self;

    /// x - sin(x) without cancellation, for x from 0 to pi.
    fn minus_its_sine(self) -> Self;

    fn magnitude(self) -> Self {
        if self < 0.0.into() { Self::from(0.0) - self } else { self }
    }

    /// The number, or 0 if it is negative.
    fn or_zero(self) -> Self {
        if self > 0.0.into() { self } else { 0.0.into() }
    }
}

impl Number for f64 {
    const PI: Self = core::f64::consts::PI;

    fn square_root(self) -> Self {
        square_root(self)
    }

    fn cube_root(self) -> Self {
        libm::cbrt(self)
    }

    fn minus_its_sine(self) -> Self {
        if self > 1.0 {
            return self - libm::sin(self);
        }
        // x^3/3! - x^5/5! + …, eight terms; the ninth is below 2^-53 of the sum.
        let square = self * self;
        let mut sum = 1.0;
        for k in (1..8).rev() {
            let k = f64::from(k);
            sum = 1.0 - sum * square / ((2.0 * k + 2.0) * (2.0 * k + 3.0));
        }
        sum * square * self / 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_sine_agree() {
        for x in [1e-9, 1e-3, 0.5, 0.999, 1.0] {
            let given = x.minus_its_sine();
            let expected = if x < 1e-2 { x * x * x / 6.0 * (1.0 - x * x / 20.0) } else { x - libm::sin(x) };
            assert!((given - expected).abs() <= 2e-15 * expected.max(x), "{x}: {given} {expected}");
        }
    }
}
