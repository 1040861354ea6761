//! Every step is in the cycle of B1: floor(t*clock_hz + 1/2), where the curve crosses the step's position at t. Every number
//! means its shortest decimal. Compared with numbers of 320 bits.
//!
//! ```text
//! cycle c of step k    s((c - 1/2)/clock) <= k - 1/2 < s((c + 1/2)/clock)      s: `ideal`, in `fixed` numbers
//! ```
//!
//! The steps whose time in f64 is next to the middle between two cycles are checked, and some others. `PROPTEST_CASES` sets
//! the number of random motions of each kind:
//!
//! ```text
//! PROPTEST_CASES=20000 cargo test --release -p stepscope-motion --test exact_curves -- --nocapture
//! ```
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod decided;
mod fixed;
mod ideal;
mod whole_numbers;

use fixed::{decimal, whole};
use ideal::Ideal;
use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use std::cmp::Ordering;
use std::env;
use stepscope_motion::{
    AxisPlan, Profile,
    curves::{Slice, StaircaseTable},
    mechanics::{Acceleration, Distance, Jerk, Speed},
    moves::{
        Axis, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, Move, Point, PointUnit,
        Points, RampShape, Ramps, ShortMove, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
    },
    plan_axis,
};

const CLOCKS: [u32; 6] = [1000, 999_983, 16_000_000, 16_000_000, 72_000_000, 1_000_000_000];
/// Motions of each kind, unless `PROPTEST_CASES` is set.
const MOTIONS: u64 = 60;
/// Maximum steps of a motion.
const MAX_STEPS: f64 = 60_000.0;
/// Steps closer than this to an edge are checked: in cycles, and relative to the time.
const NEAR: (f64, f64) = (1e-6, 1e-14);
/// Maximum error of an interpolated time: four times 64 roundings of the duration, and 2^-17 cycles.
const BY_BLOCKS: (f64, f64) = (4.0 * 64.0, 1.0 / 131_072.0);
/// Maximum number of checked steps near an edge per motion.
const MAX_NEAR: u64 = 300;

fn motions() -> u64 {
    env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(MOTIONS)
}

/// Reproducible random numbers.
struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn below(&mut self, end: u64) -> u64 {
        self.0.next_u64() % end
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len() as u64) as usize]
    }

    /// Each power of ten is equally likely; with few digits, as people write them, or with all.
    fn magnitude(&mut self, from: f64, to: f64) -> f64 {
        let part = self.below(1 << 53) as f64 / (1_u64 << 53) as f64;
        let number = libm::exp(libm::log(from) + (libm::log(to) - libm::log(from)) * part);
        let digits = self.of(&[1, 2, 4, 16]);
        let number: f64 = format!("{number:.*e}", digits).parse().expect("a number");
        number.clamp(from, to)
    }

    fn steps(&mut self, max: f64) -> i64 {
        let steps = self.magnitude(1.0, max).round() as i64;
        if self.below(2) == 0 { -steps } else { steps }
    }
}

fn direction(right: bool) -> i64 {
    if right { 1 } else { -1 }
}

/// What was checked.
#[derive(Default)]
struct Tally {
    steps: u64,
    near: u64,
    others: u64,
    ties: u64,
    /// Number of cycles at which the steps due were compared.
    due: u64,
    /// Maximum errors of times in f64: relative to the motion's duration, and in cycles; not checked if 0.
    max_relative_error: f64,
    max_cycle_error: f64,
}

impl Tally {
    /// Compares the steps of an axis with the ideals of its moves.
    fn compare(&mut self, draw: &mut Draw, plan: &AxisPlan, ideals: &[Ideal], clock_hz: u32, name: &str) {
        let clock = whole(clock_hz.into());
        let mut due = plan.due_instants(clock_hz);
        let (mut start, mut near) = (whole(0), 0);
        for (planned, ideal) in plan.moves().iter().zip(ideals) {
            let count = planned.profile.step_count();
            for k in 1..=count {
                let (instant, step) = due.next().expect("the axis has the steps of its moves");
                let from_edge = (instant - instant.floor() - 0.5).abs();
                let is_near = from_edge < NEAR.0 + NEAR.1 * instant && near < MAX_NEAR;
                self.steps += 1;
                if !is_near && draw.below(1 + count / 8) > 0 {
                    continue;
                }
                near += u64::from(is_near);
                *(if is_near { &mut self.near } else { &mut self.others }) += 1;
                // Half cycles from the move's start, in s.
                let at = |halves: i64| {
                    let cycles = whole(2 * step.cycle as i64 + halves) / whole(2);
                    (ideal.compare)(k, &(cycles / clock.clone() - start.clone()))
                };
                let (before, after) = (at(-1), at(1));
                self.ties += u64::from(before == Ordering::Equal);
                if ideals.len() == 1 && self.max_relative_error > 0.0 {
                    // The error of the time in f64 is within the planners' bound.
                    let off = self.max_relative_error * plan.duration_s() * f64::from(clock_hz)
                        + self.max_cycle_error;
                    let off = decimal(off);
                    let at = |cycles| (ideal.compare)(k, &(cycles / clock.clone()));
                    let around = [decimal(instant) - off.clone(), decimal(instant) + off].map(at);
                    let is_around = around[0] != Ordering::Greater && around[1] != Ordering::Less;
                    assert!(is_around, "step {k} is not at {instant} at {clock_hz} Hz: {around:?} of {name}");
                }
                assert!(
                    before != Ordering::Greater && after == Ordering::Greater,
                    "step {k} at {instant} is not in {step:?} at {clock_hz} Hz: {before:?} {after:?} of {name}"
                );
            }
            start = start + ideal.duration.clone();
        }
        assert!(due.next().is_none(), "more steps than expected");
        self.compare_due(draw, plan, ideals, clock_hz, name);
    }

    /// Compares the number of steps due (B7) with the ideals, at cycles in which steps are due.
    fn compare_due(&mut self, draw: &mut Draw, plan: &AxisPlan, ideals: &[Ideal], clock_hz: u32, name: &str) {
        let clock = whole(clock_hz.into());
        let mut starts = vec![whole(0)];
        for ideal in ideals {
            starts.push(starts[starts.len() - 1].clone() + ideal.duration.clone());
        }
        let of_moves = plan.moves().iter().enumerate();
        let mut steps =
            of_moves.flat_map(|(index, planned)| (1..=planned.profile.step_count()).map(move |k| (index, k)));
        let (mut due_by, mut due, mut checked) = (plan.due_by(clock_hz), 0, 0);
        let mut instants = plan.due_instants(clock_hz).peekable();
        while let Some((instant, step)) = instants.next() {
            let cycle = step.cycle;
            let mut together = vec![(steps.next().expect("a step is one of a move"), step.right)];
            while let Some((_, next)) = instants.next_if(|(_, next)| next.cycle == cycle) {
                together.push((steps.next().expect("a step is one of a move"), next.right));
            }
            let from_cycle = (instant - cycle as f64).abs();
            let is_near = from_cycle < NEAR.0 + NEAR.1 * instant && checked < MAX_NEAR;
            if is_near || draw.below(64) == 0 {
                checked += u64::from(is_near);
                let time = whole(cycle as i64) / clock.clone();
                let is_due = |&&((index, k), right): &&((usize, u64), bool)| match (ideals[index].compare)(
                    k,
                    &(time.clone() - starts[index].clone()),
                ) {
                    Ordering::Less => false,
                    Ordering::Equal => right,
                    Ordering::Greater => true,
                };
                let now: i64 = together.iter().filter(is_due).map(|(_, right)| direction(*right)).sum();
                assert_eq!(due_by.steps(cycle), due + now, "by cycle {cycle} at {clock_hz} Hz of {name}");
                self.due += 1;
            }
            due += together.iter().map(|(_, right)| direction(*right)).sum::<i64>();
        }
    }

    fn print(&self, name: &str) {
        let Self { steps, near, others, ties, due, .. } = self;
        println!(
            "{name}: {steps} steps, {near} near an edge and {others} others compared, {ties} ties, steps due compared at {due} cycles"
        );
    }
}

fn plan_of(moves: Vec<Move>) -> Option<AxisPlan> {
    plan_axis(&Axis { moves, ..Axis::default() }, "x").ok()
}

/// Compares motions of one kind; some have a dwell or a second move.
fn compare(
    seed: u64,
    name: &str,
    (roundings, max_cycle_error): (f64, f64),
    each: impl Fn(&mut Draw) -> (Move, Ideal),
) {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(seed));
    let mut tally =
        Tally { max_relative_error: roundings * f64::EPSILON / 2.0, max_cycle_error, ..Tally::default() };
    let mut planned = 0;
    for _ in 0..motions() {
        let clock_hz = draw.of(&CLOCKS);
        let (first, ideal) = each(&mut draw);
        let (mut moves, mut ideals) = (vec![first], vec![ideal]);
        if draw.below(3) == 0 {
            if draw.below(2) == 0 {
                let duration_s = draw.magnitude(1e-6, 10.0);
                let ideal = Ideal { duration: decimal(duration_s), compare: Box::new(|_, _| Ordering::Less) };
                moves.push(Move::Dwell(Dwell { duration_s }));
                ideals.push(ideal);
            }
            let (second, ideal) = each(&mut draw);
            moves.push(second);
            ideals.push(ideal);
        }
        let description = format!("{moves:?}");
        let Some(plan) = plan_of(moves) else { continue };
        planned += 1;
        tally.compare(&mut draw, &plan, &ideals, clock_hz, &description);
    }
    assert!(planned > motions() / 4, "only {planned} valid motions");
    tally.print(name);
}

fn sine(draw: &mut Draw) -> (Move, Ideal) {
    let periods = draw.of(&[1, 1, 2, 5]);
    let amplitude = draw.steps(MAX_STEPS / 4.0 / f64::from(periods));
    let period_s = draw.magnitude(1e-3, 86_400.0);
    let given = Sine { amplitude: Distance::Steps(amplitude as f64), period_s, periods };
    (Move::Sine(given), ideal::sine(amplitude, period_s, periods))
}

#[test]
fn every_step_of_sines_is_in_its_cycle() {
    compare(1, "sine", (12.0, 0.0), sine);
}

/// A duration, and a ramp of up to half of it.
fn times_s(draw: &mut Draw) -> (f64, f64) {
    let duration_s = draw.magnitude(1e-3, 86_400.0);
    let ramp_s = match draw.below(5) {
        0 => 0.0,
        1 => duration_s / 2.0,
        2 => draw.magnitude(1e-9 * duration_s, duration_s / 2.0),
        _ => draw.magnitude(0.01 * duration_s, duration_s / 2.0),
    };
    (duration_s, ramp_s)
}

fn cosine(draw: &mut Draw) -> (Move, Ideal) {
    let (steps, (duration_s, ramp_s)) = (draw.steps(MAX_STEPS), times_s(draw));
    let given = Cosine { distance: Distance::Steps(steps as f64), duration_s, ramp_s, ..Cosine::default() };
    // Ramps shorter than a cycle of the fastest clock count as none.
    (Move::Cosine(given), ideal::cosine(steps, duration_s, if ramp_s < 1e-9 { 0.0 } else { ramp_s }))
}

#[test]
fn every_step_of_cosines_is_in_its_cycle() {
    compare(3, "cosine", BY_BLOCKS, cosine);
}

/// With an odd count, the middle step is due after half of the time.
#[test]
fn a_cosines_step_between_two_cycles_is_in_the_second() {
    for halves in (0..300).map(|index: u64| 2 * (7919 * index + 5000) + 1) {
        let seconds = |halves: u64| format!("{halves}e-6").parse().expect("a number");
        for (count, ramp) in [(1, halves / 3), (3, halves), (1001, 5), (41, 0)] {
            let given = Cosine {
                distance: Distance::Steps(count as f64),
                duration_s: seconds(halves),
                ramp_s: seconds(ramp) / 2.0,
                ..Cosine::default()
            };
            let plan = plan_of(vec![Move::Cosine(given)]).expect("a valid axis");
            let found = plan.moves()[0].profile.step_cycle(count / 2 + 1, 1_000_000);
            assert_eq!(found, Some(halves.div_ceil(2)), "{count} steps in {halves} us");
        }
    }
}

fn ramps(shape: RampShape, draw: &mut Draw) -> (Move, Ideal) {
    let (steps, (duration_s, ramp_s)) = (draw.steps(MAX_STEPS), times_s(draw));
    let parameter = draw.magnitude(0.1, 20.0);
    let given = Ramps {
        distance: Distance::Steps(steps as f64),
        duration_s,
        ramp_s,
        shape,
        sigmoid_range: parameter,
        time_constants: parameter,
        ..Ramps::default()
    };
    let ramp_s = if ramp_s < 1e-9 { 0.0 } else { ramp_s };
    (Move::Ramps(given), ideal::ramps((steps, duration_s, ramp_s), ideal::shape(shape, parameter)))
}

#[test]
fn ramps_of_every_shape_have_every_step_in_its_cycle() {
    let shapes = [RampShape::Bezier, RampShape::Straight, RampShape::Exponential, RampShape::Sigmoid];
    for (seed, shape) in (5..).zip(shapes) {
        compare(seed, &format!("{shape:?}"), BY_BLOCKS, |draw| ramps(shape, draw));
    }
}

fn trapezoid(draw: &mut Draw) -> (Move, Ideal) {
    let steps = draw.steps(MAX_STEPS);
    let top = draw.magnitude(1.0, 1e6);
    let start = match draw.below(4) {
        0 => 0.0,
        1 => top,
        _ => draw.magnitude(1e-3 * top, top),
    };
    // Ramps from one step to more than the move has.
    let acceleration = draw.magnitude(top * top / 1e6, top * top * 10.0);
    let given = Trapezoid {
        distance: Distance::Steps(steps as f64),
        start_speed: Some(Speed::StepsPerSecond(start)),
        max_speed: Speed::StepsPerSecond(top),
        max_acceleration: Acceleration::StepsPerSecond2(acceleration),
        method: TrapezoidMethod::Exact,
        timer_hz: 1,
        ..Trapezoid::default()
    };
    (Move::Trapezoid(given), ideal::trapezoid(steps, start, top, acceleration))
}

#[test]
fn trapezoids_have_every_step_in_its_cycle() {
    compare(4, "trapezoid", (0.0, 0.0), trapezoid);
}

fn jerk_limited(draw: &mut Draw) -> (Move, Ideal) {
    let (steps, speed) = (draw.steps(MAX_STEPS), draw.magnitude(1.0, 1e6));
    // Ramps from one step to more than the move has, with and without constant acceleration.
    let acceleration = draw.magnitude(speed * speed / 1e5, speed * speed * 10.0);
    let jerk = match draw.below(4) {
        // The limit between two rows of the planner's table.
        0 => acceleration * acceleration / speed,
        _ => draw.magnitude(
            acceleration * acceleration / speed / 100.0,
            acceleration * acceleration / speed * 100.0,
        ),
    };
    let given = JerkLimited {
        distance: Distance::Steps(steps as f64),
        max_speed: Speed::StepsPerSecond(speed),
        max_acceleration: Acceleration::StepsPerSecond2(acceleration),
        max_jerk: Jerk::StepsPerSecond3(jerk),
        ..JerkLimited::default()
    };
    (Move::JerkLimited(given), ideal::jerk_limited(steps, speed, acceleration, jerk))
}

#[test]
fn jerk_limited_moves_have_every_step_in_its_cycle() {
    compare(9, "jerk-limited", BY_BLOCKS, jerk_limited);
}

fn points(interpolation: Interpolation, draw: &mut Draw) -> (Move, Ideal) {
    let far = draw.of(&[0.0, 0.0, 12.25, 123_456_789.1]);
    let (mut time_s, mut position) = (draw.of(&[0.0, 0.0, 1.5, 40_000.1]), far);
    let mut points = vec![(time_s, position)];
    for _ in 0..=draw.below(6) {
        let (later_s, distance) = (draw.magnitude(1e-3, 3000.0), draw.magnitude(0.1, MAX_STEPS / 6.0));
        time_s += later_s;
        position = match draw.below(6) {
            0 => position,
            1 => position - distance,
            _ => position + distance,
        };
        // With few digits, as people write them, or with all.
        if draw.below(2) == 0 {
            (time_s, position) =
                (libm::round(time_s * 1e3).max(1.0) / 1e3, libm::round(position * 10.0) / 10.0);
        }
        // No point at a half step, which a reversal may only touch.
        if (decimal(position) - decimal(far)).is_half() {
            position += 0.2;
        }
        points.push((time_s, position));
    }
    let ideal = ideal::points(&points, interpolation);
    let points = points.into_iter().map(|(time_s, position)| Point { time_s, position }).collect();
    (Move::Points(Points { unit: PointUnit::Steps, interpolation, points }), ideal)
}

#[test]
fn curves_through_points_have_every_step_in_its_cycle() {
    compare(10, "smooth points", (0.0, 0.0), |draw| points(Interpolation::Smooth, draw));
    compare(11, "straight points", (0.0, 0.0), |draw| points(Interpolation::Straight, draw));
}

/// Compares the steps of moves with ideals that use the plan's rows or slices, but not their times.
fn compare_planned(
    seed: u64,
    name: &str,
    mut each: impl FnMut(&mut Draw) -> Move,
    ideal: impl Fn(&Move, &Profile) -> Option<Ideal>,
) {
    let (mut draw, mut tally) = (Draw(Xoshiro256PlusPlus::seed_from_u64(seed)), Tally::default());
    let mut planned = 0;
    for _ in 0..motions() {
        let (clock_hz, given) = (draw.of(&CLOCKS), each(&mut draw));
        // Two moves, so that the second begins at a fraction of a cycle.
        let Some(plan) = plan_of(vec![given.clone(), given.clone()]) else { continue };
        let ideals: Option<Vec<Ideal>> =
            plan.moves().iter().map(|planned| ideal(&given, &planned.profile)).collect();
        let Some(ideals) = ideals else { continue };
        planned += 1;
        tally.compare(&mut draw, &plan, &ideals, clock_hz, &format!("{given:?}"));
    }
    assert!(planned > motions() / 4, "only {planned} valid motions");
    tally.print(name);
}

#[test]
fn staircases_have_every_step_in_its_cycle() {
    let given = |draw: &mut Draw| {
        Move::Staircase(Staircase {
            distance: Distance::Steps(draw.steps(MAX_STEPS / 6.0) as f64),
            top_speed: Speed::StepsPerSecond(libm::round(draw.magnitude(900.0, 20_000.0))),
            level: 1 + draw.below(5) as u8,
            short_move: draw.of(&[ShortMove::Document, ShortMove::Reverse]),
            ..Staircase::default()
        })
    };
    compare_planned(12, "staircase", given, |_, profile| Some(by_rows(profile)));
}

/// The rows of a staircase's plan, up and down.
fn by_rows(profile: &Profile) -> Ideal {
    let Profile::Staircase(curve) = profile else { panic!("not a staircase") };
    let row = |n| (StaircaseTable::steps_in(n), curve.table().rate(n));
    let up: Vec<(u64, u64)> = (1..=curve.ramp_rows()).map(row).collect();
    let plateau = curve.plateau_rate().map(|rate| (curve.plateau_steps(), rate));
    let rows: Vec<(u64, u64)> = up.iter().copied().chain(plateau).chain(up.iter().rev().copied()).collect();
    ideal::staircase(&rows)
}

#[test]
fn sines_by_segments_have_every_step_in_its_cycle() {
    let given = |draw: &mut Draw| {
        let periods = draw.of(&[1, 2]);
        Move::SineSegments(SineSegments {
            amplitude: Distance::Steps(draw.steps(MAX_STEPS / 24.0) as f64),
            // With round numbers many steps are in the middle between two cycles.
            period_s: if draw.below(2) == 0 {
                draw.of(&[0.5, 1.0, 0.128])
            } else {
                draw.magnitude(1e-3, 86_400.0)
            },
            periods,
            max_deviation: draw.of(&[0.006, 0.0, 0.05, 0.001]),
        })
    };
    compare_planned(13, "sine by segments", given, |given, profile| {
        let Move::SineSegments(given) = given else { panic!("not a sine by segments") };
        Some(by_segments(given, profile))
    });
}

/// The segments of all quarters, from those of a plan's first quarter.
fn by_segments(given: &SineSegments, profile: &Profile) -> Ideal {
    let Profile::SineSegments(curve) = profile else { panic!("not a sine by segments") };
    let quarter: Vec<(i64, i64, u64)> =
        curve.segments().iter().map(|each| (each.from.into(), each.to.into(), each.steps)).collect();
    let mirrored: Vec<(i64, i64, u64)> =
        quarter.iter().rev().map(|&(from, to, steps)| (1024 - to, 1024 - from, steps)).collect();
    let half = [quarter, mirrored].concat();
    let (period, periods) = (decimal(given.period_s), i64::from(given.periods));
    let point = |point: i64| period.clone() * whole(point) / whole(2048);
    let all = (0..2 * periods).flat_map(|index| half.iter().map(move |each| (1024 * index, *each)));
    let intervals = all.map(|(start, (from, to, steps))| (point(start + from), point(start + to), steps));
    ideal::intervals(intervals, period.clone() * whole(periods))
}

#[test]
fn sliced_moves_have_every_step_in_its_cycle() {
    let given = |draw: &mut Draw| {
        let slice_s = draw.of(&[0.001, 0.005, 0.0003]);
        let (ramp, plateau) = (1 + draw.below(100), draw.below(200));
        Move::Cosine(Cosine {
            distance: Distance::Steps(draw.steps(MAX_STEPS / 6.0) as f64),
            duration_s: format!("{:.4}", slice_s * (2 * ramp + plateau) as f64).parse().expect("a number"),
            ramp_s: format!("{:.4}", slice_s * ramp as f64).parse().expect("a number"),
            method: CosineMethod::Sliced,
            slice_s,
            ..Cosine::default()
        })
    };
    compare_planned(14, "sliced", given, |given, profile| {
        let Move::Cosine(given) = given else { panic!("not sliced") };
        by_slices(given, profile)
    });
}

/// The slices of a plan, from their numbers of steps; `None` if these do not determine the duration.
fn by_slices(given: &Cosine, profile: &Profile) -> Option<Ideal> {
    let Profile::Sliced(curve) = profile else { panic!("not sliced") };
    // A shortened slice has fewer steps at the plateau's rate.
    let slices: Vec<Slice> = curve.slices().collect();
    let is_complete = |slice: &Slice| ((slice.to_s - slice.from_s) / given.slice_s - 1.0).abs() < 1e-6;
    let plateau_steps =
        slices.iter().filter(|slice| is_complete(slice)).map(|slice| i64::from(slice.steps)).max()?;
    let slice = decimal(given.slice_s);
    let (mut made, mut intervals) = (0, Vec::new());
    for each in &slices {
        let parts = if is_complete(each) { plateau_steps } else { i64::from(each.steps) };
        let at = |made: i64| slice.clone() * whole(made) / whole(plateau_steps);
        intervals.push((at(made), at(made + parts), each.steps.into()));
        made += parts;
    }
    let duration = intervals.last().expect("there are slices").1.clone();
    ((duration.to_f64() / profile.duration_s() - 1.0).abs() < 1e-9)
        .then(|| ideal::intervals(intervals.into_iter(), duration))
}

/// Also for a slow acceleration to a high speed, which loses digits.
#[test]
fn step_times_of_a_trapezoid_agree_with_its_plan() {
    for (start, top, acceleration) in [(250.0, 4000.0, 9000.0), (0.1, 1e7, 0.3), (1e6, 1.1e6, 7e4)] {
        let given = Trapezoid {
            distance: Distance::Steps(20_001.0),
            start_speed: Some(Speed::StepsPerSecond(start)),
            max_speed: Speed::StepsPerSecond(top),
            max_acceleration: Acceleration::StepsPerSecond2(acceleration),
            method: TrapezoidMethod::Exact,
            timer_hz: 1,
            ..Trapezoid::default()
        };
        let plan = plan_of(vec![Move::Trapezoid(given)]).expect("a valid axis");
        let ideals = [ideal::trapezoid(20_001, start, top, acceleration)];
        let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(0));
        for clock_hz in [16_000_000, 1_000_000_000] {
            Tally::default().compare(&mut draw, &plan, &ideals, clock_hz, "a trapezoid");
            let curve = stepscope_motion::curves::Trapezoid::new(20_001, start, top, acceleration);
            assert!(curve.step_times(clock_hz).eq(plan.due_steps(clock_hz).map(|due| due.cycle)));
            let profile = &plan.moves()[0].profile;
            for (k, cycle) in (1..).zip(curve.step_times(clock_hz)).step_by(500) {
                assert_eq!(profile.step_cycle(k, clock_hz), Some(cycle));
            }
        }
    }
}

#[test]
fn a_step_next_to_an_edge_is_on_the_correct_side() {
    let given = Sine { amplitude: Distance::Steps(-745.0), period_s: 76.239_882_183_001_03, periods: 5 };
    let plan = plan_of(vec![Move::Sine(given)]).expect("a valid axis");
    let due: Vec<u64> = plan.due_steps(16_000_000).map(|due| due.cycle).collect();
    // 4559393802.49999989 cycles, in f64 4559393802.5.
    assert_eq!(due[11_117], 4_559_393_802);
    assert_eq!(plan.moves()[0].profile.step_cycle(11_118, 16_000_000), Some(due[11_117]));
}

/// cos = 1/2 after a sixth of a period: with an odd amplitude A = 2*k - 1 this is the position of step k.
#[test]
fn a_sines_step_between_two_cycles_is_in_the_second() {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(2));
    for _ in 0..500 {
        // T/6 is an odd number of half cycles.
        let halves = 2 * draw.below(50_000_000) + 1;
        let (clock_hz, period_s) = (1_000_000, format!("{}e-6", 3 * halves).parse().expect("a number"));
        let k = draw.below(400) + 1;
        let amplitude = 2 * k - 1;
        let given = Sine { amplitude: Distance::Steps(amplitude as f64), period_s, periods: 3 };
        let Some(plan) = plan_of(vec![Move::Sine(given)]) else { continue };
        for half in 0..6 {
            let step = half * 2 * amplitude + k;
            let twice = halves + 3 * half * halves;
            let found = plan.moves()[0].profile.step_cycle(step, clock_hz);
            assert_eq!(found, Some(twice.div_ceil(2)), "step {step} of {amplitude} in {period_s} s");
        }
    }
}

/// A step just before an edge is in the cycle before it, even if there are thousands of half periods per cycle.
#[test]
fn a_step_is_on_the_correct_side_with_many_half_periods_per_cycle() {
    // With an amplitude of 1, step 2 is due after a third of a period: 2500 us are 1666 half periods of 1.5 us and 1 us.
    for (period_s, cycle) in [(2.999_999_999_999_999e-6, 2), (3e-6, 3), (3.000_000_000_000_001e-6, 3)] {
        let given = Sine { amplitude: Distance::Steps(1.0), period_s, periods: 1000 };
        let plan = plan_of(vec![Move::Sine(given)]).expect("a valid axis");
        assert_eq!(plan.moves()[0].profile.step_cycle(1666 * 2 + 2, 1000), Some(cycle), "{period_s}");
    }
}

/// The cycles of all steps of a curve through points (s, steps), and of a constant rate after it.
fn cycles_through(points: &[(f64, f64)], interpolation: Interpolation, clock_hz: u32) -> Vec<u64> {
    let points = points.iter().map(|&(time_s, position)| Point { time_s, position }).collect();
    let curve = Move::Points(Points { unit: PointUnit::Steps, interpolation, points });
    let plan = plan_of(vec![curve]).expect("a valid axis");
    plan.due_steps(clock_hz).map(|due| due.cycle).collect()
}

#[test]
fn a_slow_step_after_a_long_travel_has_its_exact_cycle() {
    const GHZ: u32 = 1_000_000_000;
    for (travel, last) in [
        (20_000.3, 17_360_000_000_000),
        (40_000.3, 17_360_000_000_000),
        (99_999.7, 69_140_000_000_000),
        (300_000.3, 17_360_000_000_000),
    ] {
        let found = cycles_through(
            &[(0.0, 0.0), (100.0, travel), (86_400.0, travel + 1.0)],
            Interpolation::Straight,
            GHZ,
        );
        assert_eq!(found.last(), Some(&last), "after {travel} steps");
    }
    // A short piece between long ones, whose slope is that of two late times.
    let short = [(0.0, 0.0), (43_200.0, 1000.0), (43_200.001, 1000.00002), (86_400.0, 2000.0)];
    let found = cycles_through(&short, Interpolation::Smooth, GHZ);
    assert_eq!((found.len(), found[0]), (2000, 663_666_033_433));
}

#[test]
fn a_tie_is_rounded_up_far_from_the_first_point() {
    for (points, tie) in [
        ([(0.0, 0.0), (47.0, 50_809.8), (21_914.202_325, 50_808.8)], 6_607_160_698),
        ([(0.0, 0.0), (43.0, 44_285.6), (61_527.296_755, 44_284.6)], 6_191_429_676),
    ] {
        let found = cycles_through(&points, Interpolation::Straight, 1_000_000);
        assert_eq!(found.last(), Some(&tie), "{points:?}");
    }
}

#[test]
fn a_position_slightly_below_a_half_has_no_step() {
    let found = cycles_through(&[(0.0, 1e-17), (1.0, 10.5)], Interpolation::Straight, 16_000_000);
    assert_eq!(found.len(), 10);
}

#[test]
fn a_move_after_points_begins_when_their_decimals_end() {
    let points = vec![
        Point { time_s: 0.123_456_789_012_34, position: 0.0 },
        Point { time_s: 86_400.1, position: 1.0 },
    ];
    let curve =
        Move::Points(Points { unit: PointUnit::Steps, interpolation: Interpolation::Straight, points });
    let rate =
        Move::Constant(Constant { distance: Distance::Steps(3000.0), speed: Speed::StepsPerSecond(977.3) });
    let plan = plan_of(vec![curve, rate]).expect("a valid axis");
    let found: Vec<u64> = plan.due_steps(1_000_000_000).map(|due| due.cycle).collect();
    assert_eq!((found.len(), found[16]), (3001, 86_399_992_403_233));
}
