//! The shapes of a ramp in 106 bits (DESIGN B1, B4): decide whether the travel at a time exceeds a given one.
//!
//! With R(z) = e^z - 1 - z without cancellation, z = k*x of an exponential and z = 2*r*x of a sigmoid:
//!
//! ```text
//! exponential   G = R(-z)/(k*(k - R(-k)))          A = G(1)
//! sigmoid       G > g   where   p*R(z) - R(w) > c*g,   w = p*z + c*g
//!               p = 1/(2 + r + R(r)),  c = 2*r*(r + R(r))/(2 + r + R(r))
//! ```
//!
//! The sigmoid's formula is ln(1 + p*(e^z - 1)) - p*z > c*g (`ramp`) without the logarithm.

use super::Ramp;
use crate::timing::F106;

#[derive(Clone, Copy)]
pub(crate) enum ExactRamp {
    Sigmoid { twice_range: F106, low: F106, scale: F106 },
    Bezier,
    Straight,
    Exponential { constants: F106, scale: F106 },
}

impl Ramp {
    pub(crate) fn exact(&self) -> ExactRamp {
        match self {
            Self::Sigmoid(curve) => {
                let range = F106::decimal(curve.range);
                let past_one = range + range.exponential_remainder();
                let (twice_range, denominator) = (range * 2.0, past_one + 2.0);
                let low = F106::from(1.0) / denominator;
                ExactRamp::Sigmoid { twice_range, low, scale: twice_range * past_one / denominator }
            }
            Self::Bezier => ExactRamp::Bezier,
            Self::Straight => ExactRamp::Straight,
            Self::Exponential(curve) => {
                let constants = F106::decimal(curve.constants);
                let part = constants - (F106::default() - constants).exponential_remainder();
                ExactRamp::Exponential { constants, scale: constants * part }
            }
        }
    }
}

impl ExactRamp {
    pub(crate) fn area(self) -> F106 {
        match self {
            Self::Exponential { constants, scale } => {
                (F106::default() - constants).exponential_remainder() / scale
            }
            _ => 0.5.into(),
        }
    }

    pub(crate) fn is_past(self, x: F106, travel: F106) -> bool {
        match self {
            Self::Sigmoid { twice_range, low, scale } => {
                let (z, area) = (twice_range * x, scale * travel);
                let remainder = (low * z + area).exponential_remainder();
                low * z.exponential_remainder() - remainder > area
            }
            Self::Bezier => x * x * x * (F106::from(1.0) - x * 0.5) > travel,
            Self::Straight => x * x * 0.5 > travel,
            Self::Exponential { constants, scale } => {
                (F106::default() - constants * x).exponential_remainder() / scale > travel
            }
        }
    }
}
