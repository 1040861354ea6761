//! When a curve through points is past a step's place, in 106 bits, and how far a time in f64 may be off (DESIGN B1, B6).
//!
//! Each time is that of a cubic from its nearer end (`hermite`), x after the travel y. In f64 there are roundings of two
//! kinds, u = 2^-53 each, and both count 1 + h/h0 + h/h1 times in a smooth curve, as a slope at an end is that of a
//! neighbour, of the length h0 or h1, too:
//!
//! ```text
//! of times       less than 64 u of the last one, as in every planner
//! of positions   less than 16 u of the greatest; a time has what the speed v makes of it, and v*x >= y/2
//! ```
//!
//! The last holds where the slopes at both ends are 0 to 2 times the mean one, as they are; and where y itself is no more
//! than that error, x is no less than the time that it makes.

use super::{Between, Points};
use crate::{
    crossing::{MAX_OFF, ROUNDING},
    curve::greater,
    double::Double,
    hermite::Cubic,
};
use alloc::vec::Vec;

/// A point: its time in s and its position in steps, both from the first.
pub(crate) type Point = (Double, Double);

/// How far times of a piece may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Off {
    /// In s.
    pub(super) time_s: f64,
    /// In steps; times x/y.
    pub(super) way: f64,
}

/// How far the times of each piece may be off.
pub(super) fn off(pieces: &[Cubic], between: Between) -> Vec<Off> {
    let last_s = pieces.last().map_or(0.0, |last| last.to_s);
    let reach = pieces.iter().fold(0.0, |most, piece| greater(most, libm::fabs(piece.to)));
    let length_s = |index: usize| pieces.get(index).map(|piece| piece.to_s - piece.from_s);
    let times = |(index, piece): (usize, &Cubic)| {
        let beside = match between {
            Between::Straight => [None, None],
            Between::Smooth => [length_s(index.wrapping_sub(1)), length_s(index + 1)],
        };
        let own_s = piece.to_s - piece.from_s;
        1.0 + beside.into_iter().flatten().map(|beside_s| own_s / beside_s).sum::<f64>()
    };
    let off =
        |times: f64| Off { time_s: MAX_OFF * last_s * times, way: 2.0 * 16.0 * ROUNDING * reach * times };
    pieces.iter().enumerate().map(|piece| off(times(piece))).collect()
}

fn less(a: Double, b: Double) -> bool {
    b.exceeds(a)
}

fn magnitude(a: Double) -> Double {
    if less(a, Double::default()) { Double::default() - a } else { a }
}

impl Points {
    /// Whether piece `index` is past `place`, which lies in it, before `t` in s.
    pub(super) fn is_past(&self, index: usize, place: f64, t: Double) -> bool {
        let Some(&[(from_s, from), (to_s, to)]) = self.exact.get(index..index + 2) else { return false };
        let (mean, length) = ((to - from) / (to_s - from_s), to_s - from_s);
        let [first, last] = match self.between {
            Between::Straight => [mean, mean],
            Between::Smooth => [self.slope(index), self.slope(index + 1)],
        };
        let (behind, ahead) = (magnitude(Double::from(place) - from), magnitude(to - place.into()));
        // Whether it has made more than a travel in a time from one end, of the slopes there and at the other.
        let has_made = |x: Double, travel: Double, [near, far]: [Double; 2]| {
            let (near_less, far_less) = (mean - near, mean - far);
            let square = (near_less * 2.0.into() + far_less) / length;
            let cube = (near_less + far_less) / (length * length);
            let made = (near + (square - cube * x) * x) * x;
            x.is_positive() && (!less(x, length) || magnitude(made).exceeds(travel))
        };
        if less(behind, ahead) {
            has_made(t - from_s, behind, [first, last])
        } else {
            !has_made(to_s - t, ahead, [last, first])
        }
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
