//! Properties of every motion, its ticks and its segments (DESIGN B1, B7, B8), for random axes.

use crate::moves::{CLOCK_HZ, plan, ramp_shape, sane_move, short_move};
use proptest::prelude::*;
use std::sync::Arc;
use stepscope_core::{
    motion::{
        AxisPlan, Profile,
        mechanics::{Acceleration, Direct, Distance, Jerk, Mechanics, Speed},
        moves::{
            Axis, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, Move, Point, PointUnit,
            Points, Ramps, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
        },
        plan_axis, round_half_up,
        step_tables::{AxesPath, exact_segments, ticks},
    },
    peripheral::{
        device::SegmentEngine,
        segment::PulseTimes,
        signal::Record,
        trace::steps,
        units::{Cycles, Instant},
    },
};

/// Any number, often an extreme one.
fn number() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![
        any::<f64>(),
        prop::sample::select(vec![
            0.0,
            -0.0,
            1e300,
            -1e300,
            5e-324,
            1e-300,
            f64::NAN,
            f64::INFINITY,
            0.5,
            1e7,
            1e9,
            86_400.0,
            1e-6
        ]),
        -10.0..1e4_f64,
    ]
}

/// Any value of the type.
fn wild_move() -> impl Strategy<Value = Move> {
    let distance = number().prop_flat_map(|x| {
        prop::sample::select(vec![Distance::Steps(x), Distance::Millimeters(x), Distance::Degrees(x)])
    });
    let speed = number().prop_flat_map(|x| {
        prop::sample::select(vec![
            Speed::StepsPerSecond(x),
            Speed::MillimetersPerSecond(x),
            Speed::TurnsPerMinute(x),
        ])
    });
    let method = prop_oneof![Just(TrapezoidMethod::Table), Just(TrapezoidMethod::Exact)];
    prop_oneof![
        (distance.clone(), number(), number(), any::<bool>(), number()).prop_map(
            |(distance, duration_s, ramp_s, sliced, slice_s)| {
                let method = if sliced { CosineMethod::Sliced } else { CosineMethod::Exact };
                Move::Cosine(Cosine { distance, duration_s, ramp_s, method, slice_s, ..Cosine::default() })
            }
        ),
        (distance.clone(), number(), number(), ramp_shape(), number()).prop_map(
            |(distance, duration_s, ramp_s, shape, parameter)| {
                Move::Ramps(Ramps { distance, duration_s, ramp_s, ..Ramps::shaped(shape, parameter) })
            }
        ),
        (distance.clone(), speed.clone(), speed.clone(), number(), method, any::<u32>()).prop_map(
            |(distance, start_speed, top_speed, acceleration, method, timer_hz)| {
                let acceleration = Acceleration::StepsPerSecond2(acceleration);
                Move::Trapezoid(Trapezoid {
                    distance,
                    start_speed: Some(start_speed),
                    max_speed: top_speed,
                    max_acceleration: acceleration,
                    method,
                    timer_hz,
                    ..Trapezoid::default()
                })
            }
        ),
        (distance.clone(), speed.clone(), 0..=6_u8, any::<bool>(), speed.clone(), speed.clone()).prop_map(
            |(distance, top_speed, level, turns, start_speed, max_speed)| {
                let short_move = short_move(turns);
                Move::Staircase(Staircase { distance, top_speed, level, short_move, start_speed, max_speed })
            }
        ),
        (distance.clone(), number(), any::<u32>(), number()).prop_map(
            |(amplitude, period_s, periods, max_deviation)| {
                Move::SineSegments(SineSegments { amplitude, period_s, periods, max_deviation })
            }
        ),
        (distance.clone(), number(), any::<u32>())
            .prop_map(|(amplitude, period_s, periods)| { Move::Sine(Sine { amplitude, period_s, periods }) }),
        (distance.clone(), speed.clone(), number(), number()).prop_map(
            |(distance, max_speed, acceleration, jerk)| {
                Move::JerkLimited(JerkLimited {
                    distance,
                    max_speed,
                    max_acceleration: Acceleration::StepsPerSecond2(acceleration),
                    max_jerk: Jerk::StepsPerSecond3(jerk),
                    ..JerkLimited::default()
                })
            }
        ),
        (prop::collection::vec((number(), number()), 0..6), any::<bool>(), any::<bool>()).prop_map(
            |(points, smooth, rises)| {
                let mut points: Vec<Point> =
                    points.into_iter().map(|(time_s, position)| Point { time_s, position }).collect();
                if rises {
                    points.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
                }
                let interpolation = if smooth { Interpolation::Smooth } else { Interpolation::Straight };
                Move::Points(Points { unit: PointUnit::Steps, interpolation, points })
            }
        ),
        (distance, speed).prop_map(|(distance, speed)| Move::Constant(Constant { distance, speed })),
        number().prop_map(|duration_s| Move::Dwell(Dwell { duration_s })),
    ]
}

/// The mirror image.
fn mirrored(given: &Move) -> Move {
    let back = |distance: &Distance| Distance::Steps(-distance.value());
    match given.clone() {
        Move::Cosine(m) => Move::Cosine(Cosine { distance: back(&m.distance), ..m }),
        Move::Ramps(m) => Move::Ramps(Ramps { distance: back(&m.distance), ..m }),
        Move::Trapezoid(m) => Move::Trapezoid(Trapezoid { distance: back(&m.distance), ..m }),
        Move::Staircase(m) => Move::Staircase(Staircase { distance: back(&m.distance), ..m }),
        Move::SineSegments(m) => Move::SineSegments(SineSegments { amplitude: back(&m.amplitude), ..m }),
        Move::Sine(m) => Move::Sine(Sine { amplitude: back(&m.amplitude), ..m }),
        Move::JerkLimited(m) => Move::JerkLimited(JerkLimited { distance: back(&m.distance), ..m }),
        Move::Points(m) => {
            let points = m.points.iter().map(|point| Point { position: -point.position, ..*point });
            Move::Points(Points { points: points.collect(), ..m })
        }
        Move::Constant(m) => Move::Constant(Constant { distance: back(&m.distance), ..m }),
        Move::Retarget(m) => Move::Retarget(m),
        Move::Dwell(m) => Move::Dwell(m),
    }
}

/// Signed steps of each tick of channel 0.
fn counts(plan: &AxisPlan, tick_cycles: u64) -> Vec<i64> {
    let made = ticks(std::slice::from_ref(plan), AxesPath::MOTION, 1, 127, tick_cycles, CLOCK_HZ);
    let made = made.unwrap_or_else(|problems| panic!("{problems:?}"));
    made.bytes().iter().map(|byte| i64::from(byte & 127) * if byte & 128 == 0 { -1 } else { 1 }).collect()
}

fn is_table(profile: &Profile) -> bool {
    matches!(profile, Profile::TrapezoidTable(_) | Profile::Staircase(_))
}

/// Whether a table to the left ends at `t`, except for the last digits of f64: its last step is due at that time, so it
/// belongs to the tick after it (B7).
fn last_step_may_wait(plan: &AxisPlan, t: f64) -> bool {
    plan.moves().iter().any(|planned| {
        let end_s = planned.start_s + planned.profile.duration_s();
        is_table(&planned.profile) && planned.profile.steps() < 0 && (end_s - t).abs() <= 1e-14 * t
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_end_is_exact_and_errors_are_at_most_half_a_step(
        moves in prop::collection::vec(sane_move(), 1..5), tick_cycles in 2000..4000_u64,
    ) {
        let plan = plan(moves);
        let mut made = 0;
        let counts = counts(&plan, tick_cycles);
        for (tick, count) in (1_u64..).zip(&counts) {
            made += count;
            let t = (tick * tick_cycles) as f64 / f64::from(CLOCK_HZ);
            // The curve of a table passes the position of a step by a jump; `t` may be on either side of it.
            let by_table = plan.moves().iter().any(|planned| is_table(&planned.profile));
            let most = if by_table { 0.5 + 1e-6 } else { 0.5 + 1e-9 };
            let error = |waiting: i64| plan.position(t) - (made - waiting) as f64;
            let waits = last_step_may_wait(&plan, t) && error(1).abs() <= most;
            prop_assert!(error(0).abs() <= most || waits, "{} after tick {tick}", error(0));
        }
        prop_assert_eq!(made, plan.steps());
        // The last tick is needed, because the axis ends in it.
        let before = ((counts.len() as u64 - 1) * tick_cycles) as f64 / f64::from(CLOCK_HZ);
        prop_assert!(before == 0.0 || before < plan.duration_s() || last_step_may_wait(&plan, before));
    }

    #[test]
    fn steps_are_due_where_the_curve_crosses_half_integers(
        moves in prop::collection::vec(sane_move(), 1..4),
    ) {
        let plan = plan(moves);
        let mut made = 0.0;
        let seconds = |cycle: f64| cycle / f64::from(CLOCK_HZ);
        for due in plan.due_steps(CLOCK_HZ) {
            let way = if due.right { 1.0 } else { -1.0 };
            let past = |t: f64| (plan.position(t) - made) * way - 0.5;
            let (before, after) = (past(seconds(due.cycle as f64 - 1.0)), past(seconds(due.cycle as f64 + 1.0)));
            prop_assert!(before < 1e-6 && after > -1e-6, "{made} {due:?}: {before} {after}");
            made += way;
        }
        prop_assert_eq!(made, plan.steps() as f64);
    }

    #[test]
    fn an_exact_table_has_every_step_in_its_cycle(
        moves in prop::collection::vec(sane_move(), 1..4), other in sane_move(),
    ) {
        let plans = [plan(moves), plan(vec![other])];
        let pulse = PulseTimes { width: Cycles(1), setup: Cycles(1), hold: Cycles(0) };
        // If the extreme of a reversal just crosses a half-integer, a step and its return are due at once.
        let due: Vec<Vec<_>> = plans.iter().map(|plan| plan.due_steps(CLOCK_HZ).collect()).collect();
        let at_once = due.iter().flat_map(|due| due.windows(2)).any(|pair| {
            pair[0].right != pair[1].right && pair[1].cycle - pair[0].cycle < pulse.min_interval().0
        });
        let lists = match exact_segments(&plans, AxesPath::MOTION, 2, pulse, CLOCK_HZ) {
            Ok(lists) => lists,
            Err(problems) => {
                prop_assert!(at_once, "{problems:?}");
                return Ok(());
            }
        };
        prop_assert!(!at_once, "what comes at once is refused");
        prop_assert_eq!(lists.steps(), plans[0].step_count() + plans[1].step_count());
        let mut trace: Vec<Record> = Vec::new();
        let mut engine = SegmentEngine::new(Arc::new(lists));
        engine.run(Instant::NEVER, &mut trace);
        for (channel, plan) in (0..).zip(&plans) {
            let made = steps(&trace, channel);
            let cycles = made.iter().map(|step| step.cycle);
            prop_assert!(cycles.eq(plan.due_steps(CLOCK_HZ).map(|due| 1 + due.cycle)));
            prop_assert_eq!(i64::from(engine.positions()[usize::from(channel)]), plan.steps());
        }
    }

    #[test]
    fn a_move_in_one_direction_never_reverses(
        given in sane_move().prop_filter("goes one way", |m| !matches!(m, Move::SineSegments(_) | Move::Sine(_) | Move::Points(_))),
        tick_cycles in 300..4000_u64,
    ) {
        let plan = plan(vec![given]);
        let way = plan.steps().signum();
        let counts = counts(&plan, tick_cycles);
        prop_assert!(counts.iter().all(|count| count * way >= 0));
    }

    #[test]
    fn right_and_left_are_mirror_images(
        moves in prop::collection::vec(sane_move(), 1..4), tick_cycles in 2000..4000_u64,
    ) {
        let back = plan(moves.iter().map(mirrored).collect());
        let forth = plan(moves);
        let (mut right, mut left) = (0, 0);
        for (tick, (r, l)) in (1_u64..).zip(counts(&forth, tick_cycles).iter().zip(counts(&back, tick_cycles))) {
            (right, left) = (right + r, left + l);
            let t = (tick * tick_cycles) as f64 / f64::from(CLOCK_HZ);
            let x = forth.position(t);
            prop_assert_eq!(x, -back.position(t));
            // Halves round up on both sides of 0, so at exact halves the two differ by one. They also differ at the
            // end of a table, whose last step to the left is in the next tick (B7).
            let is_half = (x - x.floor() - 0.5).abs() < 1e-6;
            let ends = last_step_may_wait(&forth, t) || last_step_may_wait(&back, t);
            let differ = right + left;
            prop_assert!(differ == 0 || (differ == 1 && (is_half || ends)), "{differ}: {x} at tick {tick}");
        }
    }

    #[test]
    fn steps_are_due_where_the_rounded_position_changes(
        moves in prop::collection::vec(sane_move(), 1..4), parts in prop::collection::vec(-0.1..1.1, 1..50),
    ) {
        let plan = plan(moves);
        for part in parts {
            let t = plan.duration_s() * part;
            prop_assert_eq!(plan.steps_due(t), round_half_up(plan.position(t)));
            prop_assert!(plan.speed(t).abs() <= plan.peaks().speed * (1.0 + 1e-12));
            prop_assert!(plan.acceleration(t).abs() <= plan.peaks().acceleration * (1.0 + 1e-12));
        }
    }

    #[test]
    fn no_axis_panics(
        moves in prop::collection::vec(wild_move(), 0..6), step_mm in number(), times in prop::collection::vec(number(), 8),
        tick_cycles in any::<u64>(), clock_hz in any::<u32>(), slots in any::<u8>(),
    ) {
        for mechanics in [Mechanics::default(), Mechanics::Direct(Direct { step_mm })] {
            match plan_axis(&Axis { mechanics, moves: moves.clone(), ..Axis::default() }, "axis") {
                Ok(plan) => {
                    prop_assert!(plan.duration_s() <= 1e6 && plan.duration_s() >= 0.0);
                    prop_assert_eq!(plan.position(plan.duration_s()), plan.steps() as f64);
                    for &t in &times {
                        let _ = (plan.position(t), plan.speed(t), plan.acceleration(t), plan.steps_due(t));
                    }
                    for planned in plan.moves() {
                        if let Profile::Trapezoid(curve) = &planned.profile {
                            prop_assert!(curve.step_times(clock_hz).take(9).is_sorted());
                        }
                        let _ = planned.profile.peaks();
                    }
                    let first = plan.due_steps(clock_hz).take(2000).map(|due| due.cycle);
                    prop_assert!(first.is_sorted());
                    let pulse = PulseTimes { width: Cycles(1), setup: Cycles(0), hold: Cycles(0) };
                    if plan.step_count() <= 20_000 {
                        let _ = exact_segments(std::slice::from_ref(&plan), AxesPath::MOTION, 1, pulse, clock_hz);
                    }
                    let few_ticks = plan.duration_s() / 1000.0 * f64::from(clock_hz);
                    let _ = ticks(&[plan], AxesPath::MOTION, 1, slots, tick_cycles.max(few_ticks as u64), clock_hz);
                }
                Err(problems) => {
                    prop_assert!(!problems.is_empty());
                    for problem in problems {
                        prop_assert!(problem.path.starts_with("axis."), "{}", problem);
                    }
                }
            }
        }
    }
}
