//! Steps that are due in the very instant in which a tick ends (DESIGN B7): one to the right belongs to that tick, one to
//! the left to the next, for every kind of motion.

use stepscope_motion::{
    Profile,
    mechanics::{Acceleration, Distance, Speed},
    moves::{
        Axis, Constant, Dwell, Interpolation, Move, Point, PointUnit, Points, Staircase, Trapezoid,
        TrapezoidMethod,
    },
    plan_axis,
    step_tables::{AxesPath, ticks},
};

/// Steps of each tick of 1 ms, left negative.
fn steps_of_ticks(moves: Vec<Move>) -> Vec<i64> {
    let plan = plan_axis(&Axis { moves, ..Axis::default() }, "x").expect("it can be planned");
    let commands = ticks(&[plan], AxesPath::MOTION, 1, 100, 16_000, 16_000_000).expect("no tick is too full");
    let steps = |order: &u8| if order & 0x80 == 0 { -i64::from(*order) } else { i64::from(order & 0x7f) };
    commands.bytes().iter().map(steps).collect()
}

/// Three steps a millisecond apart, the first at 1 ms.
fn by_table(steps: f64) -> [Move; 2] {
    let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(1000.0));
    [
        Move::Trapezoid(Trapezoid {
            distance: distance.clone(),
            start_speed: speed.clone(),
            max_speed: speed.clone(),
            max_acceleration: Acceleration::StepsPerSecond2(1000.0),
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

/// Draws whole numbers, the same each time.
fn drawn(state: &mut u64, from: u64, to: u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    from + (*state >> 33) % (to - from)
}

/// Steps of whole rates and of timers' tables, after a dwell of whole microseconds: step k is due after over/under of a
/// cycle, in whole numbers.
#[test]
fn by_every_cycle_as_many_are_due_as_whole_numbers_say() {
    const CLOCK_HZ: u32 = 1_000_003;
    let mut state = 1;
    for round in 0..400 {
        let dwell_us = drawn(&mut state, 0, 1000);
        let (count, rate) = (drawn(&mut state, 1, 60), drawn(&mut state, 1000, 400_000));
        let steps = if round % 2 == 0 { count as f64 } else { -(count as f64) };
        let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(rate as f64));
        let timer_hz = drawn(&mut state, 400_000, 4_000_000) as u32;
        let (moved, by_table) = match round % 4 {
            0 | 1 => (Move::Constant(Constant { distance, speed }), false),
            _ => {
                let trapezoid = Trapezoid {
                    distance,
                    start_speed: speed.clone(),
                    max_speed: speed,
                    max_acceleration: Acceleration::StepsPerSecond2(1000.0),
                    method: TrapezoidMethod::Table,
                    timer_hz,
                };
                (Move::Trapezoid(trapezoid), true)
            }
        };
        let dwell = Move::Dwell(Dwell { duration_s: dwell_us as f64 / 1e6 });
        let axis = Axis { moves: vec![dwell, moved], ..Axis::default() };
        let plan = plan_axis(&axis, "x").expect("it can be planned");
        // In parts of a cycle: dwell_us*clock/10^6 and the step's own.
        let (dwell, clock) = (u128::from(dwell_us) * u128::from(CLOCK_HZ), u128::from(CLOCK_HZ));
        let own = |k: u64| match &plan.moves()[1].profile {
            Profile::TrapezoidTable(table) => (u128::from(table.step_ticks(k)) * clock, u128::from(timer_hz)),
            _ => (u128::from(2 * k - 1) * clock, u128::from(2 * rate)),
        };
        let is_due = |k: u64, cycle: u64| {
            let (over, under) = own(k);
            let (since, at) = (dwell * under + over * 1_000_000, u128::from(cycle) * under * 1_000_000);
            if steps > 0.0 { since <= at } else { since < at }
        };
        let mut due_by = plan.due_by(CLOCK_HZ);
        for cycle in 0..4000 {
            let due = (1..=count).take_while(|k| is_due(*k, cycle)).count() as i64;
            let due = if steps > 0.0 { due } else { -due };
            assert_eq!(due_by.steps(cycle), due, "by cycle {cycle}, by table {by_table}, {axis:?}");
        }
    }
}

/// A step due in the instant in which a tick ends and a move with it, after moves whose lengths f64 does not add exactly.
#[test]
fn of_moves_in_a_row_too_the_tick_is_that_of_the_exact_time() {
    let dwell = |duration_s| Move::Dwell(Dwell { duration_s });
    let constant = |steps| {
        Move::Constant(Constant { distance: Distance::Steps(steps), speed: Speed::StepsPerSecond(500.0) })
    };
    // 0.1 + 0.2 + 0.7 = 1 s, in f64 a little more or less in between; steps at 1.001, 1.003 s.
    for (there, expected) in [(2.0, [1, 0, 1, 0]), (-2.0, [0, -1, 0, -1])] {
        let moves = [0.1, 0.2, 0.7].map(dwell).into_iter().chain([constant(there)]).collect();
        let ticks = steps_of_ticks(moves);
        assert_eq!(ticks.len(), 1004);
        assert_eq!(ticks[1000..], expected);
    }
}
