//! Moves of which every step is decided in 106 bits: at 4 GHz, f64 does not distinguish cycles after hours. So this tests the
//! deciding formulas over the whole move.

use crate::{
    by_rows, by_segments, by_slices,
    fixed::whole,
    ideal::{self, Ideal},
    plan_of,
};
use std::cmp::Ordering;
use stepscope_motion::{
    Profile,
    mechanics::{Acceleration, Distance, Jerk, Speed},
    moves::{
        Cosine, CosineMethod, Interpolation, JerkLimited, Move, Point, PointUnit, Points, RampShape, Ramps,
        ShortMove, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
    },
};

const CLOCK_HZ: u32 = 4_000_000_000;
const DAY_S: f64 = 86_400.0;
/// Number of compared steps at the start, in the middle and at the end of a longer move.
const MAX_PER_PART: u64 = 100;

/// Compares the steps of a move with an ideal, which may use its plan; times have up to `roundings` rounding errors.
fn check_planned(given: &Move, roundings: f64, ideal: impl FnOnce(&Profile) -> Ideal) {
    let plan = plan_of(vec![given.clone()]).unwrap_or_else(|| panic!("{given:?} cannot be planned"));
    let profile = &plan.moves()[0].profile;
    let off = roundings * f64::EPSILON / 2.0 * profile.duration_s() * f64::from(CLOCK_HZ);
    assert!(off > 0.5, "some steps are decided in f64: off by {off} of {given:?}");
    let (ideal, clock, count) = (ideal(profile), whole(CLOCK_HZ.into()), profile.step_count());
    let first = MAX_PER_PART.min(count);
    let last = (count - first + 1).max(first + 1);
    let between = (first + 1..last).step_by((count / MAX_PER_PART) as usize + 1);
    for k in (1..=first).chain(between).chain(last..=count) {
        let cycle = profile.step_cycle(k, CLOCK_HZ).expect("a step has a cycle");
        let at = |halves: i64| {
            (ideal.compare)(k, &(whole(2 * cycle as i64 + halves) / (whole(2) * clock.clone())))
        };
        let (before, after) = (at(-1), at(1));
        assert!(
            before != Ordering::Greater && after == Ordering::Greater,
            "step {k} is not in {cycle}: {before:?} {after:?} of {given:?}"
        );
    }
}

fn check(given: Move, ideal: Ideal) {
    check_planned(&given, 64.0, |_| ideal);
}

fn steps(count: i64) -> Distance {
    Distance::Steps(count as f64)
}

#[test]
fn every_step_of_a_sine_is_in_its_exact_cycle() {
    for (amplitude, period_s, periods) in [(1, DAY_S, 1), (-2, 20_000.3, 3), (51, 12_345.678_9, 5)] {
        let given = Sine { amplitude: steps(amplitude), period_s, periods };
        check(Move::Sine(given), ideal::sine(amplitude, period_s, periods));
    }
}

/// Ramps relative to the duration: none, half, and short ones.
const MOVES: [(i64, f64, f64); 6] = [
    (1, DAY_S, 43_200.0),
    (-2, 80_000.1, 20_000.3),
    (77, DAY_S, 0.0),
    (78, 60_000.3, 1.7),
    (-111, DAY_S, 40_000.0),
    (1001, 85_000.7, 42_500.35),
];

#[test]
fn every_step_of_a_cosine_is_in_its_exact_cycle() {
    for (count, duration_s, ramp_s) in MOVES {
        let given = Cosine { distance: steps(count), duration_s, ramp_s, ..Cosine::default() };
        check(Move::Cosine(given), ideal::cosine(count, duration_s, ramp_s));
    }
}

#[test]
fn every_step_of_ramps_is_in_its_exact_cycle() {
    let with = |shape, parameters: &'static [f64]| parameters.iter().map(move |each| (shape, *each));
    let shapes = with(RampShape::Bezier, &[1.0])
        .chain(with(RampShape::Straight, &[1.0]))
        .chain(with(RampShape::Exponential, &[0.1, 1.3, 4.0, 20.0]))
        .chain(with(RampShape::Sigmoid, &[0.1, 1.3, 6.0, 20.0]));
    for (shape, parameter) in shapes {
        // Logarithms of 320 bits are slow.
        let slow = shape == RampShape::Sigmoid;
        let moves = MOVES.into_iter().filter(|(count, ..)| count.abs() < if slow { 100 } else { 1000 });
        for (count, duration_s, ramp_s) in moves {
            let count = if slow { count.clamp(-9, 9) } else { count };
            let ramps = Ramps::shaped(shape, parameter);
            let given = Ramps { distance: steps(count), duration_s, ramp_s, ..ramps };
            let ideal = ideal::ramps((count, duration_s, ramp_s), ideal::shape(shape, parameter));
            check(Move::Ramps(given), ideal);
        }
    }
}

#[test]
fn every_step_of_a_trapezoid_is_in_its_exact_cycle() {
    let rows = [
        // With a plateau, from a start speed and from rest; a single speed; triangles.
        (200, 0.000_7, 0.003_3, 1e-6),
        (-201, 0.0, 0.003, 1e-6),
        (-60, 0.001, 0.001, 1e-3),
        (1001, 0.003, 10.0, 1.7e-6),
        (300, 0.0, 10.0, 1e-6),
        (401, 0.000_001, 0.014, 1e-6),
    ];
    for (count, start, top, acceleration) in rows {
        let given = Trapezoid {
            distance: steps(count),
            start_speed: Some(Speed::StepsPerSecond(start)),
            max_speed: Speed::StepsPerSecond(top),
            max_acceleration: Acceleration::StepsPerSecond2(acceleration),
            method: TrapezoidMethod::Exact,
            timer_hz: 1,
            ..Trapezoid::default()
        };
        check(Move::Trapezoid(given), ideal::trapezoid(count, start, top, acceleration));
    }
}

#[test]
fn every_step_of_a_jerk_limited_move_is_in_its_exact_cycle() {
    let rows = [
        // The four rows of the planner's table, and two with almost no jerk phases.
        (500_000, 32.0, 0.004, 1e-6),
        (-200_001, 16.0, 0.1, 1e-6),
        (300_000, 32.0, 0.004, 1e-6),
        (200_000, 32.0, 0.1, 1e-6),
        (-301, 10.0, 1e-6, 1e-3),
        (1, 2e-5, 1e-6, 1e-6),
    ];
    for (count, speed, acceleration, jerk) in rows {
        let given = JerkLimited {
            distance: steps(count),
            max_speed: Speed::StepsPerSecond(speed),
            max_acceleration: Acceleration::StepsPerSecond2(acceleration),
            max_jerk: Jerk::StepsPerSecond3(jerk),
            ..JerkLimited::default()
        };
        check(Move::JerkLimited(given), ideal::jerk_limited(count, speed, acceleration, jerk));
    }
}

#[test]
fn every_step_of_a_curve_through_points_is_in_its_exact_cycle() {
    let rows: [&[(f64, f64)]; 5] = [
        &[(0.0, 0.0), (DAY_S, 140.0)],
        &[(0.0, 0.0), (40_000.1, -77.3), (80_000.3, 0.2)],
        &[
            (0.0, 3.0),
            (10_000.0, 10.0),
            (15_000.0, 30.0),
            (16_000.7, 30.0),
            (50_000.0, 70.2),
            (60_000.0, 19.0),
        ],
        &[
            (7.5, 0.0),
            (10_000.0, -30.2),
            (15_000.0, -33.0),
            (40_000.0, -70.1),
            (45_000.3, -10.9),
            (70_000.0, -8.0),
        ],
        &[(100.1, 123_456_789.1), (20_000.0, 123_456_800.3), (80_000.0, 123_456_849.9)],
    ];
    for points in rows {
        for interpolation in [Interpolation::Straight, Interpolation::Smooth] {
            let ideal = ideal::points(points, interpolation);
            let points = points.iter().map(|&(time_s, position)| Point { time_s, position }).collect();
            check(Move::Points(Points { unit: PointUnit::Steps, interpolation, points }), ideal);
        }
    }
}

#[test]
fn every_step_of_a_staircase_is_in_its_exact_cycle() {
    // A single rate, one row per ramp, and several.
    let rows = [
        (20_000, 1.0, 1.0, ShortMove::Document),
        (-40_000, 1.0, 2.0, ShortMove::Document),
        (7_000_007, 10.0, 350.0, ShortMove::Reverse),
    ];
    for (count, start, top, short_move) in rows {
        let given = Staircase {
            distance: steps(count),
            top_speed: Speed::StepsPerSecond(top),
            level: 1,
            short_move,
            start_speed: Speed::StepsPerSecond(start),
            max_speed: Speed::StepsPerSecond(1000.0),
        };
        check_planned(&Move::Staircase(given), 64.0, by_rows);
    }
}

#[test]
fn every_step_of_a_sine_by_segments_is_in_its_exact_cycle() {
    for (amplitude, period_s, periods) in [(1, DAY_S, 1), (-40, 20_000.3, 2), (100, 30_000.0, 1)] {
        for max_deviation in [0.0, 0.006, 0.05] {
            let given = SineSegments { amplitude: steps(amplitude), period_s, periods, max_deviation };
            let ideal = |profile: &Profile| by_segments(&given, profile);
            check_planned(&Move::SineSegments(given.clone()), 64.0, ideal);
        }
    }
}

#[test]
fn every_step_of_a_sliced_move_is_in_its_exact_cycle() {
    // Shortened slices accumulate roundings: 2000 slices are enough.
    for (count, ramp_s) in [(5000, 40.0), (-7001, 60.0), (4400, 10.0)] {
        let given = Cosine {
            distance: steps(count),
            duration_s: 200.0,
            ramp_s,
            method: CosineMethod::Sliced,
            slice_s: 0.1,
            ..Cosine::default()
        };
        let ideal = |profile: &Profile| by_slices(&given, profile).expect("its slices are known");
        check_planned(&Move::Cosine(given.clone()), 64.0 + 4.0 * 1800.0, ideal);
    }
}
