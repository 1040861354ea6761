//! A monotone cubic between two points (DESIGN B6): position at a time, and time at a position.
//!
//! ```text
//!  y1 |        .-'    from its start   (m0 + (c2 + c3*x)*x)*x   c2 = (2*(d - m0) + (d - m1))/h
//!     |     /                                                   c3 = ((m0 - d) + (m1 - d))/h^2
//!  y0 | _.-'          from its end     the same with m0 and m1 exchanged
//!     0         h     length h, mean slope d, slopes m0 and m1 at the ends, from 0 to 2*d
//! ```
//!
//! Both are computed from the nearer end, where they are small, so steps next to a reversal lose no digits.

use crate::{bisection::Bracket, curves::curve::greater, square_root, timing::Number};

/// Maximum steps of Newton's method; eight are enough.
const MAX_NEWTON_STEPS: u32 = 64;

/// Times in s, positions in steps and speeds in steps/s at the start and the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cubic<N = f64> {
    pub(crate) from_s: N,
    pub(crate) to_s: N,
    pub(crate) from: N,
    pub(crate) to: N,
    pub(crate) from_speed: N,
    pub(crate) to_speed: N,
}

/// The cubic over the time x from one of its ends: the travel is near_speed*x + square*x^2 + cube*x^3.
#[derive(Clone, Copy)]
pub(crate) struct FromEnd<N = f64> {
    near_speed: N,
    square: N,
    cube: N,
}

impl<N: Number> FromEnd<N> {
    pub(crate) fn travel(self, x: N) -> N {
        (self.near_speed + (self.square + self.cube * x) * x) * x
    }
}

impl FromEnd {
    fn speed(self, x: f64) -> f64 {
        self.near_speed + (2.0 * self.square + 3.0 * self.cube * x) * x
    }

    /// The x of 0..=`length` at a travel of at most half the total.
    fn time(self, travel: f64, length: f64) -> f64 {
        // The root without the cubic term: exact for a straight line, and close enough for Newton's method.
        let square = self.near_speed * self.near_speed + 4.0 * self.square * travel;
        let slope = self.near_speed + square_root(greater(0.0, square));
        let mut x = if slope > 0.0 { 2.0 * travel / slope } else { length };
        let mut bracket = Bracket::new(0.0, length);
        if x > length {
            x = bracket.middle();
        }
        for _ in 0..MAX_NEWTON_STEPS {
            let missing = travel - self.travel(x);
            bracket.narrow(x, missing >= 0.0);
            let next = x + missing / self.speed(x);
            // The comparison also rejects NaN, from a slope of 0.
            let next = if next >= bracket.low && next <= bracket.high { next } else { bracket.middle() };
            let done = libm::fabs(next - x) <= x * f64::EPSILON;
            x = next;
            if done {
                break;
            }
        }
        x
    }
}

impl<N: Number> Cubic<N> {
    pub(crate) fn length_s(&self) -> N {
        self.to_s - self.from_s
    }

    fn mean_speed(&self) -> N {
        (self.to - self.from) / self.length_s()
    }

    fn seen_from_end_with(&self, near_speed: N, far_speed: N) -> FromEnd<N> {
        let (mean, length) = (self.mean_speed(), self.length_s());
        FromEnd {
            near_speed,
            square: ((mean - near_speed) * 2.0 + (mean - far_speed)) / length,
            cube: ((near_speed - mean) + (far_speed - mean)) / (length * length),
        }
    }

    pub(crate) fn seen_from_start(&self) -> FromEnd<N> {
        self.seen_from_end_with(self.from_speed, self.to_speed)
    }

    pub(crate) fn seen_from_end(&self) -> FromEnd<N> {
        self.seen_from_end_with(self.to_speed, self.from_speed)
    }
}

/// Slope at the point between two pieces of length h and mean slope d (Steffen 1990); 0 where the curve reverses.
pub(crate) fn slope_between<N: Number>((h0, d0): (N, N), (h1, d1): (N, N)) -> N {
    let zero = N::from(0.0);
    if !((d0 > zero && d1 > zero) || (d0 < zero && d1 < zero)) {
        return zero;
    }
    let parabola = (d0 * h1 + d1 * h0) / (h0 + h1);
    let smaller = |a: N, b: N| if b.magnitude() < a.magnitude() { b } else { a };
    smaller(smaller(d0 * 2.0, d1 * 2.0), parabola)
}

impl Cubic {
    pub(crate) fn position(&self, t: f64) -> f64 {
        let (since, until) = (t - self.from_s, self.to_s - t);
        if since <= until {
            self.from + self.seen_from_start().travel(greater(0.0, since))
        } else {
            self.to - self.seen_from_end().travel(greater(0.0, until))
        }
    }

    pub(crate) fn speed(&self, t: f64) -> f64 {
        let (since, until) = (t - self.from_s, self.to_s - t);
        if since <= until {
            self.seen_from_start().speed(greater(0.0, since))
        } else {
            self.seen_from_end().speed(greater(0.0, until))
        }
    }

    pub(crate) fn acceleration(&self, t: f64) -> f64 {
        let polynomial = self.seen_from_start();
        2.0 * polynomial.square + 6.0 * polynomial.cube * (t - self.from_s)
    }

    pub(crate) fn jerk(&self) -> f64 {
        6.0 * self.seen_from_start().cube
    }

    /// Time of the inflection point, where the speed has its extreme; `None` if it is outside.
    pub(crate) fn inflection_s(&self) -> Option<f64> {
        let polynomial = self.seen_from_start();
        let inflection_s = self.from_s - polynomial.square / (3.0 * polynomial.cube);
        (inflection_s > self.from_s && inflection_s < self.to_s).then_some(inflection_s)
    }

    pub(crate) fn crossing(&self, position: f64) -> Crossing {
        let travel = self.to - self.from;
        let (from_start, to_end) = (position - self.from, self.to - position);
        let mirrored_to_right = |end: FromEnd| {
            let sign = if travel < 0.0 { -1.0 } else { 1.0 };
            FromEnd { near_speed: sign * end.near_speed, square: sign * end.square, cube: sign * end.cube }
        };
        if libm::fabs(from_start) <= libm::fabs(to_end) {
            let travel = libm::fabs(from_start);
            let x = mirrored_to_right(self.seen_from_start()).time(travel, self.length_s());
            Crossing { time_s: self.from_s + x, s_per_step: x / travel }
        } else {
            let travel = libm::fabs(to_end);
            let x = mirrored_to_right(self.seen_from_end()).time(travel, self.length_s());
            Crossing { time_s: self.to_s - x, s_per_step: x / travel }
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) time_s: f64,
    /// Time from the nearer end divided by the travel from there; NaN at an end.
    pub(crate) s_per_step: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_the_inverse_of_position() {
        // Slopes at the ends in units of the mean slope, from 0 to 2.
        let parts = [0.0, 1e-12, 0.3, 1.0, 1.7, 2.0];
        for (from, to) in [(0.0, 1000.0), (7.25, 7.5), (-3.0, -1e9), (1e9, -1e9)] {
            for (first, last) in parts.iter().flat_map(|first| parts.map(|last| (*first, last))) {
                let mean = (to - from) / 0.5;
                let (from_s, to_s) = (86_000.0, 86_000.5);
                let (from_speed, to_speed) = (first * mean, last * mean);
                let cubic = Cubic { from_s, to_s, from, to, from_speed, to_speed };
                assert_eq!((cubic.crossing(from).time_s, cubic.crossing(to).time_s), (from_s, to_s));
                let mut before = from_s;
                for part in [1e-15, 1e-9, 1e-3, 0.2, 0.49, 0.5, 0.51, 0.9, 0.999, 1.0 - 1e-9] {
                    let position = from + (to - from) * part;
                    let t = cubic.crossing(position).time_s;
                    assert!(t >= before && t <= to_s, "{from} {to} {first} {last} {part}: {t}");
                    // The time has 1.5e-11 s as its last digit there.
                    let off = libm::fabs(cubic.position(t) - position);
                    let digit = (libm::fabs(mean) + 1.0) * 4e-11 + 4e-16 * libm::fabs(position);
                    assert!(off <= digit, "{from} {to} {first} {last} {part}: {off} {digit}");
                    before = t;
                }
            }
        }
    }

    #[test]
    fn loses_no_digits_next_to_a_reversal() {
        // y = 3*x^2 - 2*x^3 from its bottom: half a step of a billion is at sqrt(0.5/3e9) and a little.
        let cubic = Cubic { from_s: 0.0, to_s: 1.0, from: 0.0, to: 1e9, from_speed: 0.0, to_speed: 0.0 };
        let root = libm::sqrt(0.5 / 3e9);
        let expected = root * (1.0 + root / 3.0 + 5.0 / 18.0 * root * root);
        let found = cubic.crossing(0.5).time_s;
        assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
        // And from its top down.
        let falls = Cubic { from: 1e9, to: 0.0, ..cubic };
        assert!((1.0 - falls.crossing(0.5).time_s - expected).abs() < 1e-15);
    }

    #[test]
    fn a_straight_line_has_no_curvature() {
        let speed = 0.1 / 0.3;
        let line = Cubic { from_s: 0.1, to_s: 0.4, from: 0.2, to: 0.3, from_speed: speed, to_speed: speed };
        let mean = line.mean_speed();
        let line = Cubic { from_speed: mean, to_speed: mean, ..line };
        assert_eq!((line.acceleration(0.2), line.jerk(), line.inflection_s()), (0.0, 0.0, None));
    }
}
