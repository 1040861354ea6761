//! Every judge of a step (`crossing`), asked directly. A motion asks one for the few steps that f64 does not tell; here
//! all are asked, where f64 does tell: a little before a step's own time in f64, and a little after it.

use super::*;
use crate::{
    acceleration_table::AccelerationTable,
    constant_velocity::{Constant, Dwell},
    cosine::Cosine,
    crossing::{ROUNDING, guess, judged},
    jerk_limited::{JerkLimited, Limits},
    moves::ShortMove,
    ramp::Ramp,
    ramps::Ramps,
    sine::Sine,
    sine_segments::SineSegments,
    sliced::Sliced,
    staircase::Staircase,
    staircase_table::StaircaseTable,
    trapezoid::Trapezoid,
    trapezoid_table::TrapezoidTable,
};
use alloc::vec::Vec;

const CLOCK_HZ: u32 = 16_000_000;
/// Of a move with more steps so many are asked of its beginning, its end and both sides of its middle, and so many between.
const MOST: u64 = 120;

/// The times of a move's steps in f64, in cycles: those that a search finds, where blocks tell them less well.
fn times(profile: &Profile) -> Vec<f64> {
    if matches!(profile, Profile::Cosine(_) | Profile::Ramps(_) | Profile::JerkLimited(_)) {
        let time = |k: u64| profile.time_s(k as f64 - 0.5) * f64::from(CLOCK_HZ);
        return (1..=profile.step_count()).map(time).collect();
    }
    steps(profile, CycleTime::default(), true).into_iter().map(|(instant, _)| instant).collect()
}

/// A move's steps, with their instants or without.
fn steps(profile: &Profile, start: CycleTime, has_instants: bool) -> Vec<Due> {
    let (mut steps, mut block) = (Vec::new(), Block::new(has_instants));
    let Some(mut form) = due_from(profile, start, CLOCK_HZ) else { return steps };
    loop {
        let len = form.next_block(&mut block);
        if len == 0 {
            return steps;
        }
        steps.extend(block.steps(0, len));
    }
}

/// Holds the steps without their instants to those with them, after a whole cycle and within one.
fn check_without_instants(profile: &Profile) {
    for part in [0.0, 0.3] {
        let start = CycleTime { whole: 1000, part: part.into() };
        let [with, without] = [true, false].map(|has_instants| {
            let steps = steps(profile, start, has_instants).into_iter().map(|(_, step)| step);
            steps.collect::<Vec<_>>()
        });
        assert!(with == without, "{part} cycles after a whole one: {profile:?}");
    }
}

/// Holds what judges a move's steps to their times in f64, which are off by `roundings` of the move's time at most.
fn check_within(profile: &Profile, roundings: f64) {
    check_without_instants(profile);
    let (times, clock) = (times(profile), f64::from(CLOCK_HZ));
    let (count, end) = (profile.step_count(), profile.duration_s() * clock);
    assert_eq!(times.len() as u64, count, "{profile:?}");
    let off = profile.off(clock);
    let parts = off / (ROUNDING * end);
    assert!((63.9..=roundings).contains(&parts), "off by {parts} roundings of {profile:?}");
    let is_due_before = profile.is_due_before(CLOCK_HZ);
    let (edges, stride) = (MOST / 4, count / MOST + 1);
    for (k, time) in (1..=count).zip(times) {
        let is_asked = k <= edges || k + edges > count || (2 * k).abs_diff(count + 1) < edges;
        if !is_asked && k % stride > 0 {
            continue;
        }
        let time = Double::from(time);
        let asked = [
            // A start after the cycle that is asked for is as far from it.
            (Double::default() - time, false),
            (time * 0.5.into(), false),
            (time - off.into(), false),
            (time + off.into(), true),
            ((time + end.into()) * 0.5.into() + off.into(), true),
            (Double::from(end) + off.into(), true),
            (time + end.into(), true),
        ];
        for (since, expected) in asked {
            let found = is_due_before(k, since);
            assert_eq!(found, expected, "step {k}, due at {time:?}, before {since:?} of {end}: {profile:?}");
        }
    }
}

fn check(profile: &Profile) {
    check_within(profile, 100.0);
}

/// From one step to so many that few of them are looked at; left and right, even and odd.
const STEPS: [i64; 6] = [1, -2, 3, -16, 77, 1000];

/// Times of a move and its ramps in s: none, half, and short ones.
const TIMES_S: [(f64, f64); 4] = [(0.4, 0.2), (0.3, 0.0), (1.0, 0.07), (7.3, 3.3)];

#[test]
fn a_cosines_steps_are_due_after_their_times_and_not_before() {
    for steps in STEPS {
        for (duration_s, ramp_s) in TIMES_S {
            check(&Profile::Cosine(Cosine::new(steps, duration_s, ramp_s)));
        }
    }
}

#[test]
fn ramps_of_every_shape_have_their_steps_due_after_their_times_and_not_before() {
    let parameters = [0.1, 1.0, 6.0, 20.0];
    let shapes = parameters.map(Ramp::exponential).into_iter().chain([Ramp::Bezier, Ramp::Straight]);
    for ramp in shapes.chain(parameters.map(Ramp::sigmoid)) {
        for steps in STEPS {
            for (duration_s, ramp_s) in TIMES_S {
                check(&Profile::Ramps(Ramps::new(steps, duration_s, ramp_s, ramp)));
            }
        }
    }
}

#[test]
fn a_trapezoids_steps_are_due_after_their_times_and_not_before() {
    // Start speed, top speed, acceleration: a plateau and, of few steps, none; from rest; at top speed throughout.
    let rows = [
        (250.0, 4000.0, 90_000.0),
        (0.0, 700.0, 9000.3),
        (1000.0, 1000.0, 1e6),
        (3.0, 1e5, 100.0),
        (900.0, 1000.0, 1e6),
    ];
    for (start, top, acceleration) in rows {
        for steps in STEPS {
            check(&Profile::Trapezoid(Trapezoid::new(steps, start, top, acceleration)));
        }
    }
}

#[test]
fn a_tables_steps_are_due_after_their_times_and_not_before() {
    for timer_hz in [1_000_000, 999_983] {
        for steps in STEPS {
            let table = AccelerationTable::new(250.0, 4000.0, 90_000.0, timer_hz);
            check(&Profile::TrapezoidTable(TrapezoidTable::new(steps, table, 1000).unwrap()));
        }
    }
}

#[test]
fn a_jerk_limited_moves_steps_are_due_after_their_times_and_not_before() {
    // Speed, acceleration, jerk. Of 3200 steps to 400 these are the four rows of the table: the way to the top speed
    // has 1500 steps, that to the greatest acceleration and back 500; then a ramp to 1000 steps/s without it.
    let full = Limits { speed: 10_000.0, acceleration: 100_000.0, jerk: 2_000_000.0 };
    let gentle = Limits { speed: 1000.0, ..full };
    let rows = [
        (3200, full, true, true),
        (-1501, full, true, true),
        (1499, full, false, true),
        (-1000, full, false, true),
        (501, full, false, true),
        (499, full, false, false),
        (-400, full, false, false),
        (1, full, false, false),
        (2, full, false, false),
        (3, full, false, false),
        (45, gentle, true, false),
        (-1000, gentle, true, false),
        (44, gentle, false, false),
        // Next to nothing of the jerk phases.
        (700, Limits { jerk: 1e12, ..full }, false, true),
        (1700, Limits { jerk: 1e12, ..full }, true, true),
    ];
    for (steps, limits, has_plateau, is_steady) in rows {
        let curve = JerkLimited::new(steps, limits);
        let (speed, top) = (curve.peaks().speed, limits.speed);
        assert_eq!((speed > top * 0.999_999, speed < top * 1.000_001), (has_plateau, true), "{steps}");
        let reached = curve.peaks().acceleration > limits.acceleration * 0.999_999;
        assert_eq!(reached, is_steady, "{steps} {limits:?}");
        check(&Profile::JerkLimited(curve));
    }
}

#[test]
fn a_sines_steps_are_due_after_their_times_and_not_before() {
    for (amplitude, period_s, periods) in
        [(1, 0.5, 3), (-2, 7.3, 2), (3, 0.01, 3), (-10, 0.3, 2), (500, 1.1, 2)]
    {
        check(&Profile::Sine(Sine::new(amplitude, period_s, periods)));
        for deviation in [0.0, 0.006, 0.05, 1.0] {
            let curve = SineSegments::new(amplitude, period_s, periods, deviation);
            check(&Profile::SineSegments(curve));
        }
    }
}

/// So slow that no time in f64 decides: each step's exact time gives the cycle that its edges give.
#[test]
fn a_slow_sines_exact_times_give_the_judged_cycles() {
    const FAST_HZ: u32 = u32::MAX;
    let starts = [CycleTime::default(), CycleTime { whole: 12_345, part: 0.3.into() }];
    let (mut steps, mut decided) = (0, 0);
    for (amplitude, period_s, periods) in [(1, 86_400.0, 3), (-37, 86_399.3, 2), (500, 79_999.1, 1)] {
        let curves = [
            Profile::Sine(Sine::new(amplitude, period_s, periods)),
            Profile::SineSegments(SineSegments::new(amplitude, period_s, periods, 0.006)),
        ];
        for profile in curves {
            assert!(profile.off(FAST_HZ.into()) > 1.0, "f64 would decide");
            let (mut time, is_due_before) =
                (profile.exact_times(FAST_HZ).unwrap(), profile.is_due_before(FAST_HZ));
            for (k, start) in (1..=profile.step_count()).flat_map(|k| starts.map(|start| (k, start))) {
                let expected =
                    judged(start, guess(time(k).high) + start.whole, &|since| is_due_before(k, since));
                steps += 1;
                // At an edge it leaves the decision to the judge.
                if let Some(found) = exact_cycle(start, time(k)) {
                    assert_eq!(found, expected, "step {k} of {profile:?}");
                    decided += 1;
                }
            }
        }
    }
    assert!(decided * 10 > steps * 9, "{decided} of {steps}");
}

#[test]
fn a_staircases_steps_are_due_after_their_times_and_not_before() {
    use ShortMove::{Document, Reverse};
    let table = StaircaseTable::new(1000.0, 20_000.0, 1000.0);
    // Steps, f_s, rule; rows. The four cases of a move, and the first and the last step of a row.
    let rows = [
        (500, 1000, Document, 0),
        (-20, 10, Reverse, 0),
        (500, 1100, Document, 4),
        (241, 1100, Reverse, 4),
        (-240, 1100, Document, 4),
        (239, 1100, Document, 0),
        (239, 1100, Reverse, 3),
        (-180, 1100, Reverse, 3),
        (1, 1100, Reverse, 0),
        (2000, 1300, Document, 9),
    ];
    for (steps, rate, short_move, expected) in rows {
        let curve = Staircase::new(steps, table, rate, short_move, 1000).unwrap();
        assert_eq!(curve.ramp_rows(), expected, "{steps} {rate}");
        check(&Profile::Staircase(curve));
    }
}

#[test]
fn a_sliced_moves_steps_are_due_after_their_times_and_not_before() {
    // A shortened plateau, none, no ramps, and slices that are not all whole.
    let rows = [
        (200, 0.4, 0.1, 0.02),
        (-200, 0.4, 0.2, 0.02),
        (37, 0.09, 0.0, 0.01),
        (641, 0.3337, 0.1113, 0.0207),
        (-7, 0.01, 0.0, 0.01),
        (1, 0.0101, 0.002, 0.009),
    ];
    for (steps, duration_s, ramp_s, slice_s) in rows {
        // Each slice adds four roundings.
        let curve = Sliced::new(steps, duration_s, ramp_s, slice_s, 1000).unwrap();
        check_within(&Profile::Sliced(curve), 64.0 + 4.0 * 22.0);
    }
}

#[test]
fn a_constant_rates_steps_are_due_after_their_times_and_not_before() {
    for speed in [1000.0, 0.7, 999.983] {
        for steps in STEPS {
            check(&Profile::Constant(Constant::new(steps, speed)));
        }
    }
}

#[test]
fn what_has_no_steps_has_none_due() {
    let dwell = Profile::Dwell(Dwell::new(0.1));
    assert_eq!((times(&dwell).len(), dwell.is_due_before(CLOCK_HZ)(1, 1e9.into())), (0, false));
}
