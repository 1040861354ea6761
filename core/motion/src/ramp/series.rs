//! The shapes of a ramp as power series, around a time in it (`series`).

use super::{Exponential, Ramp, Sigmoid};
use crate::series::TERMS;
use core::f64::consts::{E, FRAC_PI_2};

/// A shape around a time x, all in parts of the ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShapeSeries {
    /// g is the sum of `speed[n]*d^n`, d being the time from there.
    pub(crate) speed: [f64; TERMS],
    /// Its integral is off from that of the sum by at most so much times |d|^(TERMS + 1).
    pub(crate) rest: f64,
    /// That holds up to so long before and after, also for imaginary times.
    pub(crate) reach: f64,
}

impl Ramp {
    pub(crate) fn series(&self, x: f64) -> ShapeSeries {
        let polynomial = |terms: [f64; 4]| {
            let mut speed = [0.0; TERMS];
            for (speed, term) in speed.iter_mut().zip(terms) {
                *speed = term;
            }
            ShapeSeries { speed, rest: 0.0, reach: f64::INFINITY }
        };
        match self {
            Self::Straight => polynomial([x, 1.0, 0.0, 0.0]),
            Self::Bezier => polynomial([self.speed(x), 6.0 * x * (1.0 - x), 3.0 - 6.0 * x, -2.0]),
            Self::Exponential(curve) => curve.series(x, self.speed(x)),
            Self::Sigmoid(curve) => curve.series(x),
        }
    }
}

impl Exponential {
    /// Each derivative is the one before times -k; within 1/k the exponential grows to e times itself at most.
    fn series(&self, x: f64, now: f64) -> ShapeSeries {
        let mut speed = [now; TERMS];
        let mut term = -libm::exp(-self.constants * x) / self.part;
        for (n, speed) in (1_u8..).zip(speed.iter_mut().skip(1)) {
            term *= -self.constants / f64::from(n);
            *speed = term;
        }
        let next = self.constants / TERMS as f64;
        let rest = E * libm::fabs(term) * next / (TERMS + 1) as f64;
        ShapeSeries { speed, rest, reach: 1.0 / self.constants }
    }
}

impl Sigmoid {
    /// S' = S*(1 - S), term by term. Within pi/2 of a real u, S is no more than 1 and than e^(Re u): the real part of e^-u
    /// is not below 0 there. So the terms fall as those of a geometric series (Cauchy), and half as far the rest of it is
    /// no more than twice its first.
    fn series(&self, x: f64) -> ShapeSeries {
        let (u, scale) = (self.range * (2.0 * x - 1.0), 2.0 * self.range);
        let small = libm::exp(-libm::fabs(u));
        let all = 1.0 + small;
        // 1 - 2*S.
        let falling = if u > 0.0 { small - 1.0 } else { 1.0 - small } / all;
        let mut terms = [0.0; TERMS];
        terms[1] = scale * small / (all * all);
        for n in 1..TERMS - 1 {
            let products: f64 = (1..n).map(|i| terms[i] * terms[n - i]).sum();
            terms[n + 1] = scale * (falling * terms[n] - products) / (n + 1) as f64;
        }
        let mut speed = terms.map(|term| term / self.part);
        speed[0] = self.speed(x);
        let radius = FRAC_PI_2 / scale;
        let most = libm::exp(u + FRAC_PI_2);
        let most = if most < 1.0 { most } else { 1.0 } / self.part;
        let power = (0..TERMS).fold(1.0, |power, _| power / radius);
        ShapeSeries { speed, rest: 2.0 * most * power / (TERMS + 1) as f64, reach: radius / 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_the_shape_around_its_time() {
        let shapes = [Ramp::Straight, Ramp::Bezier]
            .into_iter()
            .chain([0.1, 1.0, 6.0, 20.0].map(Ramp::sigmoid))
            .chain([0.1, 1.0, 6.0, 20.0].map(Ramp::exponential));
        for shape in shapes {
            for i in 1..40 {
                let x = f64::from(i) / 40.0;
                let found = shape.series(x);
                let reach = if found.reach < 0.2 { found.reach } else { 0.2 };
                for part in [-1.0, -0.5, -0.1, 0.1, 0.5, 1.0] {
                    let d = reach * part;
                    if !(0.0..=1.0).contains(&(x + d)) {
                        continue;
                    }
                    let made =
                        (1..=TERMS).rev().fold(0.0, |sum, n| (sum + found.speed[n - 1] / n as f64) * d);
                    let expected = shape.travel(x + d) - shape.travel(x);
                    let power = (0..TERMS).fold(libm::fabs(d), |power, _| power * libm::fabs(d));
                    let most = found.rest * power + 1e-13 * libm::fabs(d);
                    assert!(libm::fabs(made - expected) <= most, "{shape:?} {x} {d}: {made} {expected}");
                    // The bound is one that tells something.
                    assert!(found.rest * power <= 2e-2 * found.speed[0] || x < 0.2, "{shape:?} {x} {d}");
                }
            }
        }
    }
}
