//! Whether a curve through points has passed a position at a time, in 106 bits (DESIGN B1, B6).

use super::{Point, Points};
use crate::curves::cubic::{Cubic, slope_between};
use crate::moves::Interpolation;
use crate::timing::{F106, Number};

/// Relative error of a position in 106 bits and of what follows from it: 2^-98.
const MAX_EXACT_ERROR: f64 = f64::EPSILON * f64::EPSILON * 64.0;

impl Points {
    pub(super) fn is_past(&self, index: usize, position: f64, t: F106) -> bool {
        self.is_beyond(index, position, t, MAX_EXACT_ERROR)
    }

    fn is_at(&self, index: usize, position: f64, t: F106) -> bool {
        self.is_beyond(index, position, t, -MAX_EXACT_ERROR)
    }

    fn is_beyond(&self, index: usize, position: f64, t: F106, error: f64) -> bool {
        let Some(piece) = self.exact_piece(index) else { return false };
        let (from_start, to_end) =
            ((F106::from(position) - piece.from).magnitude(), (piece.to - position).magnitude());
        // The error depends on the distance from the first point, however short the piece is.
        let error = F106::from((libm::fabs(piece.from.high) + libm::fabs(piece.to.high)) * error);
        if from_start < to_end {
            let x = t - piece.from_s;
            let has_passed =
                x >= piece.length_s() || piece.seen_from_start().travel(x).magnitude() > from_start + error;
            x > 0.0.into() && has_passed
        } else {
            let x = piece.to_s - t;
            let is_before =
                x >= piece.length_s() || piece.seen_from_end().travel(x).magnitude() > to_end - error;
            !(x > 0.0.into() && is_before)
        }
    }

    fn exact_piece(&self, index: usize) -> Option<Cubic<F106>> {
        let &[Point { time_s: from_s, position: from }, Point { time_s: to_s, position: to }] =
            self.exact.get(index..index + 2)?
        else {
            return None;
        };
        let [from_speed, to_speed] = match self.interpolation {
            Interpolation::Straight => [(to - from) / (to_s - from_s); 2],
            Interpolation::Smooth => [self.slope(index), self.slope(index + 1)],
        };
        Some(Cubic { from_s, to_s, from, to, from_speed, to_speed })
    }

    /// Number of steps due by `t` s; the position there in f64 has an error of at most `max_error`. `exact_time` returns `t` a
    /// tie later (true) or earlier (false): a half-integer at `t` is reached from below, but not yet left from above.
    pub(crate) fn due_by(&self, t: f64, max_error: f64, exact_time: impl Fn(bool) -> F106) -> i64 {
        let raised = self.piece_at(t).map_or(0.0, |piece| piece.position(t)) + 0.5;
        let nearest = libm::floor(raised + 0.5);
        if libm::fabs(raised - nearest) > max_error {
            return libm::floor(raised) as i64;
        }
        let (later, earlier) = (exact_time(true), exact_time(false));
        let index = self.exact.partition_point(|point| point.time_s <= later).saturating_sub(1);
        let Some(index) = index.checked_sub(usize::from(index + 1 == self.exact.len())) else { return 0 };
        let Some([start, end]) = self.exact.get(index..index + 2) else { return 0 };
        // Whether the position is at least k - 1/2.
        let reaches = |k: i64| {
            let half = k as f64 - 0.5;
            let is_at_or_above = |point: &Point| F106::from(half) <= point.position;
            match (is_at_or_above(start), is_at_or_above(end)) {
                (true, true) => true,
                (false, false) => false,
                (false, true) => self.is_at(index, half, later),
                (true, false) => !self.is_past(index, half, earlier),
            }
        };
        let mut due = nearest as i64;
        while !reaches(due) {
            due -= 1;
        }
        while reaches(due + 1) {
            due += 1;
        }
        due
    }

    /// Slope at a point; 0 at the first and the last.
    fn slope(&self, index: usize) -> F106 {
        let line = |index: usize| match self.exact.get(index..index.wrapping_add(2)) {
            Some([start, end]) => {
                let length_s = end.time_s - start.time_s;
                Some((length_s, (end.position - start.position) / length_s))
            }
            _ => None,
        };
        let lines = line(index.wrapping_sub(1)).zip(line(index));
        lines.map_or_else(F106::default, |(before, after)| slope_between(before, after))
    }
}

#[cfg(test)]
mod tests;
