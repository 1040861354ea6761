//! Greatest error of a step's time in f64, of a curve through points (DESIGN B1, B6).
//!
//! ```text
//! of times       less than 64 u of the last one, as in every planner
//! of positions   less than 16 u of the greatest; a time has what the speed v makes of it, and v*x >= y/2
//! ```
//!
//! x is the time from the nearer end, y the travel. In a smooth curve both count 1 + h/h0 + h/h1 times, as the slope at an
//! end is that of a neighbour of the length h0 or h1, too.

use crate::{
    curves::{cubic::Cubic, curve::greater},
    timing::{MAX_OFF, ROUNDING},
};
use alloc::vec::Vec;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Off {
    /// In s.
    pub(super) time_s: f64,
    /// In steps; times x/y.
    pub(super) way: f64,
}

pub(super) fn off(pieces: &[Cubic], is_smooth: bool) -> Vec<Off> {
    let last_s = pieces.last().map_or(0.0, |last| last.to_s);
    let reach = pieces.iter().fold(0.0, |most, piece| greater(most, libm::fabs(piece.to)));
    let length_s = |index: usize| pieces.get(index).map(|piece| piece.to_s - piece.from_s);
    let times = |(index, piece): (usize, &Cubic)| {
        let beside = [length_s(index.wrapping_sub(1)), length_s(index + 1)];
        let beside = beside.into_iter().flatten().filter(|_| is_smooth);
        let own_s = piece.to_s - piece.from_s;
        1.0 + beside.map(|beside_s| own_s / beside_s).sum::<f64>()
    };
    let off =
        |times: f64| Off { time_s: MAX_OFF * last_s * times, way: 2.0 * 16.0 * ROUNDING * reach * times };
    pieces.iter().enumerate().map(|piece| off(times(piece))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Holds how far pieces (length in s, end in steps) may be off: how often each counts, of a curve of `last_s`
    /// that is as far as `reach` from its start.
    fn check(pieces: &[(f64, f64)], is_smooth: bool, (last_s, reach): (f64, f64), expected: &[f64]) {
        let ((mut from_s, mut from), mut cubics) = ((0.0, 0.0), Vec::new());
        for &(length_s, to) in pieces {
            let (to_s, speed) = (from_s + length_s, (to - from) / length_s);
            cubics.push(Cubic { from_s, to_s, from, to, from_speed: speed, to_speed: speed });
            (from_s, from) = (to_s, to);
        }
        let rounding = |times: f64| Off {
            time_s: 64.0 * last_s * times / 9_007_199_254_740_992.0,
            way: 32.0 * reach * times / 9_007_199_254_740_992.0,
        };
        let expected: Vec<Off> = expected.iter().map(|times| rounding(*times)).collect();
        assert_eq!(off(&cubics, is_smooth), expected, "{pieces:?}, smooth: {is_smooth}");
    }

    #[test]
    fn straight_pieces_count_once_and_smooth_ones_as_often_as_they_have_the_lengths_beside_them() {
        let one = [(4.0, 1000.0)];
        check(&one, false, (4.0, 1000.0), &[1.0]);
        check(&one, true, (4.0, 1000.0), &[1.0]);
        // The farthest point is in the middle, to the left.
        let three = [(1.0, 3.0), (2.0, -7.5), (4.0, 6.0)];
        check(&three, false, (7.0, 7.5), &[1.0, 1.0, 1.0]);
        check(&three, true, (7.0, 7.5), &[1.0 + 0.5, 1.0 + 2.0 + 0.5, 1.0 + 2.0]);
        let uneven = [(0.25, 1.0), (8.0, 2.0), (0.5, 2.0), (0.5, 1.0)];
        check(&uneven, true, (9.25, 2.0), &[1.0 + 0.03125, 1.0 + 32.0 + 16.0, 1.0 + 0.0625 + 1.0, 2.0]);
        check(&[], true, (0.0, 0.0), &[]);
    }
}
