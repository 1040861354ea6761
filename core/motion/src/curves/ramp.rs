//! The shapes of a ramp (DESIGN B4; Song, Han, Lu 2021, table 1): over x = t/t_s from 0 to 1 a shape g rises from exactly 0
//! to exactly 1, and the speed is f_max*g(x).
//!
//! ```text
//!  1 |        .--         g(x)   part of the top speed
//!    |      /             G(x)   its integral from 0, so the travel is f_max*t_s*G(x)
//!    |    /               A      G(1), the ramp's area: f_max = n/(T - 2*t_s*(1 - A))
//!  0 | _-'
//!    +-----------         straight      g = x                                  A = 1/2
//!      0        1         bezier        g = 3x^2 - 2x^3                         A = 1/2
//!                         sigmoid       g = (S(u) - S(-r))/(S(r) - S(-r))       A = 1/2
//!                                       S(u) = 1/(1 + e^-u), u = r*(2x - 1)
//!                         exponential   g = (1 - e^-kx)/(1 - e^-k)              A = 1/(1 - e^-k) - 1/k
//! ```
//!
//! A sigmoid cut off at +-r starts with a jump and does not reach its speed, as the paper finds. Here it is shifted and
//! stretched to reach both ends. The formulas are written so that terms do not cancel near the start.

mod exact;

use crate::{bisection::Bracket, curves::curve::lesser, square_root};

/// Maximum steps of Newton's method; seven are enough.
const MAX_STEPS: u32 = 100;

/// The longest ramp in s, maybe above half the duration, with which `steps` in `duration_s` need at most `speed` steps/s;
/// `None` if they need more even without ramps. For an `area` of 1/2 it is the paper's t_i - n/f_s.
pub fn longest_ramp_s(steps: u64, duration_s: f64, speed: f64, area: f64) -> Option<f64> {
    let ramp_s = (duration_s - steps as f64 / speed) / (2.0 * (1.0 - area));
    (ramp_s >= 0.0).then_some(ramp_s)
}

/// The shape of a ramp with its parameters ([`RampShape`](crate::moves::RampShape)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ramp {
    Sigmoid(Sigmoid),
    Bezier,
    Straight,
    Exponential(Exponential),
}

/// 1/(1 + e^-u) between -range and +range, stretched to begin at 0 and to end at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmoid {
    range: f64,
    /// tanh(range/2), the part of the height within the range.
    part: f64,
    /// sinh(range/2).
    sinh: f64,
    /// 1/(1 + e^range), the value at the start of the range.
    low: f64,
}

/// 1 - e^-u from 0 to a number of time constants, stretched to end at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    constants: f64,
    /// 1 - e^-constants, the part of the height within the range.
    part: f64,
}

impl Ramp {
    /// A sigmoid from -`range` to +`range` > 0.
    pub fn sigmoid(range: f64) -> Self {
        let half = range / 2.0;
        let low = 1.0 / (1.0 + libm::exp(range));
        Self::Sigmoid(Sigmoid { range, part: libm::tanh(half), sinh: libm::sinh(half), low })
    }

    /// An exponential of `constants` > 0 time constants.
    pub fn exponential(constants: f64) -> Self {
        Self::Exponential(Exponential { constants, part: -libm::expm1(-constants) })
    }

    /// A = G(1) >= 1/2: the travel of the ramp in units of its time at top speed.
    pub fn area(&self) -> f64 {
        match self {
            Self::Exponential(curve) => curve.travel(1.0),
            _ => 0.5,
        }
    }

    /// g(x), in units of the top speed.
    pub fn speed(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.speed(x),
            Self::Bezier => x * x * (3.0 - 2.0 * x),
            Self::Straight => x,
            Self::Exponential(curve) => -libm::expm1(-curve.constants * x) / curve.part,
        }
    }

    /// G(x), in units of the ramp's time at top speed.
    pub fn travel(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.travel(x),
            Self::Bezier => x * x * x * (1.0 - x / 2.0),
            Self::Straight => x * x / 2.0,
            Self::Exponential(curve) => curve.travel(x),
        }
    }

    /// g'(x); times f_max/t_s it is the acceleration.
    pub fn slope(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.slope(x),
            Self::Bezier => 6.0 * x * (1.0 - x),
            Self::Straight => 1.0,
            Self::Exponential(Exponential { constants, part }) => {
                constants * libm::exp(-constants * x) / part
            }
        }
    }

    /// Maximum g'.
    pub fn max_slope(&self) -> f64 {
        match self {
            Self::Sigmoid(_) | Self::Bezier => self.slope(0.5),
            Self::Straight | Self::Exponential(_) => self.slope(0.0),
        }
    }

    /// Maximum |g''|; times f_max/t_s^2 it is the jerk.
    pub fn max_curvature(&self) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.max_curvature(),
            Self::Bezier => 6.0,
            Self::Straight => 0.0,
            Self::Exponential(Exponential { constants, part }) => constants * constants / part,
        }
    }

    pub(crate) fn sharpness(&self) -> f64 {
        match self {
            Self::Sigmoid(Sigmoid { range, .. }) => *range,
            Self::Exponential(Exponential { constants, .. }) => *constants,
            Self::Bezier | Self::Straight => 0.0,
        }
    }

    /// The x of 0..=1 with G(x) = `travel`, which is in 0..=[`Ramp::area`].
    pub fn at_travel(&self, travel: f64) -> f64 {
        let guess = match self {
            _ if travel <= 0.0 => return 0.0,
            Self::Straight => return lesser(square_root(2.0 * travel), 1.0),
            Self::Bezier => guess_bezier(travel),
            Self::Sigmoid(curve) => curve.guess(travel),
            Self::Exponential(curve) => curve.guess(travel),
        };
        self.newton(travel, lesser(guess, 1.0))
    }

    /// G rises and is convex, so Newton's method approaches the root from above. A step that leaves the bracket is bisected.
    fn newton(&self, travel: f64, guess: f64) -> f64 {
        let (mut bracket, mut x) = (Bracket::new(0.0, 1.0), guess);
        for _ in 0..MAX_STEPS {
            let excess = self.travel(x) - travel;
            bracket.narrow(x, excess < 0.0);
            let next = x - excess / self.speed(x);
            if libm::fabs(next - x) <= 4.0 * f64::EPSILON * x {
                return lesser(next, 1.0);
            }
            x = if next > bracket.low && next < bracket.high { next } else { bracket.middle() };
        }
        x
    }
}

impl Sigmoid {
    fn speed(&self, x: f64) -> f64 {
        // tanh a + tanh b = sinh(a + b)/(cosh a*cosh b), and a + b is 0 at the start.
        let middle = libm::cosh(self.range * (x - 0.5));
        libm::sinh(self.range * x) / (2.0 * middle * self.sinh)
    }

    fn slope(&self, x: f64) -> f64 {
        let middle = libm::cosh(self.range * (x - 0.5));
        self.range / (2.0 * self.part * middle * middle)
    }

    /// G = (ln(1 + p*(e^z - 1)) - p*z)/(2*r*tanh(r/2)) with z = 2*r*x and p = S(-r).
    fn travel(&self, x: f64) -> f64 {
        let (p, z) = (self.low, 2.0 * self.range * x);
        let climbed = p * libm::expm1(z);
        let area = if z <= 1.0 {
            // The first terms of logarithm and exponential cancel, so both are computed without them.
            logarithm_remainder(climbed) + p * exponential_remainder(z)
        } else {
            libm::log1p(climbed) - p * z
        };
        area / (2.0 * self.range * self.part)
    }

    /// Solves e^z - 1 - z approximately: it is close to z^2/2 for small z, and to e^z for large z.
    fn guess(&self, travel: f64) -> f64 {
        let area = 2.0 * self.range * self.part * travel;
        let remainder = libm::expm1(area) / (self.low * (1.0 - self.low));
        libm::log1p(remainder + square_root(2.0 * remainder)) / (2.0 * self.range)
    }

    fn max_curvature(&self) -> f64 {
        // |g''| = r^2*tanh(v)*(1 - tanh(v)^2)/tanh(r/2) with v up to r/2; its maximum is at tanh(v)^2 = 1/3.
        let steepest = square_root(1.0 / 3.0);
        let tanh = lesser(self.part, steepest);
        self.range * self.range * tanh * (1.0 - tanh * tanh) / self.part
    }
}

impl Exponential {
    /// G = (e^-z - 1 + z)/(k*(1 - e^-k)) with z = k*x.
    fn travel(&self, x: f64) -> f64 {
        exponential_remainder(-self.constants * x) / (self.constants * self.part)
    }

    fn guess(&self, travel: f64) -> f64 {
        let remainder = travel * self.constants * self.part;
        (square_root(2.0 * remainder) + remainder / 3.0) / self.constants
    }
}

/// One iteration of x^3 = travel/(1 - x/2).
fn guess_bezier(travel: f64) -> f64 {
    let root = libm::cbrt(travel);
    libm::cbrt(travel / (1.0 - root / 2.0))
}

/// e^z - 1 - z without cancellation.
fn exponential_remainder(z: f64) -> f64 {
    if libm::fabs(z) > 0.5 {
        return libm::expm1(z) - z;
    }
    // z^2/2! + z^3/3! + …, thirteen terms; the next is below 2^-53 of the sum.
    let mut sum = 1.0;
    for k in (3..15).rev() {
        sum = 1.0 + sum * z / f64::from(k);
    }
    sum * z * z / 2.0
}

/// ln(1 + x) - x for x of 0..=1, without cancellation.
fn logarithm_remainder(x: f64) -> f64 {
    // With s = x/(2 + x), up to 1/3, ln(1 + x) = 2*(s + s^3/3 + s^5/5 + …), and 2*s - x = -x*s.
    let s = x / (2.0 + x);
    let square = s * s;
    let mut sum = 0.0;
    for k in (1..17).rev() {
        sum = square * (sum + 1.0 / f64::from(2 * k + 1));
    }
    s * (2.0 * sum - x)
}

#[cfg(test)]
mod tests;
