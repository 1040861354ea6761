//! The judge of a curve through points, times directly: a motion asks it for the few steps that f64 does not tell.

use super::*;
use crate::{
    round_half_up,
    timing::{Schedule, decided},
};

/// Curves (s, steps) of every sort: rising and falling, from rest to rest, with a turn, with bends to either side, with a
/// piece that stands, and far from the first point. No point but the first stands at a half step.
const CURVES: &[&[(f64, f64)]] = &[
    &[(0.0, 0.0), (1.0, 40.0)],
    &[(0.25, 3.0), (2.0, -37.3)],
    &[(0.0, 0.0), (1.0, 3.0), (1.5, 30.0), (1.6, 30.0), (3.0, 70.2), (3.1, 20.0), (3.7, 19.0)],
    &[(0.0, 0.0), (1.0, -30.2), (1.5, -33.0), (4.0, -70.0), (4.5, -10.9), (7.0, -8.0)],
    &[(0.0, 0.0), (1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (4.0, 16.0)],
    &[(40_000.1, 123_456.7), (40_000.4, 123_556.7), (40_000.9, 123_586.3), (40_001.0, 123_500.0)],
];

#[test]
fn a_step_is_due_after_its_time_and_not_before() {
    for points in CURVES {
        for between in [Between::Straight, Between::Smooth] {
            let curve = Points::new(points, between).unwrap();
            assert!(curve.step_count() > 15, "{points:?}");
            for (index, position, right) in curve.all_due() {
                let (piece, max_error) = (curve.pieces[index], curve.max_errors[index]);
                let crossing = piece.crossing(position);
                let error_s = max_error.time_s + max_error.travel * crossing.s_per_step;
                assert!(error_s < 1e-11 * piece.to_s, "{error_s} of {piece:?}");
                let t = Double::from(crossing.time_s);
                let times = [
                    (piece.from_s - 1.0, false),
                    (piece.from_s, false),
                    (piece.to_s, true),
                    (piece.to_s + 1.0, true),
                ];
                let times = times.map(|(t, expected)| (Double::from(t), expected));
                let near = [(t - error_s, false), (t + error_s, true)];
                for (t, expected) in times.into_iter().chain(near) {
                    let found = curve.is_past(index, position, t);
                    assert_eq!(found, expected, "{position} {right} at {t:?} {between:?} {points:?}");
                    let found = curve.is_at(index, position, t);
                    assert_eq!(found, expected, "{position} {right} by {t:?} {between:?} {points:?}");
                }
            }
        }
    }
}

#[test]
fn a_curve_that_is_at_a_position_is_not_past_it() {
    let straight = [(0.0, 0.0), (1.0, 4.0), (3.0, -4.0)];
    let smooth = [(0.0, 0.0), (2.0, 2.0), (4.0, 0.0)];
    // Points, the piece, the position and when it is there: in a piece's first half and in its second, up and down.
    let rows = [
        (&straight, Between::Straight, 0, 0.5, 0.125),
        (&straight, Between::Straight, 0, 3.5, 0.875),
        (&straight, Between::Straight, 1, 2.5, 1.375),
        (&straight, Between::Straight, 1, -3.5, 2.875),
        // Of 2*x^2*(3 - 2*x) at x = 1/4 and 3/4, of a length of 2 s.
        (&smooth, Between::Smooth, 0, 0.3125, 0.5),
        (&smooth, Between::Smooth, 0, 1.6875, 1.5),
        (&smooth, Between::Smooth, 1, 1.6875, 2.5),
        (&smooth, Between::Smooth, 1, 0.3125, 3.5),
    ];
    for (points, between, index, position, t) in rows {
        let curve = Points::new(points, between).unwrap();
        for (later, is_past, is_at) in [(-1e-27, false, false), (0.0, false, true), (1e-27, true, true)] {
            let since = Double::from(t) + later;
            let found = (curve.is_past(index, position, since), curve.is_at(index, position, since));
            assert_eq!(found, (is_past, is_at), "{position} at {t} + {later} of {between:?} {points:?}");
        }
    }
    let curve = Points::new(&straight, Between::Straight).unwrap();
    assert!(!curve.is_past(2, 0.0, 9.0.into()), "there is no third piece");
}

/// Of decimals that have no end in binary digits: 106 bits put the time a little near its edge.
#[test]
fn a_half_of_a_cycle_far_from_the_first_point_is_the_next_ones() {
    let rows = [
        ([(0.0, 0.0), (47.0, 50_809.8), (21_914.202_325, 50_808.8)], 6_607_160_698),
        ([(0.0, 0.0), (43.0, 44_285.6), (61_527.296_755, 44_284.6)], 6_191_429_676),
    ];
    for (points, expected) in rows {
        let curve = Points::new(&points, Between::Straight).unwrap();
        let (is_due_before, k) = (curve.is_due_before(1_000_000), curve.step_count());
        let found = decided(Default::default(), expected, |since| is_due_before(k, since));
        assert_eq!(found, expected, "{points:?}");
    }
}

#[test]
fn what_is_due_by_a_time_is_decided_as_f64_rounds_it() {
    for points in CURVES {
        for between in [Between::Straight, Between::Smooth] {
            let curve = Points::new(points, between).unwrap();
            let end_s = curve.pieces.last().unwrap().to_s;
            for part in 0..1000 {
                let t = end_s * f64::from(part) / 1000.0;
                let position = curve.piece(t).unwrap().position(t);
                let from_half = libm::fabs(position - libm::floor(position) - 0.5);
                if from_half < 1e-9 {
                    continue;
                }
                // So far off may it be that it is always judged.
                let found = curve.due_by(t, 1.0, |_| t.into());
                assert_eq!(found, round_half_up(position), "{position} at {t}, {between:?} {points:?}");
                // Nor does it matter from where on the steps are counted.
                for elsewhere in [0.93, 1.02] {
                    let found = curve.due_by(t * elsewhere, 1e9, |_| t.into());
                    assert_eq!(found, round_half_up(position), "{position} at {t}, {between:?} {points:?}");
                }
                // Where its digits are told to be enough, no one is times.
                let found = curve.due_by(t, 0.0, |_| panic!("{position} is no half"));
                assert_eq!(found, round_half_up(position));
            }
        }
    }
}

#[test]
fn a_half_is_due_when_it_is_reached_from_below_and_not_yet_when_it_is_left_from_above() {
    let points = [(0.0, 0.0), (4.0, 4.0), (8.0, -4.0)];
    let curve = Points::new(&points, Between::Straight).unwrap();
    // Time, what is due just before it, at it, and just after it.
    let rows = [
        (0.5, [0, 1, 1]),
        (1.5, [1, 2, 2]),
        (3.5, [3, 4, 4]),
        (4.25, [4, 4, 3]),
        (5.75, [1, 1, 0]),
        (7.75, [-3, -3, -4]),
        // No halves, and the ends.
        (1.0, [1, 1, 1]),
        (4.0, [4, 4, 4]),
        (7.0, [-2, -2, -2]),
        (8.0, [-4, -4, -4]),
    ];
    for (t, expected) in rows {
        let tie = 1e-20;
        let found = [-1e-15, 0.0, 1e-15].map(|later| {
            let since = |is_later: bool| Double::from(t) + later + if is_later { tie } else { -tie };
            curve.due_by(t, 1e-9, since)
        });
        assert_eq!(found, expected, "at {t}");
    }
}
