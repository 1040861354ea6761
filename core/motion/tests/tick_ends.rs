//! Steps that are due in the very instant in which a tick ends (DESIGN B7): one to the right belongs to that tick, one to
//! the left to the next, for every kind of motion.

#![allow(clippy::expect_used, clippy::panic, reason = "what cannot be planned fails the test")]

use stepscope_motion::{
    mechanics::{Acceleration, Distance, Speed},
    moves::{
        Axis, Constant, Dwell, Interpolation, Move, Point, PointUnit, Points, Staircase, Trapezoid,
        TrapezoidMethod,
    },
    plan_axis,
    quantise::{AxesPath, ticks},
};

/// Steps of each tick of 1 ms, left negative.
fn steps_of_ticks(moves: Vec<Move>) -> Vec<i64> {
    let plan = plan_axis(&Axis { moves, ..Axis::default() }, "x").expect("it can be planned");
    let orders = ticks(&[plan], AxesPath::MOTION, 1, 100, 16_000, 16_000_000).expect("no tick is too full");
    let steps = |order: &u8| if order & 0x80 == 0 { -i64::from(*order) } else { i64::from(order & 0x7f) };
    orders.bytes().iter().map(steps).collect()
}

/// Three steps a millisecond apart, the first at 1 ms.
fn by_table(steps: f64) -> [Move; 2] {
    let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(1000.0));
    [
        Move::Trapezoid(Trapezoid {
            distance: distance.clone(),
            start_speed: speed.clone(),
            top_speed: speed.clone(),
            acceleration: Acceleration::StepsPerSecond2(1000.0),
            method: TrapezoidMethod::Table,
            timer_hz: 1_000_000,
        }),
        Move::Staircase(Staircase { distance, top_speed: speed, ..Staircase::default() }),
    ]
}

#[test]
fn of_a_table_too_one_to_the_right_is_made_in_the_tick_and_one_to_the_left_in_the_next() {
    for made in by_table(3.0) {
        assert_eq!(steps_of_ticks(vec![made.clone()]), [1, 1, 1], "{made:?}");
    }
    for made in by_table(-3.0) {
        assert_eq!(steps_of_ticks(vec![made.clone()]), [0, -1, -1, -1], "{made:?}");
    }
}

#[test]
fn the_last_step_of_a_table_to_the_left_waits_for_the_move_after_it() {
    let dwell = Move::Dwell(Dwell { duration_s: 0.002 });
    for (there, back) in by_table(-3.0).into_iter().zip(by_table(3.0)) {
        let moves = vec![there.clone(), dwell.clone(), back.clone()];
        assert_eq!(steps_of_ticks(moves), [0, -1, -1, -1, 0, 1, 1, 1], "{there:?}");
        assert_eq!(
            steps_of_ticks(vec![there.clone(), there]),
            [0, -1, -1, -1, -1, -1, -1],
            "one after another"
        );
    }
}

#[test]
fn curves_do_the_same() {
    let constant = |steps| {
        Move::Constant(Constant { distance: Distance::Steps(steps), speed: Speed::StepsPerSecond(500.0) })
    };
    // Steps at 1, 3, 5 ms.
    assert_eq!(steps_of_ticks(vec![constant(3.0)]), [1, 0, 1, 0, 1, 0]);
    assert_eq!(steps_of_ticks(vec![constant(-3.0)]), [0, -1, 0, -1, 0, -1]);
    let points = |to| {
        let points = vec![Point { time_s: 0.0, position: 0.0 }, Point { time_s: 0.006, position: to }];
        Move::Points(Points { unit: PointUnit::Steps, interpolation: Interpolation::Straight, points })
    };
    assert_eq!(steps_of_ticks(vec![points(3.0)]), [1, 0, 1, 0, 1, 0]);
    assert_eq!(steps_of_ticks(vec![points(-3.0)]), [0, -1, 0, -1, 0, -1]);
}
