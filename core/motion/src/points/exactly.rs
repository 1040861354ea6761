//! Whether a curve through points is past a step's place at a time, in 106 bits (DESIGN B1, B6): by the cubic of its piece,
//! from the nearer end (`hermite`), whose slopes are formed anew of the points beside it.

use super::{Between, Points};
use crate::double::Double;

/// What 106 bits lose of a position, and what is formed of it, in parts of it: 2^-98.
const UNTOLD: f64 = f64::EPSILON * f64::EPSILON * 64.0;

fn less(a: Double, b: Double) -> bool {
    b.exceeds(a)
}

fn magnitude(a: Double) -> Double {
    if less(a, Double::default()) { Double::default() - a } else { a }
}

impl Points {
    /// Whether piece `index` is past `place`, which lies in it, before `t` in s.
    pub(super) fn is_past(&self, index: usize, place: f64, t: Double) -> bool {
        self.is_beyond(index, place, t, UNTOLD)
    }

    /// Whether piece `index` is past `place` or at it, by `t` in s.
    fn is_at(&self, index: usize, place: f64, t: Double) -> bool {
        self.is_beyond(index, place, t, -UNTOLD)
    }

    /// Whether it is past `place` by more than `untold` in parts of a position, or less than that short of it.
    fn is_beyond(&self, index: usize, place: f64, t: Double, untold: f64) -> bool {
        let Some(&[(from_s, from), (to_s, to)]) = self.exact.get(index..index + 2) else { return false };
        let (mean, length) = ((to - from) / (to_s - from_s), to_s - from_s);
        let [first, last] = match self.between {
            Between::Straight => [mean, mean],
            Between::Smooth => [self.slope(index), self.slope(index + 1)],
        };
        let (behind, ahead) = (magnitude(Double::from(place) - from), magnitude(to - place.into()));
        // The digits of a position end with those of the way from the first point, however short a step's own way is.
        let untold = Double::from((libm::fabs(from.high) + libm::fabs(to.high)) * untold);
        // Whether it has made more than a travel in a time from one end, of the slopes there and at the other.
        let has_made = |x: Double, travel: Double, [near, far]: [Double; 2]| {
            let (near_less, far_less) = (mean - near, mean - far);
            let square = (near_less * 2.0.into() + far_less) / length;
            let cube = (near_less + far_less) / (length * length);
            let made = (near + (square - cube * x) * x) * x;
            x.is_positive() && (!less(x, length) || magnitude(made).exceeds(travel))
        };
        if less(behind, ahead) {
            has_made(t - from_s, behind + untold, [first, last])
        } else {
            !has_made(to_s - t, ahead - untold, [last, first])
        }
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
        let index = self.exact.partition_point(|(from_s, _)| !from_s.exceeds(later)).saturating_sub(1);
        let Some(index) = index.checked_sub(usize::from(index + 1 == self.exact.len())) else { return 0 };
        let Some(&[(_, from), (_, to)]) = self.exact.get(index..index + 2) else { return 0 };
        // Whether the position is no less than the half below a whole one.
        let has = |whole: i64| {
            let half = whole as f64 - 0.5;
            let is_under = |end: Double| !Double::from(half).exceeds(end);
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

    /// Steffen's slope at a point.
    fn slope(&self, index: usize) -> Double {
        let mean = |index: usize| match self.exact.get(index..index.wrapping_add(2)) {
            Some(&[(from_s, from), (to_s, to)]) => Some(((to - from) / (to_s - from_s), to_s - from_s)),
            _ => None,
        };
        let none = Double::default();
        let (Some((d0, h0)), Some((d1, h1))) = (mean(index.wrapping_sub(1)), mean(index)) else {
            return none;
        };
        if !(d0 * d1).is_positive() {
            return none;
        }
        let least = |a: Double, b: Double| if less(magnitude(b), magnitude(a)) { b } else { a };
        least(least(d0, d1) * 2.0.into(), (d0 * h1 + d1 * h0) / (h0 + h1))
    }
}

#[cfg(test)]
mod tests;
