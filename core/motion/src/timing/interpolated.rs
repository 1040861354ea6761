//! Times of steps on a curve whose equation is slow to solve (DESIGN B1): it is solved for a few steps of a block, and a
//! polynomial through them approximates the others.
//!
//! ```text
//!  time |            .-'     x = (step - middle)/half, -1 to 1
//!       |        .-'         t = c0 + c1*T1(x) + … + c7*T7(x)       T: Chebyshev's polynomials
//!       |   o-'--o--o-o
//!       +---------------     c: from the times at the roots of T8; for an analytic curve they decrease geometrically,
//!           a block's steps     so a block is narrow enough if the last two are small
//! ```
//!
//! Solving for every step would take 40 to 80 times as long as a square root; with blocks a step takes one to two times as
//! long. A block ends where the curve's formula changes. Near a point of rest, where the time is a root of the distance and
//! blocks would be short, each step is solved.

use crate::curves::curve::greater;
use crate::timing::run::{Run, Runs, Schedule, Times, fill_times};
use alloc::{boxed::Box, vec::Vec};
use core::f64::consts::PI;

const NODES: usize = 8;
/// Minimum steps of a block; in shorter ones each step is solved.
const MIN_STEPS: f64 = 4.0 * NODES as f64;
const MAX_STEPS: f64 = 4096.0;
/// Maximum error in cycles of the polynomial itself.
const MAX_TRUNCATION: f64 = 1.0 / 131_072.0;
/// The last two coefficients of a block are at most its error divided by this. The missing ones change a time by at most twice
/// their sum, less than 16 times the last two if each pair is at most 8/9 of the previous one; they decrease much faster.
const SAFETY: f64 = 16.0;
/// Growth of the nodes' errors between the nodes: Lebesgue's constant is 2.3, and sums have roundings.
const GROWTH: f64 = 4.0;

pub(crate) struct Interpolated<F> {
    /// The time of a step in cycles, and its maximum error.
    time: F,
    count: u64,
    /// Positions at which the formula changes, rising.
    changes: Vec<f64>,
    /// cos(pi*k*(2i + 1)/(2*NODES)): Chebyshev's polynomial k at node i.
    chebyshev_at_nodes: [[f64; NODES]; NODES],
    width: f64,
    block: Option<Block>,
    /// First step after the block.
    until: f64,
}

impl<F: Fn(f64) -> (f64, f64)> Interpolated<F> {
    pub(crate) fn new(count: u64, changes: Vec<f64>, time: F) -> Self {
        let cosine = |k: usize, i: usize| libm::cos(PI * (k * (2 * i + 1)) as f64 / (2 * NODES) as f64);
        let chebyshev_at_nodes = core::array::from_fn(|k| core::array::from_fn(|i| cosine(k, i)));
        Self { time, count, changes, chebyshev_at_nodes, width: MIN_STEPS, block: None, until: 0.0 }
    }

    /// Begins a block at step `first`, as wide as its error allows.
    fn begin_block(&mut self, first: f64) {
        // Step `first` is at position `first` + 1/2.
        let ends = self.changes.iter().map(|change| change - 0.5);
        let end = ends.into_iter().find(|end| *end > first).unwrap_or(f64::INFINITY);
        let end = libm::fmin(end, self.count as f64 - 1.0);
        loop {
            let last = libm::floor(libm::fmin(first + self.width, end));
            self.until = last + 1.0;
            self.block = None;
            if self.until - first < MIN_STEPS {
                self.width = MIN_STEPS;
                return;
            }
            let (block, last_terms) = self.fit_block(first, last);
            let max = (MAX_TRUNCATION + block.max_error) / SAFETY;
            if last_terms <= max {
                if last_terms < max / 1000.0 {
                    self.width = libm::fmin(2.0 * self.width, MAX_STEPS);
                }
                self.block = Some(Block { max_error: GROWTH * block.max_error + MAX_TRUNCATION, ..block });
                return;
            }
            self.width = (last - first) / 1.5;
        }
    }

    /// The polynomial through the steps from `first` to `last`, and the sum of its last two coefficients, because one may
    /// be 0 by symmetry.
    fn fit_block(&self, first: f64, last: f64) -> (Block, f64) {
        let (middle, half) = ((first + last) / 2.0, (last - first) / 2.0);
        let (at_middle, mut max_error) = (self.time)(middle);
        let times = self.chebyshev_at_nodes[1].map(|x| {
            let (time, own_error) = (self.time)(middle + half * x);
            max_error = greater(max_error, own_error);
            time - at_middle
        });
        let terms = self.chebyshev_at_nodes.map(|chebyshev| {
            let products = chebyshev.iter().zip(&times).map(|(at_node, time)| at_node * time);
            products.sum::<f64>() * 2.0 / NODES as f64
        });
        let mut powers = powers_of(terms);
        powers[0] += at_middle;
        let last_terms = libm::fabs(terms[NODES - 2]) + libm::fabs(terms[NODES - 1]);
        (Block { middle, per_step: 1.0 / half, powers, max_error }, last_terms)
    }
}

/// Converts c0/2 + c1*T1(x) + … to coefficients of powers of x, by T_(k + 1) = 2*x*T_k - T_(k - 1), T_0 = 1 and T_1 = x.
fn powers_of(terms: [f64; NODES]) -> [f64; NODES] {
    let (mut previous, mut polynomial, mut powers) = ([0.0; NODES], [0.0; NODES], [0.0; NODES]);
    polynomial[0] = 1.0;
    for (k, term) in terms.into_iter().enumerate() {
        let term = if k == 0 { term / 2.0 } else { term };
        for (power, coefficient) in powers.iter_mut().zip(polynomial) {
            *power += term * coefficient;
        }
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let next = core::array::from_fn(|n| {
            let times_x = if n == 0 { 0.0 } else { factor * polynomial[n - 1] };
            times_x - if k == 0 { 0.0 } else { previous[n] }
        });
        (previous, polynomial) = (polynomial, next);
    }
    powers
}

#[derive(Clone, Copy)]
struct Block {
    middle: f64,
    per_step: f64,
    /// Coefficients of the powers of x, in cycles.
    powers: [f64; NODES],
    max_error: f64,
}

impl Block {
    fn time(&self, step: f64) -> f64 {
        let x = (step - self.middle) * self.per_step;
        self.powers.iter().rev().fold(0.0, |sum, power| sum * x + power)
    }
}

impl<F: Fn(f64) -> (f64, f64)> Times for Interpolated<F> {
    fn fill(&mut self, first: f64, times: &mut [f64]) -> f64 {
        let (mut step, mut times, mut max_error) = (first, times, 0.0);
        while !times.is_empty() {
            if step >= self.until {
                self.begin_block(step);
            }
            let (block_times, later_times) =
                times.split_at_mut(times.len().min((self.until - step) as usize));
            let len = block_times.len();
            if let Some(block) = self.block {
                fill_times(step, block_times, |step| block.time(step));
                max_error = greater(max_error, block.max_error);
            } else {
                for (index, time) in (0_i32..).zip(block_times) {
                    let (solved, own_error) = (self.time)(step + f64::from(index));
                    (*time, max_error) = (solved, greater(max_error, own_error));
                }
            }
            (step, times) = (step + len as f64, later_times);
        }
        max_error
    }
}

/// The single run of a curve whose equation for the time is slow to solve; its formula changes at the positions `changes`,
/// in steps without sign.
pub(crate) fn one_searched_run(curve: &impl Schedule, clock_hz: u32, changes: Vec<f64>) -> Runs<'_> {
    let clock = f64::from(clock_hz);
    let count = curve.steps().unsigned_abs();
    let max_error = curve.max_error_s() * clock;
    let times = Interpolated::new(count, changes, move |step| (curve.time_s(step + 0.5) * clock, max_error));
    Box::new(core::iter::once(Run { count, right: curve.steps() >= 0, times: Box::new(times) }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        curves::cosine::Cosine,
        curves::jerk_limited::{JerkLimited, Limits},
        curves::ramp::Ramp,
        curves::ramps::Ramps,
        timing::run::Schedule,
    };
    use core::cell::Cell;

    /// Compares a curve's times with solved ones; returns how many were solved per step.
    fn check(curve: &impl Schedule, changes: Vec<f64>, name: &str) -> f64 {
        let (count, clock, solved) = (curve.steps().unsigned_abs(), 16e6, Cell::new(0));
        let time = |step: f64| {
            solved.set(solved.get() + 1);
            (curve.time_s(step + 0.5) * clock, curve.max_error_s() * clock)
        };
        let mut times = Interpolated::new(count, changes, time);
        let mut found = vec![0.0; count as usize];
        for (block, found) in found.chunks_mut(177).enumerate() {
            let max_error = times.fill(177.0 * block as f64, found);
            for (index, found) in found.iter().enumerate() {
                let step = 177 * block + index;
                let expected = curve.time_s(step as f64 + 0.5) * clock;
                assert!((found - expected).abs() <= max_error, "step {step} of {name}: {found} {expected}");
            }
        }
        f64::from(solved.get()) / count as f64
    }

    #[test]
    fn interpolates_most_times_within_the_error() {
        for steps in [1, 2, 15, 39, 40, 41, 668, -100_000] {
            let mut solved = Vec::new();
            for part in [0.0, 0.002, 0.01, 0.25, 0.5] {
                let cosine = Cosine::new(steps, 2.0, 2.0 * part);
                solved.push(check(&cosine, cosine.changes(), &format!("a cosine, {steps} {part}")));
                let shapes = [Ramp::Straight, Ramp::Bezier, Ramp::sigmoid(6.0), Ramp::exponential(4.0)];
                for shape in shapes {
                    let curve = Ramps::new(steps, 2.0, 2.0 * part, shape);
                    solved.push(check(&curve, curve.changes(), &format!("{shape:?}, {steps} {part}")));
                }
            }
            for (acceleration, jerk) in [(1e6, 1e9), (1e5, 1e6), (1e4, 1e4)] {
                let curve = JerkLimited::new(steps, Limits { speed: 20_000.0, acceleration, jerk });
                solved.push(check(&curve, curve.changes(), &format!("{steps} with a jerk of {jerk}")));
            }
            let is_few = solved.iter().all(|solved| *solved < 0.1);
            assert!(is_few || steps.abs() < 100_000, "{steps}: {solved:?}");
        }
    }
}
