//! Searches by halving: the first whole number for which something holds, and the border between two numbers. A predicate
//! changes once, from no to yes; of several changes one is found. All of it is integers or + - * /, so every target gets
//! the same bits.
//!
//! ```
//! use stepscope_motion::bisection::border;
//!
//! let (last_that_holds, first_that_does_not) = border(0.0, 2.0, |x| x * x <= 2.0);
//! assert!(last_that_holds * last_that_holds <= 2.0);
//! assert!(first_that_does_not - last_that_holds < 1e-15);
//! ```

/// Halvings after which two numbers are no further apart than 2^-60 of what they were: less than an f64 tells apart,
/// unless one of them is 0.
pub const HALVINGS: u32 = 60;

const MAX_CLIMBED: u64 = 1 << 32;

/// The least number of `from..to` for which `holds`, or `to` where there is none; it holds for all that follow.
pub(crate) fn least(from: u64, to: u64, holds: impl Fn(u64) -> bool) -> u64 {
    let (mut from, mut to) = (from, to);
    while from < to {
        let middle = from + (to - from) / 2;
        if holds(middle) { to = middle } else { from = middle + 1 }
    }
    from
}

/// The least number from 0 on for which `holds`, in as many tries as it has digits; it holds for all that follow, and
/// for one below 2^32.
pub(crate) fn climbed(holds: impl Fn(u64) -> bool) -> u64 {
    let (mut from, mut to) = (0, 1);
    while !holds(to) && to < MAX_CLIMBED {
        (from, to) = (to, 2 * to);
    }
    least(from, to, holds)
}

/// The least number of `0..end` for which `holds`, or `end` where there is none; it holds for all that follow. Two tries
/// where it is next to `near`, two more each time that it is twice as far away.
pub(crate) fn least_near(near: u64, end: u64, holds: impl Fn(u64) -> bool) -> u64 {
    let near = near.min(end);
    // Invariant: it holds for none before `from`, and for all from `to` on.
    let (mut from, mut to, mut width) = (near, near, 1);
    while to < end && !holds(to) {
        from = to + 1;
        to = end.min(to.saturating_add(width));
        width = width.saturating_mul(2);
    }
    while from > 0 && holds(from - 1) {
        to = from - 1;
        from = from.saturating_sub(width);
        width = width.saturating_mul(2);
    }
    least(from, to, holds)
}

/// Both sides of the number between `from` and `to` (which may be the lesser) up to which `holds` and beyond which it does
/// not: the last that was tried and held, else `from`, and the first that did not, else `to`. They are [`HALVINGS`]
/// halvings apart; neither `from` nor `to` is tried.
pub fn border(from: f64, to: f64, holds: impl Fn(f64) -> bool) -> (f64, f64) {
    let (mut from, mut to) = (from, to);
    for _ in 0..HALVINGS {
        let middle = from + (to - from) / 2.0;
        if holds(middle) { from = middle } else { to = middle }
    }
    (from, to)
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Bracket {
    /// Below the root, or at it.
    ///
    /// Invariant: `low <= high`; both only come nearer.
    pub(crate) low: f64,
    /// Above the root, or at it.
    pub(crate) high: f64,
}

impl Bracket {
    pub(crate) fn new(low: f64, high: f64) -> Self {
        debug_assert!(low <= high, "{low} to {high} holds no root");
        Self { low, high }
    }

    pub(crate) fn narrow(&mut self, x: f64, is_above: bool) {
        debug_assert!(self.low <= x && x <= self.high, "{x} is not within {self:?}");
        if is_above { self.low = x } else { self.high = x }
    }

    /// Half way, where a step has left it.
    pub(crate) fn middle(&self) -> f64 {
        self.low + (self.high - self.low) / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::Cell;

    #[test]
    fn the_least_that_holds_is_found_wherever_it_is() {
        for answer in 0..=40 {
            let holds = |n: u64| n >= answer;
            assert_eq!(climbed(holds), answer);
            for (from, to) in (0..40).flat_map(|from| (from..40).map(move |to| (from, to))) {
                assert_eq!(least(from, to, holds), answer.clamp(from, to), "{answer} of {from}..{to}");
            }
            for (near, end) in (0..50).flat_map(|near| (0..40).map(move |end| (near, end))) {
                assert_eq!(least_near(near, end, holds), answer.min(end), "{answer} near {near} of {end}");
            }
        }
        for answer in [1 << 31, (1 << 32) - 1, 1 << 32] {
            assert_eq!(climbed(|n| n >= answer), answer);
        }
        assert_eq!(climbed(|_| false), 1 << 32, "it gives up");
    }

    #[test]
    fn what_is_near_is_found_in_few_tries() {
        // Answer, guess, tries at most.
        let rows =
            [(500, 500, 2), (501, 500, 3), (499, 500, 3), (510, 500, 10), (0, 500, 20), (999, 500, 20)];
        for (answer, near, most) in rows {
            let tries = Cell::new(0);
            let found = least_near(near, 1000, |n| {
                tries.set(tries.get() + 1);
                n >= answer
            });
            assert_eq!(found, answer);
            assert!(tries.get() <= most, "{answer} near {near}: {} tries", tries.get());
        }
    }

    #[test]
    fn a_border_has_its_two_sides() {
        let root = 2.0_f64.sqrt();
        let (below, above) = border(0.0, 2.0, |x| x * x <= 2.0);
        assert!(below <= root && root <= above && above - below <= 2.0 * f64::EPSILON, "{below} {above}");
        // The other way round the sides are, too.
        let (above, below) = border(2.0, 0.0, |x| x * x > 2.0);
        assert!(below <= root && root <= above && above - below <= 2.0 * f64::EPSILON, "{below} {above}");
        assert_eq!((border(0.0, 8.0, |_| true).1, border(0.0, 8.0, |_| false).0), (8.0, 0.0));
        let (_, above) = border(0.0, 8.0, |_| false);
        assert_eq!(above, 8.0 / (1_u64 << HALVINGS) as f64, "so many halvings and no more");
    }

    #[test]
    fn a_bracket_closes_from_both_sides() {
        let mut bracket = Bracket::new(1.0, 4.0);
        assert_eq!(bracket.middle(), 2.5);
        bracket.narrow(2.0, true);
        bracket.narrow(3.0, false);
        assert_eq!((bracket.low, bracket.high, bracket.middle()), (2.0, 3.0, 2.5));
    }
}
