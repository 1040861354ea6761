//! The times of a curve's steps, many at once: the curve's own power series, turned round.
//!
//! ```text
//!  place                            around a time t, with x the time and y the way from there:
//!    |            .-'               y = v*x + a2*x^2 + … + a10*x^10 + rest         the curve (`Expansion`)
//!    |        .-'|                  x = y/v + c2*y^2 + … + c10*y^10                the block of steps around it
//!    |    .-'    |  block           its error is what the curve makes of it, less y, divided by the least speed
//!    +-----------t--------
//! ```
//!
//! A step's time so costs a polynomial in place of a search, and the steps of a block do not wait for each other. How far a
//! block may be off is not guessed but summed: of the composition of both series all coefficients up to y^10 vanish,
//! and those after it are no more than the ones that the magnitudes of all coefficients make, together no more than their
//! sum for r*y in place of y, divided by r^11, whatever r > 1. A block is as wide as lets that be less than [`MAX_REST`].
//! To it comes what rounds: the time of the middle (`crossing`), which a block may be told anew with more digits, and less
//! than 256 u of the time from there, which are those of the terms.
//!
//! Where the curve has no series that is wide enough, as at rest, steps are searched for one by one.

use crate::{crossing::ROUNDING, curve::greater};
use alloc::boxed::Box;

/// Terms of a series.
pub(super) const TERMS: usize = 10;
/// How far the time of a step may be off for the terms after them, in cycles: 2^-20.
pub(super) const MAX_REST: f64 = 1.0 / 1_048_576.0;
/// A term that is no more than this at the ends of its block is none.
const NO_TERM: f64 = MAX_REST / 16.0;
/// The least steps of a block, below which a search for each is as quick.
const LEAST: u64 = 16;
/// The most: in one not much longer than its own forming takes, fewer terms tell.
const MOST: f64 = 4096.0;
/// How often a block is tried narrower before its steps are searched for.
const TRIES: u32 = 8;

/// A curve around one of its places, to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Expansion {
    /// When it is there, in s.
    pub(super) time_s: f64,
    /// The way in steps is the sum of `terms[n]*x^(n + 1)`, x being the time from there in s; the first, the speed, is
    /// above 0 but at rest.
    pub(super) terms: [f64; TERMS],
    /// The way is off from that by at most so much times |x|^(TERMS + 1).
    pub(super) rest: f64,
    /// That holds up to so long before and after, in s.
    pub(super) reach_s: f64,
}

impl Expansion {
    /// At one speed.
    pub(super) fn straight(time_s: f64, speed: f64) -> Self {
        Self::polynomial(time_s, [speed, 0.0, 0.0, 0.0])
    }

    /// With no more terms than these.
    pub(super) fn polynomial(time_s: f64, given: [f64; 4]) -> Self {
        let mut terms = [0.0; TERMS];
        for (term, given) in terms.iter_mut().zip(given) {
            *term = given;
        }
        Self { time_s, terms, rest: 0.0, reach_s: f64::INFINITY }
    }

    /// The same curve looked at from the end: of a move of so long whose second half mirrors its first.
    pub(super) fn mirrored(self, duration_s: f64) -> Self {
        let mut terms = self.terms;
        for even in terms.iter_mut().skip(1).step_by(2) {
            *even = -*even;
        }
        Self { time_s: duration_s - self.time_s, terms, ..self }
    }
}

/// A curve that has power series, each in its stretch.
pub(super) trait Series {
    /// From which place to which one formula holds around a place, in steps travelled.
    fn stretch(&self, place: f64) -> (f64, f64);
    /// The curve around a place.
    fn expansion(&self, place: f64) -> Expansion;
    /// When it is at a place, in s, searched for.
    fn search_s(&self, place: f64) -> f64;
}

/// Some steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Times {
    /// The first step, from 0.
    pub(super) first: u64,
    pub(super) len: usize,
    /// What their block tells; where there is none each has to be searched for.
    pub(super) of_block: Option<OfBlock>,
}

/// What is common to the times that a block tells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OfBlock {
    /// From where on the times count.
    pub(super) time: MiddleTime,
    /// How far they may be off from that, in cycles.
    pub(super) off: f64,
    /// The least speed of the curve there, in steps/s.
    pub(super) least_speed: f64,
}

/// When a curve is in the middle of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MiddleTime {
    /// Whole cycles, from which on the block's times count.
    pub(super) whole: u64,
    /// The part of a cycle; its last digits are those of f64 for the whole time, unless it is exact.
    pub(super) part: f64,
    /// Whether it is off by no more than [`MAX_REST`].
    pub(super) is_exact: bool,
}

/// Times of so many steps at once: what is done once for all of them costs little by then, and they are 2 kB.
pub(super) const BLOCK: usize = 256;

/// Steps after which a block's places are formed anew: a place that is no half and a count may have a rounding as a sum.
const COUNTED_ON: usize = 64;

/// 0, 1, 2, … as numbers to be read: counting takes browsers longer.
pub(super) static COUNTED: [f64; BLOCK] = {
    let (mut counted, mut next) = ([0.0; BLOCK], 1);
    while next < BLOCK {
        counted[next] = counted[next - 1] + 1.0;
        next += 1;
    }
    counted
};

/// The times of steps at `first`, `first + 1`, … of a curve, in cycles.
pub(super) struct BySeries<'c> {
    curve: Box<dyn Series + 'c>,
    clock: f64,
    first: f64,
    count: u64,
    next: u64,
    /// Half the width of the block that is tried next, in steps.
    width: f64,
    /// Up to which step (not included) the block tells; those of none are searched for.
    until: u64,
    block: Option<Block>,
}

impl<'c> BySeries<'c> {
    pub(super) fn new(curve: Box<dyn Series + 'c>, clock: f64, first: f64, count: u64) -> Self {
        Self { curve, clock, first, count, next: 0, width: LEAST as f64, until: 0, block: None }
    }

    /// The place of a step (from 0).
    fn place(&self, step: u64) -> f64 {
        self.first + step as f64
    }

    /// When a step (from 0) is due, searched for.
    pub(super) fn searched(&self, step: u64) -> f64 {
        self.curve.search_s(self.place(step)) * self.clock
    }

    /// Writes the times of the next steps, where a block tells them, and says which they are. None at the end.
    ///
    /// `exactly` may tell of a step (from 0) near a time when it is due, with more digits.
    pub(super) fn times(
        &mut self,
        times: &mut [f64; BLOCK],
        exactly: &dyn Fn(u64, MiddleTime) -> Option<MiddleTime>,
    ) -> Option<Times> {
        if self.next >= self.until {
            if self.next >= self.count {
                return None;
            }
            self.begin();
            if let Some(block) = &mut self.block {
                let middle = self.next + (self.until - self.next) / 2;
                block.time = exactly(middle, block.time).unwrap_or(block.time);
            }
        }
        let len = (self.until - self.next).min(BLOCK as u64) as usize;
        let first = self.next;
        self.next += len as u64;
        let of_block = self.block.as_ref().map(|block| {
            let parts = times.get_mut(..len).unwrap_or_default().chunks_mut(COUNTED_ON);
            for (step, part) in (first..).step_by(COUNTED_ON).zip(parts) {
                block.times(self.place(step), part);
            }
            OfBlock { time: block.time, off: block.off, least_speed: block.least_speed }
        });
        Some(Times { first, len, of_block })
    }

    /// Begins a block at the next step, as wide as may be.
    #[inline(never)]
    fn begin(&mut self) {
        let from = self.place(self.next);
        let (_, to) = self.curve.stretch(from);
        let left = (self.count - self.next).min(((to - from) as u64).saturating_add(1));
        self.block = None;
        for _ in 0..TRIES {
            let steps =
                left.min(2 * (if self.width < MOST / 2.0 { self.width } else { MOST / 2.0 }) as u64 + 1);
            let steps = steps - u64::from(steps.is_multiple_of(2));
            if steps < LEAST {
                break;
            }
            let half = (steps - 1) as f64 / 2.0;
            let middle = from + half;
            let (block, rest) = Block::new(&self.curve.expansion(middle), middle, half, self.clock);
            let fits = rest <= MAX_REST;
            self.width = half * widening(rest);
            if fits {
                self.until = self.next + steps;
                self.block = Some(block);
                return;
            }
        }
        self.width = greater(self.width, LEAST as f64);
        self.until = self.next + left.min(LEAST);
    }
}

/// How much wider than one with such a rest a block may be: a rest is that of the width's power of `TERMS + 1`.
fn widening(rest: f64) -> f64 {
    /// 1.2^11.
    const A_STEP: f64 = 7.43;
    let (mut factor, mut rest) = (1.0, rest);
    while rest > MAX_REST && factor > 0.2 {
        (factor, rest) = (factor / 1.2, rest / A_STEP);
    }
    if factor < 1.0 {
        return factor;
    }
    while rest * A_STEP <= MAX_REST && factor < 4.0 {
        (factor, rest) = (factor * 1.2, rest * A_STEP);
    }
    factor
}

/// Steps around a place.
struct Block {
    middle: f64,
    /// A step is at u = (place - middle)*per_step, -1 to 1.
    per_step: f64,
    time: MiddleTime,
    /// The time from there is the sum of `terms[n]*u^(n + 1)`, in cycles.
    terms: [f64; TERMS],
    /// How many of them tell.
    count: usize,
    off: f64,
    /// In steps/s.
    least_speed: f64,
}

impl Block {
    /// Up to `half` steps before and after `middle`; and how far off the terms left out are at most, in cycles.
    fn new(curve: &Expansion, middle: f64, half: f64, clock: f64) -> (Self, f64) {
        let speed = curve.terms[0];
        // In parts of `half` steps, and of the time that they take at the speed in the middle.
        let unit_s = half / speed;
        let mut own = [1.0; TERMS];
        let mut scale = 1.0 / speed;
        for (own, term) in own.iter_mut().zip(curve.terms) {
            *own = term * scale;
            scale *= unit_s;
        }
        let beyond = curve.rest * scale;
        let turned = turned(&own);
        let cycles = unit_s * clock;
        let (rest, slope) = rest(&own, beyond, &turned, curve.reach_s / unit_s);
        let (rest, least_speed) = (rest * cycles, slope * speed);
        let terms = turned.map(|term| term * cycles);
        let count = terms.iter().rposition(|term| libm::fabs(*term) > NO_TERM).map_or(0, |last| last + 1);
        let off =
            MAX_REST + NO_TERM * (TERMS - count) as f64 + 256.0 * ROUNDING * sum_of_magnitudes(&terms, 1.0);
        let (per_step, cycles) = (1.0 / half, curve.time_s * clock);
        let time = MiddleTime { whole: cycles as u64, part: cycles - libm::floor(cycles), is_exact: false };
        (Self { middle, per_step, time, terms, count, off, least_speed }, rest)
    }

    /// The times of steps from a place on.
    fn times(&self, from: f64, times: &mut [f64]) {
        match self.count {
            0..=2 => self.by_terms::<2>(from, times),
            3..=4 => self.by_terms::<4>(from, times),
            5..=6 => self.by_terms::<6>(from, times),
            7..=8 => self.by_terms::<8>(from, times),
            _ => self.by_terms::<TERMS>(from, times),
        }
    }

    /// By so many terms: their number is the compiler's, so that several steps at a time go through all of them in
    /// registers. Those that do not tell are 0, which changes no sum.
    fn by_terms<const N: usize>(&self, from: f64, times: &mut [f64]) {
        let terms: [f64; N] =
            core::array::from_fn(|n| if n < self.count { self.terms[n % TERMS] } else { 0.0 });
        for (index, time) in COUNTED.iter().zip(times) {
            let along = (from + index - self.middle) * self.per_step;
            let sum = terms.iter().rev().fold(0.0, |sum, term| (sum + term) * along);
            *time = sum + self.time.part;
        }
    }
}

/// The inverse of a series that begins with 1: of each power of it the coefficients, from those of the power before.
fn turned(own: &[f64; TERMS]) -> [f64; TERMS] {
    let mut powers = [[0.0; TERMS]; TERMS];
    powers[0][0] = 1.0;
    for n in 1..TERMS {
        let mut next = 0.0;
        for m in 1..=n {
            // Of the power m + 1 the coefficient of y^(n + 1).
            let mut sum = 0.0;
            for j in 0..=n - m {
                sum += powers[0][j] * powers[m - 1][n - 1 - j];
            }
            powers[m][n] = sum;
            next -= own[m] * sum;
        }
        powers[0][n] = next;
    }
    powers[0]
}

/// The sum of |terms[n]|*x^(n + 1).
fn sum_of_magnitudes(terms: &[f64; TERMS], x: f64) -> f64 {
    terms.iter().rev().fold(0.0, |sum, term| (sum + libm::fabs(*term)) * x)
}

/// How far the inverse of a series is off at most for the terms that it has not, from -1 to 1; infinite where that cannot be
/// told; and the least speed there. The series itself is off by `beyond` of |x|^(TERMS + 1), up to `reach`.
fn rest(own: &[f64; TERMS], beyond: f64, turned: &[f64; TERMS], reach: f64) -> (f64, f64) {
    // Over all of the block, and what its own error may add.
    let farthest = sum_of_magnitudes(turned, 1.0) * 1.01;
    let power = |x: f64| (0..TERMS).fold(x, |power, _| power * x);
    // The least speed there, in parts of that in the middle.
    let mut slope = 1.0;
    let mut x = 1.0;
    for (n, term) in (2_u32..).zip(own.iter().skip(1)) {
        x *= farthest;
        slope -= f64::from(n) * libm::fabs(*term) * x;
    }
    // Of the rest's own slope no more than its bound on twice the way tells (Cauchy).
    slope -= 2.0 * power(2.0 * farthest) * beyond / farthest;
    let holds = slope > 0.25 && 2.0 * farthest <= reach;
    if !holds {
        return (f64::INFINITY, 0.0);
    }
    let is_straight = own.iter().skip(1).all(|term| *term == 0.0) && beyond == 0.0;
    if is_straight {
        return (0.0, slope);
    }
    let mut least = f64::INFINITY;
    for r in [1.5, 2.0, 3.0, 4.5, 7.0, 11.0, 18.0, 30.0, 60.0, 200.0] {
        let after = sum_of_magnitudes(own, sum_of_magnitudes(turned, r)) / power(r);
        if after < least {
            least = after;
        }
    }
    let rest = (least + beyond * power(farthest)) / slope;
    // No further than what was added.
    (if rest <= 0.009 * farthest { rest } else { f64::INFINITY }, slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Curve,
        cosine::Cosine,
        jerk_limited::{JerkLimited, Limits},
        ramp::Ramp,
        ramps::Ramps,
    };

    #[test]
    fn a_series_turned_round_undoes_it() {
        // y = x/(1 - x) and x = y/(1 + y); y = e^x - 1 and x = ln(1 + y).
        let found = turned(&[1.0; TERMS]);
        for (n, term) in found.iter().enumerate() {
            assert_eq!(*term, if n % 2 == 0 { 1.0 } else { -1.0 });
        }
        let (mut exponential, mut factorial) = ([1.0; TERMS], 1.0);
        for (n, term) in (1_u8..).zip(&mut exponential) {
            factorial *= f64::from(n);
            *term = 1.0 / factorial;
        }
        for (n, term) in turned(&exponential).iter().enumerate() {
            let expected = if n % 2 == 0 { 1.0 } else { -1.0 } / (n + 1) as f64;
            assert!((term - expected).abs() < 1e-13, "{n}: {term} {expected}");
        }
    }

    #[test]
    fn the_least_speed_of_a_block_has_what_is_not_in_the_series() {
        let mut straight = [0.0; TERMS];
        straight[0] = 1.0;
        let farthest: f64 = 1.01;
        // Of the speed in the middle, 2*(2*farthest)^(TERMS + 1)*beyond/farthest is taken: a half.
        let beyond = 0.25 * farthest / libm::pow(2.0 * farthest, (TERMS + 1) as f64);
        let (_, slope) = rest(&straight, beyond, &straight, 3.0);
        assert!((slope - 0.5).abs() < 1e-9, "{slope}");
        // A quarter is too little, and so is a way that is told for less than twice the block.
        let mut bent = straight;
        bent[1] = 0.375 / farthest;
        assert_eq!(1.0 - 2.0 * bent[1] * farthest, 0.25);
        assert_eq!(rest(&bent, 0.0, &straight, 3.0), (f64::INFINITY, 0.0));
        assert_eq!(rest(&straight, beyond, &straight, 2.0), (f64::INFINITY, 0.0));
        bent[1] = 0.374 / farthest;
        assert!(rest(&bent, 0.0, &straight, 3.0).1 > 0.25);
    }

    /// Holds the times of all steps to those that are searched for, and tells how many of them a block told.
    fn check(curve: &(impl Series + Curve + Copy), what: &str) -> u64 {
        let (count, clock) = (curve.steps().unsigned_abs(), 16e6);
        let mut by_series = BySeries::new(Box::new(*curve), clock, 0.5, count);
        let (mut times, mut told, mut next) = ([0.0; BLOCK], 0, 0);
        while let Some(Times { first, len, of_block }) = by_series.times(&mut times, &|_, _| None) {
            assert_eq!(first, next, "{what}");
            next += len as u64;
            let Some(OfBlock { time, off, least_speed }) = of_block else { continue };
            told += len as u64;
            for (step, time_in_block) in (first..).zip(times).take(len) {
                let (found, expected) = (time.whole as f64 + time_in_block, by_series.searched(step));
                let most = off + 64.0 * ROUNDING * curve.duration_s() * clock;
                assert!((found - expected).abs() <= most, "step {step} of {what}: {found} {expected}, {off}");
                let speed = libm::fabs(curve.speed(expected / clock));
                assert!(speed * (1.0 + 1e-9) >= least_speed, "step {step} of {what}: {speed} {least_speed}");
            }
        }
        assert_eq!(next, count, "{what}");
        told
    }

    #[test]
    fn the_times_of_a_block_are_those_that_a_search_finds() {
        for steps in [1, 2, 15, 16, 33, 1000, -20_000] {
            let whole: u64 = [0.0, 0.01, 0.25, 0.5]
                .iter()
                .map(|part| {
                    let cosine =
                        check(&Cosine::new(steps, 2.0, 2.0 * part), &format!("a cosine, {steps} {part}"));
                    let shapes = [Ramp::Straight, Ramp::Bezier, Ramp::sigmoid(6.0), Ramp::exponential(4.0)];
                    let ramps = shapes.map(|shape| {
                        check(
                            &Ramps::new(steps, 2.0, 2.0 * part, shape),
                            &format!("{shape:?}, {steps} {part}"),
                        )
                    });
                    cosine + ramps.iter().sum::<u64>()
                })
                .sum();
            let limits = |acceleration, jerk| Limits { speed: 20_000.0, acceleration, jerk };
            let jerk_limited: u64 = [(1e6, 1e9), (1e5, 1e6), (1e4, 1e4)]
                .map(|(acceleration, jerk)| {
                    let curve = JerkLimited::new(steps, limits(acceleration, jerk));
                    check(&curve, &format!("{steps} with a jerk of {jerk}"))
                })
                .iter()
                .sum();
            // Nearly all of them, where there are many.
            let most = steps.unsigned_abs();
            assert!(
                most < 20_000 || (whole > most * 19 && jerk_limited > most * 28 / 10),
                "{whole} {jerk_limited}"
            );
        }
    }

    #[test]
    fn a_series_that_does_not_hold_far_enough_makes_no_block() {
        let expansion = Expansion { reach_s: 1e-3, ..Expansion::polynomial(1.0, [1000.0, 10.0, 0.0, 0.0]) };
        let rest = |half: f64| Block::new(&expansion, 500.0, half, 16e6).1;
        assert!(rest(0.4) <= MAX_REST && rest(0.6).is_infinite(), "{} {}", rest(0.4), rest(0.6));
        // Nor one at rest.
        let at_rest = Expansion::polynomial(1.0, [0.0, 10.0, 0.0, 0.0]);
        assert!(Block::new(&at_rest, 500.0, 16.0, 16e6).1.is_infinite());
    }
}
