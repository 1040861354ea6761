//! The cycle of a step, for certain (DESIGN B1): floor(t*clock_hz + 1/2), t being where the curve crosses its place.
//!
//! ```text
//!        cycle c - 1          cycle c
//! ---------+----------|----------+----------|----     | edges: whole + 1/2
//!                   [-x-]                             a time in f64, and how far it may be off
//! ```
//!
//! A time in f64 decides where no edge is as near to it as it may be off. Where one is, the edge E is judged instead of
//! the time: if the curve is past the step's place at E, the step is due before E. A curve that goes one way has no other
//! answer, so this is a proof, whatever the first time was; and it needs the curve's own formulas alone, in 106 bits
//! ([`Double`]), no roots of them.
//!
//! How far a time in f64 may be off is counted in the roundings that it is made of, u = 2^-53 each: those of its formula,
//! with `libm`'s functions taken to be within two, and those that made a number of a scenario of its decimal. The shapes
//! of this crate pass on to the time no more of an error in a place or a parameter than its own part of it: of a curve
//! that speeds up from rest s <= v*t, so a time's part of an error ds/v is at most that of the way, ds/s. Every planner
//! comes to less than 64 u of the longest of its times ([`MAX_OFF`]). What is off by more is told beside its formula.
//!
//! 106 bits have an end, too. E counts as earlier by a [`tie`], which is 2^10 times what they lose: so a step that is
//! due exactly at E, a tie, goes up as B1 has it, however its formula has rounded. A step that is due that little before
//! E, and is no tie, would go up as well; nothing proves that there is none. Were times spread evenly, it would be one in
//! 2^62 of a motion of 2^32 cycles.

use core::hint::black_box;

use crate::{
    cycle_time::{CycleTime, Quotient, tie},
    double::Double,
};

/// How far a time in f64 may be off, in parts of the longest time of its move: 64 roundings.
pub(super) const MAX_OFF: f64 = 64.0 * ROUNDING;
/// The greatest error of one rounding in parts of what is rounded, u.
pub(super) const ROUNDING: f64 = f64::EPSILON / 2.0;
/// The same in cycles, for a move that lasts no longer than one: the part of a cycle in which it starts.
const MAX_OFF_CYCLES: f64 = 4.0 * f64::EPSILON;

/// How far a time in 106 bits may be off, in cycles: far more than it is, and so little that few steps are as near to an
/// edge.
const MAX_EXACT_OFF: f64 = 1e-9;

/// 2^52 + 2^51: numbers from 2^51 below to 2^51 above are whole. A move that lasts as long has no [`Rounding::room`].
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Which cycles the steps of a move fall in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding {
    start: CycleTime,
    /// How far a time may be from the middle between two edges.
    room: f64,
    /// [`WHOLE`], but not for the compiler: browsers make a constant anew for each step.
    shift: f64,
}

impl Rounding {
    /// Of a move that begins at `start`, whose own times in cycles may be off by `off`.
    pub(super) fn new(start: CycleTime, off: f64) -> Self {
        Self { start, room: 0.5 - MAX_OFF_CYCLES - off, shift: black_box(WHOLE) }
    }

    /// Of times that may be off by so many cycles more.
    pub(super) fn less(self, off: f64) -> Self {
        Self { room: self.room - off, ..self }
    }

    /// The cycle of a step that is due `whole` and `cycles` more cycles after the move's start, be these before that whole one
    /// or after it; and how far from the cycle's own instant that is, which [`Self::is_certain`] judges.
    #[inline]
    pub(super) fn after_start(&self, whole: u64, cycles: f64) -> (u64, f64) {
        let (cycle, from_middle) = self.nearest(self.start.part.high + cycles);
        (self.start.whole.wrapping_add(whole).wrapping_add(cycle), from_middle)
    }

    /// Whether no edge is too near to a time that is so far from the middle between two edges.
    #[inline]
    pub(super) fn is_certain(&self, from_middle: f64) -> bool {
        from_middle < self.room
    }

    /// The cycle of a step that is due `whole` and `cycles` more cycles from the move's start; `is_due_before` judges that
    /// for a time from there on.
    #[inline]
    pub(super) fn cycle(&self, (whole, cycles): (u64, f64), is_due_before: impl Fn(Double) -> bool) -> u64 {
        let (past, before) = (self.start.part.high + cycles, self.start.whole.wrapping_add(whole));
        match self.certain(past) {
            Some(cycle) => before.wrapping_add(cycle),
            None => judged(self.start, before.wrapping_add(guess(past)), &is_due_before),
        }
    }

    /// floor(cycles + 1/2), where no edge is too near.
    #[inline]
    pub(super) fn certain(&self, cycles: f64) -> Option<u64> {
        let (cycle, from_middle) = self.nearest(cycles);
        self.is_certain(from_middle).then_some(cycle)
    }

    /// The nearest whole number, of a negative one what a sum that wraps makes right; and how far it is away.
    #[inline]
    fn nearest(&self, cycles: f64) -> (u64, f64) {
        // The sum has no digit after the point: it is the nearest whole number, and no conversion is needed.
        let moved = cycles + self.shift;
        (moved.to_bits().wrapping_sub(WHOLE.to_bits()), libm::fabs(cycles - (moved - self.shift)))
    }
}

/// The cycle of a step that is due so many cycles after `start`, in 106 bits; `None` where an edge is so near that
/// [`judged`] decides.
pub(super) fn exact_cycle(start: CycleTime, since: Double) -> Option<u64> {
    let CycleTime { whole, part } = start.plus(CycleTime::of(since));
    let past_edge = (part - 0.5.into()).high;
    (libm::fabs(past_edge) > MAX_EXACT_OFF).then(|| whole.wrapping_add((past_edge > 0.0).into()))
}

/// floor(cycles + 1/2), but for the last digits.
pub(super) fn guess(cycles: f64) -> u64 {
    (cycles + 0.5) as u64
}

/// The cycle of a step of a move that begins at `start`, near `guess`.
#[cold]
#[inline(never)]
pub(super) fn judged(start: CycleTime, guess: u64, is_due_before: &dyn Fn(Double) -> bool) -> u64 {
    // Whether it is due before the end of a cycle, half a cycle after it.
    let is_due_by = |cycle: u64| {
        let since = Double::from(cycle.wrapping_sub(start.whole) as i64 as f64) - start.part + 0.5.into();
        is_due_before(since - tie(cycle))
    };
    // From the guess on in strides that double until the step is between two edges, and then halved: how far off the guess
    // was decides nothing.
    let (mut not_by, mut by) = (None, None);
    let (mut cycle, mut stride) = (guess, 1);
    loop {
        if is_due_by(cycle) {
            by = Some(cycle);
            if cycle == 0 || not_by.is_some() {
                break;
            }
            cycle = cycle.saturating_sub(stride);
        } else {
            not_by = Some(cycle);
            if cycle == u64::MAX || by.is_some() {
                break;
            }
            cycle = cycle.saturating_add(stride);
        }
        stride = stride.saturating_mul(2);
    }
    let (mut below, mut above) = (not_by.map_or(0, |cycle| cycle.saturating_add(1)), by.unwrap_or(u64::MAX));
    while below < above {
        let middle = below + (above - below) / 2;
        if is_due_by(middle) { above = middle } else { below = middle.saturating_add(1) }
    }
    above
}

impl Quotient {
    /// When a step is due that is so long after `start`, as a number, and B1's cycle of it.
    #[inline]
    pub(super) fn after(self, start: CycleTime) -> (f64, u64) {
        if start.part == Double::default() { self.after_whole(start.whole) } else { self.after_part(start) }
    }

    /// The same after a start within a cycle.
    #[inline(never)]
    fn after_part(self, start: CycleTime) -> (f64, u64) {
        let own = self.part();
        let (whole, part) = (start.whole.wrapping_add(self.whole), start.part.high + own);
        let is_before = |since: Double| (since - Double::from(self.whole)).exceeds(self.time().part);
        (instant(whole, part), Rounding::new(start, 0.0).cycle((self.whole, own), is_before))
    }

    /// The same after whole cycles.
    #[inline]
    pub(super) fn after_whole(self, start: u64) -> (f64, u64) {
        (instant(start.wrapping_add(self.whole), self.part()), self.cycle_after(start))
    }

    /// Its cycle alone.
    #[inline]
    pub(super) fn cycle_after(self, start: u64) -> u64 {
        // Below 2^62, so that signed numbers hold the double: those several of which are compared at once.
        let goes_up = 2 * self.rest as i64 >= self.under as i64;
        start.wrapping_add(self.whole).wrapping_add(goes_up.into())
    }
}

/// Whole cycles and a part of two, as a number.
#[inline]
fn instant(whole: u64, part: f64) -> f64 {
    if part < 1.0 { whole as f64 + part } else { whole.wrapping_add(1) as f64 + (part - 1.0) }
}

/// Whether step `k` (from 1) of `count` is due before a time, of a move that takes `duration` and whose second half
/// mirrors its first; `is_past` tells whether the first is past a place at a time.
pub(super) fn is_due_before(
    (k, count): (u64, u64),
    time: Double,
    duration: Double,
    is_past: impl Fn(Double, f64) -> bool,
) -> bool {
    let place = k as f64 - 0.5;
    let left = count as f64 - place;
    // Either half's own formula ends with it.
    let is_second_half = time.exceeds(duration * 0.5.into());
    if place <= left {
        is_second_half || (time.is_positive() && is_past(time, place))
    } else {
        let still = duration - time;
        is_second_half && !(still.is_positive() && is_past(still, left))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(whole: u64, part: Double) -> CycleTime {
        CycleTime { whole, part }
    }

    #[test]
    fn the_judged_cycle_is_the_same_wherever_the_search_begins() {
        // When a step is due from cycle 1000 1/4 on, and its cycle.
        let rows = [
            (0.0, 1000),
            (0.2499, 1000),
            (0.25, 1001),
            (0.25 - 1e-15, 1000),
            (1.0, 1001),
            (7.25, 1008),
            (7.25 - 1e-14, 1007),
            (7.2501, 1008),
            (123_456.0, 124_456),
        ];
        let start = at(1000, 0.25.into());
        for (due, cycle) in rows {
            for guess in [cycle, 0, 1, 999, 1000, 1001, 1007, 1008, 1009, 5000, 124_455, 124_457, 1 << 40] {
                let found = judged(start, guess, &|since| since.exceeds(due.into()));
                assert_eq!(found, cycle, "{due} from {guess} on");
            }
        }
        let found = [0, 1, 1000].map(|guess| judged(at(0, 0.0.into()), guess, &|since| since.is_positive()));
        assert_eq!(found, [0; 3], "a step at the start is in its cycle");
    }

    #[test]
    fn an_exact_time_decides_unless_it_is_at_an_edge() {
        let start = at(1000, 0.25.into());
        let rows = [
            (0.0, Some(1000)),
            (0.2499, Some(1000)),
            (0.25, None),
            (0.25 - 1e-15, None),
            (0.2501, Some(1001)),
            (1.0, Some(1001)),
        ];
        for (since, expected) in rows {
            assert_eq!(exact_cycle(start, since.into()), expected, "{since}");
        }
        // Late enough that an f64 has no part of a cycle.
        let late = |part: f64| Double::sum(4_503_599_627_370_496.0 * 2.0, part);
        let found = [0.3, -0.3, 0.6].map(|part| exact_cycle(CycleTime::default(), late(part)));
        assert_eq!(found, [0, 0, 1].map(|more| Some((1 << 53) + more)));
    }

    #[test]
    fn a_time_decides_where_no_edge_is_as_near_as_it_may_be_off() {
        let rounding = Rounding::new(CycleTime::default(), 0.125);
        let rows = [
            (0.0, Some(0)),
            (0.374, Some(0)),
            (0.376, None),
            (0.5, None),
            (0.624, None),
            (0.626, Some(1)),
            (1.0, Some(1)),
            (1.374, Some(1)),
            (1_000_000.376, None),
            (1_000_000.626, Some(1_000_001)),
        ];
        for (cycles, expected) in rows {
            assert_eq!(rounding.certain(cycles), expected, "{cycles}");
            // Where it does not, whoever is asked says when the step is due.
            for (due, judged) in [(1_000_000.0, 2_000_000), (1_000_000.5, 2_000_001)] {
                let rounding = Rounding::new(at(1_000_000, 0.0.into()), 0.125);
                let found = rounding.cycle((1_000_000, cycles), |since| since.exceeds(due.into()));
                assert_eq!(found, expected.map_or(judged, |cycle| 2_000_000 + cycle), "{cycles}");
            }
        }
        // No digit of a time of no length is off, but for that of the part of a cycle in which the move begins.
        let rounding = Rounding::new(CycleTime::default(), 0.0);
        assert_eq!(
            [0.5, 0.5 - 1e-16, 0.5 - 2e-15].map(|cycles| rounding.certain(cycles)),
            [None, None, Some(0)]
        );
    }

    #[test]
    fn a_quotient_after_a_part_of_a_cycle_goes_up_where_both_make_a_half() {
        let quotient = |rest, under| Quotient { whole: 5, rest, under };
        let (sixth, less) = (Double::from(1.0) / 6.0.into(), Double::from(1e-20));
        // Quotient, the part of the cycle in which it begins; the instant and the cycle.
        let rows = [
            (quotient(1, 3), sixth, (15.5, 16)),
            (quotient(1, 3), sixth - less, (15.5, 15)),
            (quotient(1, 3), sixth + less, (15.5, 16)),
            (quotient(1, 4), 0.0.into(), (15.25, 15)),
            (quotient(2, 4), 0.0.into(), (15.5, 16)),
            (quotient(3, 4), 0.0.into(), (15.75, 16)),
            (quotient(3, 4), 0.5.into(), (16.25, 16)),
            (quotient(3, 4), 0.75.into(), (16.5, 17)),
            (quotient(3, 4), Double::from(0.75) - less, (16.5, 16)),
        ];
        for (since, part, expected) in rows {
            assert_eq!(since.after(at(10, part)), expected, "{since:?} after {part:?}");
        }
        // No digit is lost next to the start, nor of cycles that an f64 has not all.
        let small = Quotient { whole: 0, rest: 1, under: 1 << 61 };
        assert_eq!(small.after(at(0, 0.0.into())), (1.0 / (1_u64 << 61) as f64, 0));
        let late = at((1 << 53) - 4, 0.5.into());
        assert_eq!(quotient(1, 2).after(late), (9_007_199_254_740_994.0, (1 << 53) + 2));
    }
}
