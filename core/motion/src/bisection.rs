//! Bisection: the first integer for which a predicate holds, and the border between two numbers. The predicate must change
//! only once. Only integers and + - * / are used, so every target gets the same bits.

/// Number of halvings. They reduce the distance by a factor of 2^60, to less than an f64 resolves unless one of the numbers is 0.
pub const HALVINGS: u32 = 60;

const MAX_FIRST: u64 = 1 << 32;

/// The first number of `from..to` for which `holds`, or `to` if there is none.
pub(crate) fn first_in(from: u64, to: u64, holds: impl Fn(u64) -> bool) -> u64 {
    let (mut from, mut to) = (from, to);
    while from < to {
        let middle = from + (to - from) / 2;
        if holds(middle) { to = middle } else { from = middle + 1 }
    }
    from
}

/// The first number from 0 on for which `holds`, below 2^32. The number of tries is logarithmic in the result.
pub(crate) fn first_from_zero(holds: impl Fn(u64) -> bool) -> u64 {
    first_near(0, MAX_FIRST, holds)
}

/// The first number of `0..end` for which `holds`, or `end`. The number of tries is logarithmic in its distance from `near`.
pub(crate) fn first_near(near: u64, end: u64, holds: impl Fn(u64) -> bool) -> u64 {
    let near = near.min(end);
    // Invariant: false before `from`, true from `to` on.
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
    first_in(from, to, holds)
}

/// The closest numbers on both sides of the border between `from`, where `holds`, and `to`, which may be less than
/// `from`, where it does not.
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
    /// Invariant: `low <= high`.
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Bracket {
    pub(crate) fn new(low: f64, high: f64) -> Self {
        debug_assert!(low <= high, "{low} to {high} contains no root");
        Self { low, high }
    }

    pub(crate) fn narrow(&mut self, x: f64, is_above: bool) {
        debug_assert!(self.low <= x && x <= self.high, "{x} is not within {self:?}");
        if is_above { self.low = x } else { self.high = x }
    }

    pub(crate) fn middle(&self) -> f64 {
        self.low + (self.high - self.low) / 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::Cell;

    #[test]
    fn finds_the_first_number_in_any_range() {
        for first in 0..=40 {
            let holds = |n: u64| n >= first;
            assert_eq!(first_from_zero(holds), first);
            for (from, to) in (0..40).flat_map(|from| (from..40).map(move |to| (from, to))) {
                assert_eq!(first_in(from, to, holds), first.clamp(from, to), "{first} of {from}..{to}");
            }
            for (near, end) in (0..50).flat_map(|near| (0..40).map(move |end| (near, end))) {
                assert_eq!(first_near(near, end, holds), first.min(end), "{first} near {near} of {end}");
            }
        }
        for first in [1 << 31, (1 << 32) - 1, 1 << 32] {
            assert_eq!(first_from_zero(|n| n >= first), first);
        }
        assert_eq!(first_from_zero(|_| false), 1 << 32, "the maximum");
    }

    #[test]
    fn finds_a_near_number_in_few_tries() {
        // First number, guess, maximum tries.
        let rows =
            [(500, 500, 2), (501, 500, 3), (499, 500, 3), (510, 500, 10), (0, 500, 20), (999, 500, 20)];
        for (first, near, max_tries) in rows {
            let tries = Cell::new(0);
            let found = first_near(near, 1000, |n| {
                tries.set(tries.get() + 1);
                n >= first
            });
            assert_eq!(found, first);
            assert!(tries.get() <= max_tries, "{first} near {near}: {} tries", tries.get());
        }
    }

    #[test]
    fn returns_both_sides_of_a_border() {
        let root = 2.0_f64.sqrt();
        let (below, above) = border(0.0, 2.0, |x| x * x <= 2.0);
        assert!(below <= root && root <= above && above - below <= 2.0 * f64::EPSILON, "{below} {above}");
        // The sides are reversed if the ends are.
        let (above, below) = border(2.0, 0.0, |x| x * x > 2.0);
        assert!(below <= root && root <= above && above - below <= 2.0 * f64::EPSILON, "{below} {above}");
        assert_eq!((border(0.0, 8.0, |_| true).1, border(0.0, 8.0, |_| false).0), (8.0, 0.0));
        let (_, above) = border(0.0, 8.0, |_| false);
        assert_eq!(above, 8.0 / (1_u64 << HALVINGS) as f64, "60 halvings");
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
