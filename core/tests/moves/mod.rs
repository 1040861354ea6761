//! Moves for the property tests of motions and of their tables.
#![allow(dead_code, reason = "each test file uses some of it")]

use proptest::prelude::*;
use stepscope_core::motion::{
    AxisPlan,
    mechanics::{Acceleration, Distance, Jerk, Speed},
    moves::{
        Axis, Constant, Cosine, CosineMethod, Dwell, Interpolation, JerkLimited, Move, Point, PointUnit,
        Points, RampShape, Ramps, ShortMove, Sine, SineSegments, Staircase, Trapezoid, TrapezoidMethod,
    },
    plan_axis,
};

pub(crate) const CLOCK_HZ: u32 = 16_000_000;

/// Realistic moves of up to some thousand steps.
pub(crate) fn sane_move() -> impl Strategy<Value = Move> {
    let steps = prop_oneof![-3000_i32..=-1, 1..=3000_i32].prop_map(|n| Distance::Steps(n.into()));
    let method = prop_oneof![Just(TrapezoidMethod::Table), Just(TrapezoidMethod::Exact)];
    prop_oneof![
        (steps.clone(), 0.02..2.0, 0.0..=0.5).prop_map(|(distance, duration_s, ramp)| {
            Move::Cosine(Cosine { distance, duration_s, ramp_s: duration_s * ramp, ..Cosine::default() })
        }),
        // At least ten slices of three steps each.
        (100..=3000_i32, any::<bool>(), 0.0..=0.5, 0.001..=0.003).prop_map(
            |(steps, right, ramp, slice_s)| {
                let duration_s = f64::from(steps) * 0.0003;
                let distance = Distance::Steps(f64::from(if right { steps } else { -steps }));
                let (ramp_s, method) = (duration_s * ramp, CosineMethod::Sliced);
                Move::Cosine(Cosine { distance, duration_s, ramp_s, method, slice_s, ..Cosine::default() })
            }
        ),
        (steps.clone(), 0.02..2.0, 0.0..=0.5, ramp_shape(), 0.1..=20.0).prop_map(
            |(distance, duration_s, ramp, shape, parameter)| {
                let ramp_s = duration_s * ramp;
                Move::Ramps(Ramps { distance, duration_s, ramp_s, ..Ramps::shaped(shape, parameter) })
            }
        ),
        (steps.clone(), 100.0..2000.0, 0.0..4000.0, 1.0..1e5, method).prop_map(
            |(distance, start, climb, acceleration, method)| {
                Move::Trapezoid(Trapezoid {
                    distance,
                    start_speed: Some(Speed::StepsPerSecond(start)),
                    max_speed: Speed::StepsPerSecond(start + climb),
                    max_acceleration: Acceleration::StepsPerSecond2(acceleration),
                    method,
                    timer_hz: 1_000_000,
                    ..Trapezoid::default()
                })
            }
        ),
        (steps.clone(), 1..=5_u8, 500..20_000_u32, any::<bool>()).prop_map(
            |(distance, level, top, turns)| {
                Move::Staircase(Staircase {
                    distance,
                    level,
                    top_speed: Speed::StepsPerSecond(top.into()),
                    short_move: short_move(turns),
                    ..Staircase::default()
                })
            }
        ),
        (steps.clone(), 0.05..2.0, 1..4_u32, 0.002..0.1).prop_map(
            |(amplitude, period_s, periods, max_deviation)| {
                Move::SineSegments(SineSegments { amplitude, period_s, periods, max_deviation })
            }
        ),
        (steps.clone(), 0.05..2.0, 1..4_u32)
            .prop_map(|(amplitude, period_s, periods)| { Move::Sine(Sine { amplitude, period_s, periods }) }),
        (steps.clone(), 100.0..1e4, 1e3..1e6, 1e3..1e8).prop_map(|(distance, speed, acceleration, jerk)| {
            Move::JerkLimited(JerkLimited {
                distance,
                max_speed: Speed::StepsPerSecond(speed),
                max_acceleration: Acceleration::StepsPerSecond2(acceleration),
                max_jerk: Jerk::StepsPerSecond3(jerk),
                ..JerkLimited::default()
            })
        }),
        curve(),
        (steps, 100.0..1e4).prop_map(|(distance, speed)| {
            Move::Constant(Constant { distance, speed: Speed::StepsPerSecond(speed) })
        }),
        (0.0..1.0).prop_map(|duration_s| Move::Dwell(Dwell { duration_s })),
    ]
}

pub(crate) fn ramp_shape() -> impl Strategy<Value = RampShape> {
    use RampShape::{Bezier, Exponential, Sigmoid, Straight};
    prop::sample::select(vec![Sigmoid, Bezier, Straight, Exponential])
}

/// A curve through a few realistic points, some of them on whole and half steps.
fn curve() -> impl Strategy<Value = Move> {
    let position = prop_oneof![-500.0..500.0, (-20..20).prop_map(|half| f64::from(half) / 2.0)];
    let interpolation = prop_oneof![Just(Interpolation::Straight), Just(Interpolation::Smooth)];
    let rest = prop::collection::vec((0.05..0.5, position), 0..8);
    (rest, interpolation, prop_oneof![Just(0.0), -1e3..1e3]).prop_map(|(rest, interpolation, start_s)| {
        // The first distance is more than one step, so that the move has a step.
        let mut points = vec![(start_s, 3.25), (start_s + 0.1, 5.0)];
        for (later_s, position) in rest {
            let last_s = points[points.len() - 1].0;
            points.push((last_s + later_s, position));
        }
        let points = points.into_iter().map(|(time_s, position)| Point { time_s, position }).collect();
        Move::Points(Points { unit: PointUnit::Steps, interpolation, points })
    })
}

pub(crate) fn short_move(turns: bool) -> ShortMove {
    if turns { ShortMove::Reverse } else { ShortMove::Document }
}

/// The plan of moves that have no problems.
pub(crate) fn plan(moves: Vec<Move>) -> AxisPlan {
    let axis = Axis { moves, ..Axis::default() };
    plan_axis(&axis, "axis").unwrap_or_else(|problems| panic!("{axis:?}: {problems:?}"))
}
