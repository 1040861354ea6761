//! Whether a curve through points has passed a position at a time, in 106 bits (DESIGN B1, B6).

use super::{Between, Points};
use crate::{
    curves::cubic::{Cubic, slope_between},
    timing::{Double, Number},
};

/// Relative error of a position in 106 bits and of what follows from it: 2^-98.
const MAX_EXACT_ERROR: f64 = f64::EPSILON * f64::EPSILON * 64.0;

impl Points {
    /// Whether piece `index` has passed `position`, which lies in it, before `t` in s.
    pub(super) fn is_past(&self, index: usize, position: f64, t: Double) -> bool {
        self.is_beyond(index, position, t, MAX_EXACT_ERROR)
    }

    /// Whether piece `index` is at or past `position` by `t` in s.
    fn is_at(&self, index: usize, position: f64, t: Double) -> bool {
        self.is_beyond(index, position, t, -MAX_EXACT_ERROR)
    }

    fn is_beyond(&self, index: usize, position: f64, t: Double, error: f64) -> bool {
        let Some(piece) = self.exact_piece(index) else { return false };
        let (behind, ahead) =
            ((Double::from(position) - piece.from).magnitude(), (piece.to - position).magnitude());
        // The error depends on the distance from the first point, however short the piece is.
        let error = Double::from((libm::fabs(piece.from.high) + libm::fabs(piece.to.high)) * error);
        if behind < ahead {
            let x = t - piece.from_s;
            let has_passed =
                x >= piece.length_s() || piece.seen_from_start().travel(x).magnitude() > behind + error;
            x > 0.0.into() && has_passed
        } else {
            let x = piece.to_s - t;
            let is_left =
                x >= piece.length_s() || piece.seen_from_end().travel(x).magnitude() > ahead - error;
            !(x > 0.0.into() && is_left)
        }
    }

    fn exact_piece(&self, index: usize) -> Option<Cubic<Double>> {
        let &[(from_s, from), (to_s, to)] = self.exact.get(index..index + 2)? else { return None };
        let [from_speed, to_speed] = match self.between {
            Between::Straight => [(to - from) / (to_s - from_s); 2],
            Between::Smooth => [self.slope(index), self.slope(index + 1)],
        };
        Some(Cubic { from_s, to_s, from, to, from_speed, to_speed })
    }

    /// The steps due by a time, near `t`, whose position in f64 has an error of at most `max_error`. `since` is the time in
    /// s, a tie later or earlier: a half that is met there is reached from below, and not yet left from above.
    pub(crate) fn due_by(&self, t: f64, max_error: f64, since: impl Fn(bool) -> Double) -> i64 {
        let past = self.piece(t).map_or(0.0, |piece| piece.position(t)) + 0.5;
        let near = libm::floor(past + 0.5);
        if libm::fabs(past - near) > max_error {
            return libm::floor(past) as i64;
        }
        let (later, earlier) = (since(true), since(false));
        let index = self.exact.partition_point(|(from_s, _)| *from_s <= later).saturating_sub(1);
        let Some(index) = index.checked_sub(usize::from(index + 1 == self.exact.len())) else { return 0 };
        let Some(&[(_, from), (_, to)]) = self.exact.get(index..index + 2) else { return 0 };
        // Whether the position is at least half a step below `whole`.
        let has = |whole: i64| {
            let half = whole as f64 - 0.5;
            let is_under = |end: Double| Double::from(half) <= end;
            match (is_under(from), is_under(to)) {
                (true, true) => true,
                (false, false) => false,
                (false, true) => self.is_at(index, half, later),
                (true, false) => !self.is_past(index, half, earlier),
            }
        };
        let mut due = near as i64;
        while !has(due) {
            due -= 1;
        }
        while has(due + 1) {
            due += 1;
        }
        due
    }

    fn slope(&self, index: usize) -> Double {
        let line = |index: usize| match self.exact.get(index..index.wrapping_add(2)) {
            Some(&[(from_s, from), (to_s, to)]) => Some((to_s - from_s, (to - from) / (to_s - from_s))),
            _ => None,
        };
        let lines = line(index.wrapping_sub(1)).zip(line(index));
        lines.map_or_else(Double::default, |(before, after)| slope_between(before, after))
    }
}

#[cfg(test)]
mod tests;
