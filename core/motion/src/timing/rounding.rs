//! The cycle of a step (DESIGN B1): floor(t*clock_hz + 1/2), where the curve crosses the step's position at t.
//!
//! ```text
//!        cycle c - 1          cycle c
//! ---------+----------|----------+----------|----     | edges: whole + 1/2
//!                   [-x-]                             a time in f64 and its maximum error
//! ```
//!
//! A time in f64 decides unless an edge is within its error. Otherwise the curve decides in 106 bits ([`F106`]): the step
//! is due before an edge E if the curve has passed the step's position at E. That needs the curve's formula but no root, and
//! it is exact however wrong the f64 was.
//!
//! The error of a time in f64 is counted in roundings of its formula, u = 2^-53 each; `libm`'s functions count as two. A
//! curve from rest has s <= v*t, so the relative error of a position or parameter is at least that of the time. The error of
//! every curve is below 64 u of its move's duration ([`MAX_ERROR`]), or the curve has its own bound.
//!
//! 106 bits have an error, too. E counts as earlier by a [`tie`], 2^10 times this error, so that a step due exactly at E is in
//! the next cycle. So is a step due less than a tie before E: one step in 2^62 of a motion of 2^32 cycles.

use crate::timing::cycle_time::{CycleTime, tie};
use crate::{bisection::first_near, timing::double::F106};

/// Maximum error of a time in f64, relative to the duration of its move: 64 roundings.
pub(crate) const MAX_ERROR: f64 = 64.0 * ROUNDING;
/// Maximum relative error of one rounding, u.
pub(crate) const ROUNDING: f64 = f64::EPSILON / 2.0;

/// Whether a step (from 1) is due before a time in cycles from its move's start.
pub(crate) type IsDueBefore<'p> = alloc::boxed::Box<dyn Fn(u64, F106) -> bool + 'p>;

/// The cycle of a step of a move that begins at `start`. `is_due_before` decides for a time since the start; `guess` only
/// affects the duration of the search.
pub(crate) fn decide_cycle(start: CycleTime, guess: u64, is_due_before: impl Fn(F106) -> bool) -> u64 {
    first_near(guess, u64::MAX, |cycle| {
        // The edge at the end of the cycle, half a cycle after it.
        let since = F106::from(cycle.wrapping_sub(start.whole) as i64 as f64) - start.part + 0.5;
        is_due_before(since - tie(cycle))
    })
}

/// Whether step `k` (from 1) of `count` is due before a time, in a move of `duration` whose second half mirrors its first;
/// `is_past` returns whether the first half has passed a position at a time.
pub(crate) fn is_mirrored_due_before(
    (k, count): (u64, u64),
    time: F106,
    duration: F106,
    is_past: impl Fn(F106, f64) -> bool,
) -> bool {
    let position = k as f64 - 0.5;
    let steps_left = count as f64 - position;
    let is_second_half = time > duration * 0.5;
    if position <= steps_left {
        is_second_half || (time > 0.0.into() && is_past(time, position))
    } else {
        let time_left = duration - time;
        is_second_half && !(time_left > 0.0.into() && is_past(time_left, steps_left))
    }
}

/// How many of `count` steps, step k at k - 1/2, are due at a position whose error is at most `max_error`; `is_due` decides
/// for a step within the error.
pub(crate) fn due_near(position: f64, count: u64, max_error: f64, is_due: impl Fn(u64) -> bool) -> u64 {
    let raised = position + 0.5;
    let k = (raised + 0.5) as u64;
    if libm::fabs(raised - k as f64) > max_error || k == 0 || k > count {
        return (raised as u64).min(count);
    }
    k - u64::from(!is_due(k))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(whole: u64, part: F106) -> CycleTime {
        CycleTime { whole, part }
    }

    #[test]
    fn the_guess_does_not_change_the_cycle() {
        // Time of a step since cycle 1000 1/4, and its cycle.
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
                let found = decide_cycle(start, guess, |since| since > due.into());
                assert_eq!(found, cycle, "{due} from {guess} on");
            }
        }
        let found =
            [0, 1, 1000].map(|guess| decide_cycle(at(0, 0.0.into()), guess, |since| since > 0.0.into()));
        assert_eq!(found, [0; 3], "a step at the start is in the cycle of the start");
    }
}
