//! The shapes of a ramp: how the speed goes from nothing to its top (DESIGN B4; Song, Han, Lu 2021, table 1).
//!
//! Over the ramp's own time x = t/t_s, from 0 to 1, a shape g goes from exactly 0 to exactly 1; the speed is f_max*g(x).
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
//! A sigmoid that is cut off at +-r starts with a jump and stops short of its speed, as the paper finds. Here it is shifted
//! and stretched to meet both ends. Near the start most terms cancel; each formula is written so that none does.

mod exactly;

use crate::{bisection::Bracket, square_root};

/// Newton's steps after which a place is taken as it is; from the guesses here seven do.
const MAX_STEPS: u32 = 100;

/// The longest ramp in s with which `steps` in `duration_s` keep their top speed at or under `speed` steps/s,
/// for ramps of the area `area` (1/2 for every symmetric shape), of which a move can use up to half of its
/// duration; `None` where the move is too fast with no ramp at all.
///
/// The paper's t_s <= t_i - n/f_s (B4), and for any other area t_s <= (t_i - n/f_s)/(2*(1 - area)).
#[must_use]
pub fn longest_ramp_s(steps: u64, duration_s: f64, speed: f64, area: f64) -> Option<f64> {
    let ramp_s = (duration_s - steps as f64 / speed) / (2.0 * (1.0 - area));
    (ramp_s >= 0.0).then_some(ramp_s)
}

/// A ramp's shape, over x of 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ramp {
    /// A logistic function's middle.
    Sigmoid(Sigmoid),
    /// A cubic Bezier curve with the control values 0, 0, 1, 1 at even times.
    Bezier,
    /// A straight line, so a trapezoid.
    Straight,
    /// The approach of an exponential, steep at first: as a motor's torque falls with its rate.
    Exponential(Exponential),
}

/// 1/(1 + e^-u) between -range and +range, stretched to begin at 0 and to end at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmoid {
    range: f64,
    /// tanh(range/2): how much of its whole height the range has.
    part: f64,
    /// sinh(range/2).
    sinh: f64,
    /// 1/(1 + e^range), where the range begins.
    low: f64,
}

/// 1 - e^-u from 0 to so many time constants, stretched to end at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    constants: f64,
    /// 1 - e^-constants: how far it comes by itself.
    part: f64,
}

impl Ramp {
    /// A sigmoid from -`range` to +`range`, which is above 0.
    #[must_use]
    pub fn sigmoid(range: f64) -> Self {
        let half = range / 2.0;
        let low = 1.0 / (1.0 + libm::exp(range));
        Self::Sigmoid(Sigmoid { range, part: libm::tanh(half), sinh: libm::sinh(half), low })
    }

    /// An exponential of so many time constants, above 0.
    #[must_use]
    pub fn exponential(constants: f64) -> Self {
        Self::Exponential(Exponential { constants, part: -libm::expm1(-constants) })
    }

    /// A = G(1), at least 1/2: the part of the ramp's time at top speed that has the ramp's travel.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Exponential(curve) => curve.travel(1.0),
            _ => 0.5,
        }
    }

    /// g(x), the part of the top speed.
    #[must_use]
    pub fn speed(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.speed(x),
            Self::Bezier => x * x * (3.0 - 2.0 * x),
            Self::Straight => x,
            Self::Exponential(curve) => -libm::expm1(-curve.constants * x) / curve.part,
        }
    }

    /// G(x), the travel in parts of that which the whole ramp's time has at top speed.
    #[must_use]
    pub fn travel(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.travel(x),
            Self::Bezier => x * x * x * (1.0 - x / 2.0),
            Self::Straight => x * x / 2.0,
            Self::Exponential(curve) => curve.travel(x),
        }
    }

    /// g'(x); times f_max/t_s it is the acceleration.
    #[must_use]
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

    /// The maximum g'.
    #[must_use]
    pub fn greatest_slope(&self) -> f64 {
        match self {
            Self::Sigmoid(_) | Self::Bezier => self.slope(0.5),
            Self::Straight | Self::Exponential(_) => self.slope(0.0),
        }
    }

    /// The maximum |g''|; times f_max/t_s^2 it is the jerk.
    #[must_use]
    pub fn greatest_bend(&self) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.greatest_bend(),
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

    /// The x of 0..=1 with G(x) = `travel`, 0..=[`Ramp::area`], to the last digits.
    #[must_use]
    pub fn at_travel(&self, travel: f64) -> f64 {
        let guess = match self {
            _ if travel <= 0.0 => return 0.0,
            Self::Straight => return least(square_root(2.0 * travel), 1.0),
            Self::Bezier => {
                // From x^3 = travel/(1 - x/2), once put into itself.
                let root = libm::cbrt(travel);
                libm::cbrt(travel / (1.0 - root / 2.0))
            }
            Self::Sigmoid(curve) => curve.guess(travel),
            Self::Exponential(curve) => curve.guess(travel),
        };
        self.newton(travel, least(guess, 1.0))
    }

    /// From a guess to the x with G(x) = `travel`. G rises and bends upwards, so from above Newton's steps
    /// fall towards it; a step that leaves what is known of it is halved into it.
    fn newton(&self, travel: f64, guess: f64) -> f64 {
        let (mut bracket, mut x) = (Bracket::new(0.0, 1.0), guess);
        for _ in 0..MAX_STEPS {
            let over = self.travel(x) - travel;
            bracket.narrow(x, over < 0.0);
            let next = x - over / self.speed(x);
            if libm::fabs(next - x) <= 4.0 * f64::EPSILON * x {
                return least(next, 1.0);
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
            // Both logarithm and exponential without their first terms, which cancel.
            logarithm_rest(climbed) + p * exponential_rest(z)
        } else {
            libm::log1p(climbed) - p * z
        };
        area / (2.0 * self.range * self.part)
    }

    /// Of G's formula e^z - 1 - z is as good as a square while z is small, and as e^z later.
    fn guess(&self, travel: f64) -> f64 {
        let area = 2.0 * self.range * self.part * travel;
        let rest = libm::expm1(area) / (self.low * (1.0 - self.low));
        libm::log1p(rest + square_root(2.0 * rest)) / (2.0 * self.range)
    }

    fn greatest_bend(&self) -> f64 {
        // |g''| = r^2*tanh(v)*(1 - tanh(v)^2)/tanh(r/2) with v up to r/2, greatest where tanh(v)^2 = 1/3.
        let steepest = square_root(1.0 / 3.0);
        let tanh = least(self.part, steepest);
        self.range * self.range * tanh * (1.0 - tanh * tanh) / self.part
    }
}

impl Exponential {
    /// G = (e^-z - 1 + z)/(k*(1 - e^-k)) with z = k*x.
    fn travel(&self, x: f64) -> f64 {
        exponential_rest(-self.constants * x) / (self.constants * self.part)
    }

    fn guess(&self, travel: f64) -> f64 {
        let rest = travel * self.constants * self.part;
        (square_root(2.0 * rest) + rest / 3.0) / self.constants
    }
}

fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// e^z - 1 - z, with all digits also where both nearly cancel.
fn exponential_rest(z: f64) -> f64 {
    if libm::fabs(z) > 0.5 {
        return libm::expm1(z) - z;
    }
    // z^2/2! + z^3/3! + …, thirteen terms; the next is under 2^-53 of the sum.
    let mut sum = 1.0;
    for k in (3..15).rev() {
        sum = 1.0 + sum * z / f64::from(k);
    }
    sum * z * z / 2.0
}

/// ln(1 + x) - x for x of 0..=1, with all digits also where both nearly cancel.
fn logarithm_rest(x: f64) -> f64 {
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
