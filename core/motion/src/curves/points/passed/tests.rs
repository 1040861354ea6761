//! Tests of the 106-bit decisions, which a motion needs only for the few steps that f64 does not decide.

use super::*;
use crate::{
    round_half_up,
    timing::{Schedule, decide_cycle},
};

/// Points (s, steps) of various curves: rising and falling, with a reversal, with bends to both sides, with a standstill, and
/// far from the first point. Only first points are at a half step.
const CURVES: &[&[(f64, f64)]] = &[
    &[(0.0, 0.0), (1.0, 40.0)],
    &[(0.25, 3.0), (2.0, -37.3)],
    &[(0.0, 0.0), (1.0, 3.0), (1.5, 30.0), (1.6, 30.0), (3.0, 70.2), (3.1, 20.0), (3.7, 19.0)],
    &[(0.0, 0.0), (1.0, -30.2), (1.5, -33.0), (4.0, -70.0), (4.5, -10.9), (7.0, -8.0)],
    &[(0.0, 0.0), (1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (4.0, 16.0)],
    &[(40_000.1, 123_456.7), (40_000.4, 123_556.7), (40_000.9, 123_586.3), (40_001.0, 123_500.0)],
];

#[test]
fn a_step_is_due_only_after_its_time() {
    for points in CURVES {
        for between in [Interpolation::Straight, Interpolation::Smooth] {
            let curve = Points::new(points, between).unwrap();
            assert!(curve.step_count() > 15, "{points:?}");
            for (index, position, right) in curve.all_due() {
                let (piece, max_error) = (curve.pieces[index], curve.max_errors[index]);
                let crossing = piece.crossing(position);
                let error_s = max_error.time_s + max_error.travel * crossing.s_per_step;
                assert!(error_s < 1e-11 * piece.to_s, "{error_s} of {piece:?}");
                let t = F106::from(crossing.time_s);
                let times = [
                    (piece.from_s - 1.0, false),
                    (piece.from_s, false),
                    (piece.to_s, true),
                    (piece.to_s + 1.0, true),
                ];
                let times = times.map(|(t, expected)| (F106::from(t), expected));
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
    // Points, piece, position and its time: in the first and second half of a piece, up and down.
    let rows = [
        (&straight, Interpolation::Straight, 0, 0.5, 0.125),
        (&straight, Interpolation::Straight, 0, 3.5, 0.875),
        (&straight, Interpolation::Straight, 1, 2.5, 1.375),
        (&straight, Interpolation::Straight, 1, -3.5, 2.875),
        // Of 2*x^2*(3 - 2*x) at x = 1/4 and 3/4, of a length of 2 s.
        (&smooth, Interpolation::Smooth, 0, 0.3125, 0.5),
        (&smooth, Interpolation::Smooth, 0, 1.6875, 1.5),
        (&smooth, Interpolation::Smooth, 1, 1.6875, 2.5),
        (&smooth, Interpolation::Smooth, 1, 0.3125, 3.5),
    ];
    for (points, between, index, position, t) in rows {
        let curve = Points::new(points, between).unwrap();
        for (later, is_past, is_at) in [(-1e-27, false, false), (0.0, false, true), (1e-27, true, true)] {
            let since = F106::from(t) + later;
            let found = (curve.is_past(index, position, since), curve.is_at(index, position, since));
            assert_eq!(found, (is_past, is_at), "{position} at {t} + {later} of {between:?} {points:?}");
        }
    }
    let curve = Points::new(&straight, Interpolation::Straight).unwrap();
    assert!(!curve.is_past(2, 0.0, 9.0.into()), "there is no third piece");
}

/// Decimals without an exact binary form: in 106 bits the time is slightly off its edge.
#[test]
fn a_step_at_the_middle_of_a_cycle_is_in_the_next_cycle() {
    let rows = [
        ([(0.0, 0.0), (47.0, 50_809.8), (21_914.202_325, 50_808.8)], 6_607_160_698),
        ([(0.0, 0.0), (43.0, 44_285.6), (61_527.296_755, 44_284.6)], 6_191_429_676),
    ];
    for (points, expected) in rows {
        let curve = Points::new(&points, Interpolation::Straight).unwrap();
        let (is_due_before, k) = (curve.is_due_before(1_000_000), curve.step_count());
        let found = decide_cycle(Default::default(), expected, |since| is_due_before(k, since));
        assert_eq!(found, expected, "{points:?}");
    }
}

#[test]
fn exact_decisions_agree_with_f64_away_from_halves() {
    for points in CURVES {
        for between in [Interpolation::Straight, Interpolation::Smooth] {
            let curve = Points::new(points, between).unwrap();
            let end_s = curve.pieces.last().unwrap().to_s;
            for part in 0..1000 {
                let t = end_s * f64::from(part) / 1000.0;
                let position = curve.piece_at(t).unwrap().position(t);
                let from_half = libm::fabs(position - libm::floor(position) - 0.5);
                if from_half < 1e-9 {
                    continue;
                }
                // A maximum error of 1 always requires an exact decision.
                let found = curve.due_by(t, 1.0, |_| t.into());
                assert_eq!(found, round_half_up(position), "{position} at {t}, {between:?} {points:?}");
                // The search may begin at another step.
                for elsewhere in [0.93, 1.02] {
                    let found = curve.due_by(t * elsewhere, 1e9, |_| t.into());
                    assert_eq!(found, round_half_up(position), "{position} at {t}, {between:?} {points:?}");
                }
                // Without an error in f64, no exact time is needed.
                let found = curve.due_by(t, 0.0, |_| panic!("{position} is no half"));
                assert_eq!(found, round_half_up(position));
            }
        }
    }
}

#[test]
fn a_half_counts_when_reached_from_below_but_not_when_left_from_above() {
    let points = [(0.0, 0.0), (4.0, 4.0), (8.0, -4.0)];
    let curve = Points::new(&points, Interpolation::Straight).unwrap();
    // Time, and the steps due just before it, at it, and just after it.
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
            let since = |is_later: bool| F106::from(t) + later + if is_later { tie } else { -tie };
            curve.due_by(t, 1e-9, since)
        });
        assert_eq!(found, expected, "at {t}");
    }
}
