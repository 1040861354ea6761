//! Whether a curve through points is past a position at a time, in 106 bits (DESIGN B1, B6).

use super::{Between, Points};
use crate::{
    curves::cubic::{Cubic, slope_between},
    timing::{Double, Number},
};

/// What 106 bits lose of a position, and what is formed of it, in parts of it: 2^-98.
const UNTOLD: f64 = f64::EPSILON * f64::EPSILON * 64.0;

impl Points {
    /// Whether piece `index` is past `place`, which lies in it, before `t` in s.
    pub(super) fn is_past(&self, index: usize, place: f64, t: Double) -> bool {
        self.is_beyond(index, place, t, UNTOLD)
    }

    /// Whether piece `index` is past `place` or at it, by `t` in s.
    fn is_at(&self, index: usize, place: f64, t: Double) -> bool {
        self.is_beyond(index, place, t, -UNTOLD)
    }

    fn is_beyond(&self, index: usize, place: f64, t: Double, untold: f64) -> bool {
        let Some(piece) = self.exact_piece(index) else { return false };
        let (behind, ahead) =
            ((Double::from(place) - piece.from).magnitude(), (piece.to - place).magnitude());
        // The digits of a position end with those of the way from the first point, however short a step's own way is.
        let untold = Double::from((libm::fabs(piece.from.high) + libm::fabs(piece.to.high)) * untold);
        if behind < ahead {
            let x = t - piece.from_s;
            let has_made =
                x >= piece.length_s() || piece.seen_from_start().travel(x).magnitude() > behind + untold;
            x > 0.0.into() && has_made
        } else {
            let x = piece.to_s - t;
            let is_left =
                x >= piece.length_s() || piece.seen_from_end().travel(x).magnitude() > ahead - untold;
            !(x > 0.0.into() && is_left)
        }
    }

    /// Piece `index` with all its digits.
    fn exact_piece(&self, index: usize) -> Option<Cubic<Double>> {
        let &[(from_s, from), (to_s, to)] = self.exact.get(index..index + 2)? else { return None };
        let [from_speed, to_speed] = match self.between {
            Between::Straight => [(to - from) / (to_s - from_s); 2],
            Between::Smooth => [self.slope(index), self.slope(index + 1)],
        };
        Some(Cubic { from_s, to_s, from, to, from_speed, to_speed })
    }

    /// B1's rounding of the position at a time, near `t`, no nearer to its place in f64 than `off`; `since` is the time in s,
    /// a tie later or earlier: a half that is met in it is reached from below, and not yet left from above.
    pub(crate) fn due_by(&self, t: f64, off: f64, since: impl Fn(bool) -> Double) -> i64 {
        let past = self.piece(t).map_or(0.0, |piece| piece.position(t)) + 0.5;
        let near = libm::floor(past + 0.5);
        if libm::fabs(past - near) > off {
            return libm::floor(past) as i64;
        }
        let (later, earlier) = (since(true), since(false));
        let index = self.exact.partition_point(|(from_s, _)| *from_s <= later).saturating_sub(1);
        let Some(index) = index.checked_sub(usize::from(index + 1 == self.exact.len())) else { return 0 };
        let Some(&[(_, from), (_, to)]) = self.exact.get(index..index + 2) else { return 0 };
        // Whether the position is no less than the half below a whole one.
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
