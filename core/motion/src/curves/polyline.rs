//! The polyline that approximates a cosine (DESIGN B5, SWorldJournal issue 11): its breakpoints in a quarter, from which
//! the period follows by symmetry.
//!
//! ```text
//!  1 |-._                 y = cos(pi*i/1024), i = 0..=512, 2048 points per period
//!    |   '-._             a chord extends from its breakpoint as far as its maximum deviation
//!    |       '-._         from the cosine is at most d1
//!  0 +-----------'- 512
//! ```

use crate::{bisection::first_near, curves::curve::greater, round_half_up};
use alloc::vec::Vec;
use core::f64::consts::PI;

/// Points of the angle per period; breakpoints lie on them.
pub const POINTS: u16 = 2048;
/// Points of the angle per quarter.
pub const QUARTER: u16 = POINTS / 4;
const POINTS_PER_PI: f64 = POINTS as f64 / 2.0;
/// Equal parts of a chord at whose ends the deviation is computed.
const CHORD_PARTS: u16 = 100;
const _: () = assert!(4 * QUARTER == POINTS);

/// y = cos at a point of the angle, 0..=[`QUARTER`].
pub fn cosine_at(point: u16) -> f64 {
    // The cosine of pi/2 in f64 is not 0.
    if point == QUARTER { 0.0 } else { libm::cos(PI * f64::from(point) / POINTS_PER_PI) }
}

/// Breakpoints of a quarter, from 0 to [`QUARTER`], for the maximum deviation `d1` in units of the amplitude. A chord extends
/// to the last point at which its deviation is at most `d1`, and at least to the next point.
pub fn breakpoints(d1: f64) -> Vec<u16> {
    let mut points = Vec::from([0]);
    // Length of a chord beyond one point. The search begins at that of the previous chord, which is similar.
    let (mut from, mut extension) = (0, 0);
    while from < QUARTER {
        let next = from + 1;
        let y_from = cosine_at(from);
        let is_within = |to: u16| deviation((from, y_from), to) <= d1;
        extension = first_near(extension, (QUARTER - next).into(), |extension| {
            !is_within(next + extension as u16 + 1)
        });
        from = next + extension as u16;
        points.push(from);
    }
    points
}

/// The smallest larger `d1` with other breakpoints; `None` if there is none.
pub fn next_deviation(breakpoints: &[u16]) -> Option<f64> {
    let chords = breakpoints.iter().zip(breakpoints.iter().skip(1));
    chords
        .filter(|(_, to)| **to < QUARTER)
        .map(|(from, to)| deviation((*from, cosine_at(*from)), to + 1))
        .reduce(|min, deviation| if deviation < min { deviation } else { min })
}

/// Maximum |chord - cosine| between two points of the angle, over 101 equidistant points. It has one maximum, where the
/// cosine is parallel to the chord, so only the points next to it are computed.
fn deviation((from, y_from): (u16, f64), to: u16) -> f64 {
    let y_to = cosine_at(to);
    let length = f64::from(to - from);
    let summit = libm::asin((y_from - y_to) * POINTS_PER_PI / (PI * length)) * POINTS_PER_PI / PI;
    let nearest = round_half_up((summit - f64::from(from)) / length * f64::from(CHORD_PARTS)) as u16;
    (nearest.saturating_sub(1)..=CHORD_PARTS.min(nearest + 1))
        .fold(0.0, |max, k| greater(max, deviation_at(k, from, to, y_from, y_to)))
}

fn deviation_at(k: u16, from: u16, to: u16, y_from: f64, y_to: f64) -> f64 {
    let part = f64::from(k) / f64::from(CHORD_PARTS);
    let chord = y_from + (y_to - y_from) * part;
    let point = f64::from(from) + f64::from(to - from) * part;
    libm::fabs(chord - libm::cos(PI * point / POINTS_PER_PI))
}

pub(crate) struct Folded {
    pub(crate) point: f64,
    /// Whether the position is right of the middle.
    pub(crate) is_right: bool,
    pub(crate) goes_left: bool,
}

/// Folds a point of a period, 0..=2048, into the first quarter.
pub(crate) fn fold(point: f64) -> Folded {
    let goes_left = point < f64::from(2 * QUARTER);
    let half = if goes_left { point } else { f64::from(POINTS) - point };
    let is_right = half <= f64::from(QUARTER);
    let point = if is_right { half } else { f64::from(2 * QUARTER) - half };
    Folded { point: greater(0.0, point), is_right, goes_left }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_the_breakpoints_of_the_paper() {
        let rows: [(f64, &[u16]); 4] = [
            (0.0054, &[0, 67, 136, 208, 287, 381, 512]),
            (0.006, &[0, 71, 144, 221, 307, 413, 512]),
            (0.015, &[0, 113, 234, 381, 512]),
            (1.0, &[0, 512]),
        ];
        for (d1, expected) in rows {
            assert_eq!(breakpoints(d1), expected, "{d1}");
        }
        assert_eq!(breakpoints(0.002).len() - 1, 10);
        assert_eq!(breakpoints(0.0).len() - 1, 512);
        assert_eq!(breakpoints(f64::NAN).len() - 1, 512);
    }

    #[test]
    fn next_deviation_is_the_smallest_with_other_breakpoints() {
        for d1 in [0.002, 0.0054, 0.006, 0.015, 0.1] {
            let points = breakpoints(d1);
            let next = next_deviation(&points).expect("a chord can be longer");
            assert_eq!(breakpoints(next * (1.0 - 1e-12)), points, "{d1}");
            assert_ne!(breakpoints(next), points, "{d1}");
        }
        assert_eq!(next_deviation(&[0, 512]), None);
    }

    #[test]
    fn a_longer_chord_deviates_more() {
        for from in 0..QUARTER {
            let deviations = (from + 1..=QUARTER).map(|to| deviation((from, cosine_at(from)), to));
            assert!(deviations.is_sorted_by(|shorter, longer| shorter < longer), "from {from}");
        }
    }

    #[test]
    fn the_points_next_to_the_summit_have_the_maximum_of_every_chord() {
        for from in 0..QUARTER {
            for to in from + 1..=QUARTER {
                let (y_from, y_to) = (cosine_at(from), cosine_at(to));
                let all = (0..=CHORD_PARTS).map(|k| deviation_at(k, from, to, y_from, y_to));
                assert_eq!(deviation((from, y_from), to), all.fold(0.0, f64::max), "{from} to {to}");
            }
        }
    }
}
