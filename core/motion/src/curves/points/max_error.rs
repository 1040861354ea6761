//! Maximum error of a step's time in f64, of a curve through points (DESIGN B1, B6).
//!
//! ```text
//! of times       below 64 u of the last one, as in every planner
//! of positions   below 16 u of the largest; divided by the speed v it is an error of time, and v*x >= y/2
//! ```
//!
//! x is the time from the nearer end, y the travel. In a smooth curve both errors are multiplied by 1 + h/h0 + h/h1, because
//! the slope at an end also depends on the neighbor of length h0 or h1.

use crate::curves::{cubic::Cubic, curve::greater};
use crate::timing::{MAX_ERROR, ROUNDING};
use alloc::vec::Vec;

/// The maximum error of a step's time is `time_s` + `travel`*x/y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MaxError {
    pub(super) time_s: f64,
    pub(super) travel: f64,
}

pub(super) fn max_errors(pieces: &[Cubic], is_smooth: bool) -> Vec<MaxError> {
    let last_s = pieces.last().map_or(0.0, |last| last.to_s);
    let max_distance = pieces.iter().fold(0.0, |max, piece| greater(max, libm::fabs(piece.to)));
    let length_s = |index: usize| pieces.get(index).map(|piece| piece.to_s - piece.from_s);
    let factor = |(index, piece): (usize, &Cubic)| {
        let neighbors = [length_s(index.wrapping_sub(1)), length_s(index + 1)];
        let neighbors = neighbors.into_iter().flatten().filter(|_| is_smooth);
        let own_s = piece.to_s - piece.from_s;
        1.0 + neighbors.map(|neighbor_s| own_s / neighbor_s).sum::<f64>()
    };
    let max_error = |factor: f64| MaxError {
        time_s: MAX_ERROR * last_s * factor,
        travel: 2.0 * 16.0 * ROUNDING * max_distance * factor,
    };
    pieces.iter().enumerate().map(|piece| max_error(factor(piece))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the errors of pieces (length in s, end in steps) with factors of those of the whole curve.
    fn check(pieces: &[(f64, f64)], is_smooth: bool, (last_s, max_distance): (f64, f64), expected: &[f64]) {
        let ((mut from_s, mut from), mut cubics) = ((0.0, 0.0), Vec::new());
        for &(length_s, to) in pieces {
            let (to_s, speed) = (from_s + length_s, (to - from) / length_s);
            cubics.push(Cubic { from_s, to_s, from, to, from_speed: speed, to_speed: speed });
            (from_s, from) = (to_s, to);
        }
        let rounding = |times: f64| MaxError {
            time_s: 64.0 * last_s * times / 9_007_199_254_740_992.0,
            travel: 32.0 * max_distance * times / 9_007_199_254_740_992.0,
        };
        let expected: Vec<MaxError> = expected.iter().map(|times| rounding(*times)).collect();
        assert_eq!(max_errors(&cubics, is_smooth), expected, "{pieces:?}, smooth: {is_smooth}");
    }

    #[test]
    fn errors_of_smooth_pieces_grow_with_the_ratio_to_their_neighbors() {
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
