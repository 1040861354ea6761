//! Exact step times (DESIGN B1, B4, B6): for random limits, from tiny to huge, each step is within one cycle of the
//! design's formulas in 32 digits. The number of steps is exact, and so is the end.
//!
//! ```text
//! cycle c of step k   s((c - 1)/clock) <= k - 1/2 <= s((c + 1)/clock)     s: `ideal`, in `wide` numbers
//! ```
//!
//! Motions whose paper defines the step times (tables, staircases, slices, segments) are compared with
//! their own curve: R(s) just before and just after each step.

mod ideal;
mod wide;

use ideal::Ideal;
use proptest::prelude::*;
use std::collections::BTreeSet;
use stepscope_core::motion::{
    AxisPlan, Profile,
    curves::Trapezoid,
    mechanics::{Acceleration, Distance, Jerk, Speed},
    moves::{
        Axis, Constant, Cosine, CosineMethod, Interpolation, JerkLimited, Move, Point, PointUnit, Points,
        RampShape, Ramps, ShortMove, Sine, SineSegments, Staircase, TrapezoidMethod,
    },
    plan_axis,
};
use stepscope_tests::effort;
use wide::Wide;

/// Clocks from the minimum to the maximum of a scenario.
const CLOCKS: [u32; 5] = [1, 1000, 999_983, 16_000_000, 1_000_000_000];

/// A magnitude from `least` to `most`, each power of ten equally likely, including the ends and round numbers.
fn magnitude(least: f64, most: f64) -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        6 => (libm::log(least)..=libm::log(most)).prop_map(libm::exp),
        1 => (libm::log10(least)..=libm::log10(most)).prop_map(|power| libm::exp10(libm::round(power))),
        1 => Just(least),
        1 => Just(most),
    ]
    .prop_map(move |x| x.clamp(least, most))
}

/// This number of steps, left or right.
fn count() -> impl Strategy<Value = f64> + Clone {
    (magnitude(1.0, 1e9), any::<bool>()).prop_map(|(n, left)| libm::round(n) * if left { -1.0 } else { 1.0 })
}

fn clock() -> impl Strategy<Value = u32> + Clone {
    prop::sample::select(CLOCKS.to_vec())
}

/// The plan of one move; an impossible move is refused with its numbers.
fn plan(given: Move) -> Result<Option<AxisPlan>, TestCaseError> {
    match plan_axis(&Axis { moves: vec![given], ..Axis::default() }, "axis") {
        Ok(plan) => Ok(Some(plan)),
        Err(problems) => {
            prop_assert!(!problems.is_empty());
            for problem in problems {
                let message = problem.cause.to_string();
                prop_assert!(message.contains(|c: char| c.is_ascii_digit()), "{}", message);
            }
            Ok(None)
        }
    }
}

/// Checked steps: the first, the last, those in the middle, and some others.
fn chosen(count: u64) -> BTreeSet<u64> {
    let near = |middle: u64| middle.saturating_sub(20)..=middle.saturating_add(20);
    let between = (0..=64).map(|part| (u128::from(count) * part / 64) as u64);
    let all = near(1).chain(near(count / 2)).chain(near(count)).chain(between.flat_map(|k| [k, k + 1]));
    all.filter(|k| (1..=count).contains(k)).collect()
}

/// Whether a step at `place` in `ideal`, which begins `start` cycles after the motion, is within one cycle.
fn is_exact(ideal: &Ideal, start: Wide, place: Wide, cycle: u64, clock_hz: u32) -> Result<(), TestCaseError> {
    let at = |cycles: Wide| {
        let t = ((cycles - start) / Wide::from(u64::from(clock_hz))).max(Wide::from(0.0)).min(ideal.duration);
        (ideal.way)(t)
    };
    let (cycle, one) = (Wide::from(cycle), Wide::from(1.0));
    let (before, after) = (at(cycle - one), at(cycle + one));
    prop_assert!(before <= place, "late: {:?} of {:?} at {:?}", before, place, cycle);
    prop_assert!(after >= place, "early: {:?} of {:?} at {:?}", after, place, cycle);
    Ok(())
}

fn half_before(k: u64) -> Wide {
    Wide::from(k) - Wide::from(0.5)
}

/// Compares a move in one direction with its ideal.
fn check_one_way(plan: &AxisPlan, ideal: &Ideal, steps: f64, clock_hz: u32) -> Result<(), TestCaseError> {
    prop_assert_eq!(plan.steps() as f64, steps);
    let profile = &plan.moves()[0].profile;
    let count = plan.step_count();
    prop_assert_eq!(count as f64, libm::fabs(steps));
    let mut last = 0;
    for k in chosen(count) {
        let cycle = profile.step_cycle(k, clock_hz).expect("there is such a step");
        prop_assert!(cycle >= last, "step {} at {} after {}", k, cycle, last);
        is_exact(ideal, Wide::from(0.0), half_before(k), cycle, clock_hz)?;
        last = cycle;
    }
    prop_assert_eq!(profile.step_cycle(count + 1, clock_hz), None);
    // Walking the table gives the same times.
    for (k, due) in (1..=50).zip(plan.due_steps(clock_hz)) {
        prop_assert_eq!(Some(due.cycle), profile.step_cycle(k, clock_hz));
        prop_assert_eq!(due.right, steps > 0.0);
    }
    Ok(())
}

proptest! {
    #![proptest_config(effort::cases(400))]

    #[test]
    fn constant_rates_are_exact(steps in count(), speed in magnitude(1e-6, 1e7), clock_hz in clock()) {
        let given = Constant { distance: Distance::Steps(steps), speed: Speed::StepsPerSecond(speed) };
        if let Some(plan) = plan(Move::Constant(given))? {
            check_one_way(&plan, &ideal::constant(libm::fabs(steps), speed), steps, clock_hz)?;
        }
    }

    #[test]
    fn trapezoids_are_exact(
        steps in count(), start in prop_oneof![1 => Just(0.0), 3 => magnitude(1e-6, 1e7)],
        top in magnitude(1e-6, 1e7), acceleration in magnitude(1e-6, 1e13), clock_hz in clock(),
    ) {
        let speed = Speed::StepsPerSecond;
        let top = top.max(start);
        let given = stepscope_core::motion::moves::Trapezoid {
            distance: Distance::Steps(steps),
            start_speed: Some(speed(start)),
            max_speed: speed(top),
            max_acceleration: Acceleration::StepsPerSecond2(acceleration),
            method: TrapezoidMethod::Exact,
            timer_hz: 1, ..stepscope_core::motion::moves::Trapezoid::default() };
        if let Some(plan) = plan(Move::Trapezoid(given))? {
            let ideal = ideal::trapezoid(libm::fabs(steps), start, top, acceleration);
            check_one_way(&plan, &ideal, steps, clock_hz)?;
        }
    }

    #[test]
    fn cosines_are_exact(
        steps in count(), duration_s in magnitude(1e-6, 86_400.0),
        part in prop_oneof![Just(0.0), Just(0.5), 0.0..=0.5, magnitude(1e-9, 0.5)], clock_hz in clock(),
    ) {
        let ramp_s = (duration_s * part).min(duration_s / 2.0);
        let given = Cosine { distance: Distance::Steps(steps), duration_s, ramp_s, ..Cosine::default() };
        if let Some(plan) = plan(Move::Cosine(given))? {
            check_one_way(&plan, &ideal::cosine(libm::fabs(steps), duration_s, ramp_s), steps, clock_hz)?;
        }
    }

    #[test]
    fn jerk_limited_moves_are_exact(
        steps in count(), speed in magnitude(1e-6, 1e7), acceleration in magnitude(1e-6, 1e13),
        jerk in magnitude(1e-6, 1e19), clock_hz in clock(),
    ) {
        let given = JerkLimited {
            distance: Distance::Steps(steps),
            max_speed: Speed::StepsPerSecond(speed),
            max_acceleration: Acceleration::StepsPerSecond2(acceleration),
            max_jerk: Jerk::StepsPerSecond3(jerk), ..JerkLimited::default() };
        if let Some(plan) = plan(Move::JerkLimited(given))? {
            let ideal = ideal::jerk_limited(libm::fabs(steps), speed, acceleration, jerk);
            // The fastest move within the limits.
            let off = (Wide::from(plan.duration_s()) - ideal.duration).to_f64();
            prop_assert!(libm::fabs(off) <= 1e-14 * plan.duration_s(), "{} s off", off);
            check_one_way(&plan, &ideal, steps, clock_hz)?;
        }
    }

    #[test]
    fn sines_are_exact_over_a_million_periods(
        amplitude in count(), period_s in magnitude(1e-6, 86_400.0), periods in magnitude(1.0, 1e6),
        clock_hz in clock(),
    ) {
        let periods = libm::round(periods) as u32;
        let given = Sine { amplitude: Distance::Steps(amplitude), period_s, periods };
        let Some(plan) = plan(Move::Sine(given))? else { return Ok(()) };
        let size = libm::fabs(amplitude) as u64;
        prop_assert_eq!((plan.steps(), plan.step_count()), (0, 4 * size * u64::from(periods)));
        let ideal = ideal::half_sine(libm::fabs(amplitude), period_s);
        let half = ideal.duration * Wide::from(u64::from(clock_hz));
        let mut last = 0;
        for k in chosen(plan.step_count()) {
            let cycle = plan.moves()[0].profile.step_cycle(k, clock_hz).expect("there is such a step");
            prop_assert!(cycle >= last);
            let (passed, own) = ((k - 1) / (2 * size), (k - 1) % (2 * size) + 1);
            is_exact(&ideal, half * Wide::from(passed), half_before(own), cycle, clock_hz)?;
            last = cycle;
        }
        for (k, due) in (1..=50).zip(plan.due_steps(clock_hz)) {
            prop_assert_eq!(Some(due.cycle), plan.moves()[0].profile.step_cycle(k, clock_hz));
            prop_assert_eq!(due.right, ((k - 1) / (2 * size) % 2 == 1) == (amplitude > 0.0));
        }
    }

    #[test]
    fn curves_through_points_are_exact(
        // In parts that are exact in binary, without positions on half steps, which a reversal would touch.
        rows in prop::collection::vec((1..200_000_u32, magnitude(1e-3, 1e9), any::<bool>(), any::<bool>()), 1..12),
        smooth in any::<bool>(), clock_hz in clock(),
    ) {
        let mut points = vec![Point { time_s: 0.0, position: 0.0 }];
        for (later, position, left, stays) in rows {
            let last = points[points.len() - 1];
            let whole = libm::round(position * 1024.0) / 1024.0 + 1.0 / 4096.0;
            let position = if stays { last.position } else { whole.min(1e9) * if left { -1.0 } else { 1.0 } };
            points.push(Point { time_s: last.time_s + f64::from(later) / 1024.0, position });
        }
        let interpolation = if smooth { Interpolation::Smooth } else { Interpolation::Straight };
        let given = Points { unit: PointUnit::Steps, interpolation, points: points.clone() };
        let Some(plan) = plan(Move::Points(given))? else { return Ok(()) };
        let round = |position: f64| libm::floor(position + 0.5);
        prop_assert_eq!(plan.steps() as f64, round(points[points.len() - 1].position));
        let (mut passed, mut last) = (0_u64, 0);
        for ((start, right, ideal), pair) in ideal::pieces(&points, interpolation).iter().zip(points.windows(2)) {
            let (from, to) = (round(pair[0].position), round(pair[1].position));
            let steps = libm::fabs(to - from) as u64;
            for k in chosen(steps) {
                let cycle = plan.moves()[0].profile.step_cycle(passed + k, clock_hz).expect("there is such a step");
                prop_assert!(cycle >= last);
                let place = if *right { from + k as f64 - 0.5 } else { from - k as f64 + 0.5 };
                let way = Wide::from(place) - Wide::from(pair[0].position);
                let way = if *right { way } else { -way };
                is_exact(ideal, *start * Wide::from(u64::from(clock_hz)), way, cycle, clock_hz)?;
                last = cycle;
            }
            passed += steps;
        }
        prop_assert_eq!(passed, plan.step_count());
        for (k, due) in (1..=50).zip(plan.due_steps(clock_hz)) {
            prop_assert_eq!(Some(due.cycle), plan.moves()[0].profile.step_cycle(k, clock_hz));
        }
    }

    #[test]
    fn special_curves_step_where_they_cross_half_integers(
        given in own_curve(), clock_hz in prop::sample::select(CLOCKS[1..].to_vec()),
    ) {
        let Some(plan) = plan(given.clone())? else { return Ok(()) };
        let peak_speed = plan.peaks().speed;
        // A polyline that reverses within a cycle has another position one cycle after a step.
        if matches!(given, Move::SineSegments(_)) && peak_speed * 8.0 > f64::from(clock_hz) {
            return Ok(());
        }
        let profile = &plan.moves()[0].profile;
        let (mut made, mut last, mut walked) = (0_i64, 0, 0_u64);
        for due in plan.due_steps(clock_hz).take(3000) {
            let way = if due.right { 1.0 } else { -1.0 };
            let past = |cycle: f64| (plan.position(cycle / f64::from(clock_hz)) - made as f64) * way - 0.5;
            let cycle = due.cycle as f64;
            // The rounding of time and position in f64, and the distance of a table's curve from its steps.
            let digits = 1e-14 * (peak_speed * (cycle + 1.0) / f64::from(clock_hz)) + 2e-6;
            prop_assert!(past(cycle - 1.0) <= digits, "{:?}: {:?} late by {}", given, due, past(cycle - 1.0));
            prop_assert!(past(cycle + 1.0) >= -digits, "{:?}: {:?} early by {}", given, due, past(cycle + 1.0));
            prop_assert!(due.cycle >= last);
            (made, last, walked) = (made + way as i64, due.cycle, walked + 1);
        }
        prop_assert!(walked == plan.step_count().min(3000));
        prop_assert!(walked == 3000 || made == plan.steps());
        // The last step is before the end, and R(end) is the total.
        let end = plan.duration_s() * f64::from(clock_hz);
        if let Some(cycle) = profile.step_cycle(plan.step_count(), clock_hz) {
            prop_assert!(cycle as f64 <= end + 1.0, "the last step at {} of {}", cycle, end);
        }
        // A table ends with its last step, and a step to the left is due after that time (B7).
        let is_table = matches!(profile, Profile::TrapezoidTable(_) | Profile::Staircase(_));
        let waits = i64::from(is_table && plan.steps() < 0);
        prop_assert_eq!(plan.steps_due(plan.duration_s()), plan.steps() + waits);
        prop_assert_eq!(plan.steps_due(2.0 * plan.duration_s()), plan.steps());
    }
}

/// Moves with the step times of papers, and ramps of all shapes.
fn own_curve() -> impl Strategy<Value = Move> {
    let speed = Speed::StepsPerSecond;
    let distance = count().prop_map(Distance::Steps);
    let shapes = [RampShape::Straight, RampShape::Exponential, RampShape::Sigmoid, RampShape::Bezier];
    let times = (magnitude(1e-3, 86_400.0), prop_oneof![Just(0.0), Just(0.5), 0.0..=0.5]);
    prop_oneof![
        (distance.clone(), times.clone()).prop_map(|(distance, (duration_s, part))| {
            let ramp_s = duration_s * part;
            Move::Cosine(Cosine {
                distance,
                duration_s,
                ramp_s,
                method: CosineMethod::Sliced,
                ..Cosine::default()
            })
        }),
        (distance.clone(), times, prop::sample::select(shapes.to_vec()), magnitude(0.1, 20.0)).prop_map(
            |(distance, (duration_s, part), shape, parameter)| {
                let ramp_s = duration_s * part;
                Move::Ramps(Ramps { distance, duration_s, ramp_s, ..Ramps::shaped(shape, parameter) })
            }
        ),
        (distance.clone(), magnitude(0.5, 1e6), 1.0..100.0_f64, magnitude(1e-3, 1e9), magnitude(1e4, 1e9))
            .prop_map(move |(distance, start, times, acceleration, timer)| {
                Move::Trapezoid(stepscope_core::motion::moves::Trapezoid {
                    distance,
                    start_speed: Some(speed(start)),
                    max_speed: speed((start * times).min(1e7)),
                    max_acceleration: Acceleration::StepsPerSecond2(acceleration),
                    method: TrapezoidMethod::Table,
                    timer_hz: timer as u32,
                    ..stepscope_core::motion::moves::Trapezoid::default()
                })
            }),
        (distance.clone(), magnitude(1.0, 1e6), 1..=5_u8, any::<bool>(), magnitude(1.0, 1e6)).prop_map(
            move |(distance, top, level, turns, start)| {
                Move::Staircase(Staircase {
                    distance,
                    top_speed: speed(top),
                    level,
                    short_move: if turns { ShortMove::Reverse } else { ShortMove::Document },
                    start_speed: speed(start),
                    max_speed: speed(1e6),
                })
            }
        ),
        (distance, magnitude(1e-3, 86_400.0), 1..4_u32, magnitude(1e-4, 1.0)).prop_map(
            |(amplitude, period_s, periods, max_deviation)| {
                Move::SineSegments(SineSegments { amplitude, period_s, periods, max_deviation })
            }
        ),
    ]
}

#[test]
fn a_hundred_million_steps_have_no_drift() {
    const STEPS: u64 = 100_000_000;
    let clock_hz = 16_000_000;
    // 12345.5 steps/s: step k at (2k - 1)*clock/24691 cycles, in integers.
    let given = Constant { distance: Distance::Steps(STEPS as f64), speed: Speed::StepsPerSecond(12_345.5) };
    let constant = plan(Move::Constant(given)).expect("holds").expect("plans");
    let (mut walked, mut last) = (0, 0);
    for due in constant.due_steps(clock_hz) {
        walked += 1;
        assert!(due.cycle > last, "step {walked}");
        last = due.cycle;
        if walked % 1_000_003 == 0 || walked == STEPS {
            let ideal = (4 * u128::from(walked) - 2) * u128::from(clock_hz) / 24_691;
            assert!((2 * u128::from(last)).abs_diff(ideal) <= 2, "step {walked}: {last}, twice {ideal}");
        }
    }
    assert_eq!(walked, STEPS);

    let curve = Trapezoid::new(STEPS as i64, 250.0, 100_000.0, 90_000.0);
    let ideal = ideal::trapezoid(STEPS as f64, 250.0, 100_000.0, 90_000.0);
    let profile = Profile::Trapezoid(curve);
    let (mut walked, mut last) = (0, 0);
    for cycle in curve.step_times(clock_hz) {
        walked += 1;
        assert!(cycle > last, "step {walked}");
        last = cycle;
        if walked % 999_983 == 0 || walked + 1000 > STEPS {
            is_exact(&ideal, Wide::from(0.0), half_before(walked), cycle, clock_hz).expect("exact");
            assert_eq!(profile.step_cycle(walked, clock_hz), Some(cycle));
        }
    }
    assert_eq!(walked, STEPS);
    let end = (ideal.duration * Wide::from(u64::from(clock_hz))).to_f64();
    assert!((end - last as f64) < 64_000.0 && end > last as f64, "{last} of {end}");
}
