//! Steps that are due exactly at the end of a tick (DESIGN B7): a step to the right belongs to that tick, a step to the left to
//! the next one, for every kind of motion.

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

/// Steps of each tick of 1 ms, negative to the left.
fn steps_of_ticks(moves: Vec<Move>) -> Vec<i64> {
    let plan = plan_axis(&Axis { moves, ..Axis::default() }, "x").expect("a valid axis");
    let commands = ticks(&[plan], AxesPath::MOTION, 1, 100, 16_000, 16_000_000).expect("no tick is too full");
    let steps = |byte: &u8| if byte & 0x80 == 0 { -i64::from(*byte) } else { i64::from(byte & 0x7f) };
    commands.bytes().iter().map(steps).collect()
}

/// Moves with one step per millisecond, the first at 1 ms.
fn by_table(steps: f64) -> [Move; 2] {
    let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(1000.0));
    [
        Move::Trapezoid(Trapezoid {
            distance: distance.clone(),
            start_speed: Some(speed.clone()),
            max_speed: speed.clone(),
            max_acceleration: Acceleration::StepsPerSecond2(1000.0),
            method: TrapezoidMethod::Table,
            timer_hz: 1_000_000,
            ..Trapezoid::default()
        }),
        Move::Staircase(Staircase { distance, top_speed: speed, ..Staircase::default() }),
    ]
}

#[test]
fn table_steps_to_the_right_are_in_the_tick_and_to_the_left_in_the_next() {
    for made in by_table(3.0) {
        assert_eq!(steps_of_ticks(vec![made.clone()]), [1, 1, 1], "{made:?}");
    }
    for made in by_table(-3.0) {
        assert_eq!(steps_of_ticks(vec![made.clone()]), [0, -1, -1, -1], "{made:?}");
    }
}

#[test]
fn the_last_table_step_to_the_left_is_in_the_first_tick_of_the_next_move() {
    let dwell = Move::Dwell(Dwell { duration_s: 0.002 });
    for (there, back) in by_table(-3.0).into_iter().zip(by_table(3.0)) {
        let moves = vec![there.clone(), dwell.clone(), back.clone()];
        assert_eq!(steps_of_ticks(moves), [0, -1, -1, -1, 0, 1, 1, 1], "{there:?}");
        assert_eq!(
            steps_of_ticks(vec![there.clone(), there]),
            [0, -1, -1, -1, -1, -1, -1],
            "two moves to the left"
        );
    }
}

#[test]
fn steps_of_curves_follow_the_same_rule() {
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

/// A pseudo-random integer from `from` to below `to`.
fn random(state: &mut u64, from: u64, to: u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    from + (*state >> 33) % (to - from)
}

/// Integer rates and timer tables, after a dwell of whole microseconds: step k is due after numerator/denominator cycles.
#[test]
fn steps_due_agree_with_integer_arithmetic() {
    const CLOCK_HZ: u32 = 1_000_003;
    let mut state = 1;
    for round in 0..400 {
        let dwell_us = random(&mut state, 0, 1000);
        let (count, rate) = (random(&mut state, 1, 60), random(&mut state, 1000, 400_000));
        let steps = if round % 2 == 0 { count as f64 } else { -(count as f64) };
        let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(rate as f64));
        let timer_hz = random(&mut state, 400_000, 4_000_000) as u32;
        let (moved, by_table) = match round % 4 {
            0 | 1 => (Move::Constant(Constant { distance, speed }), false),
            _ => {
                let trapezoid = Trapezoid {
                    distance,
                    start_speed: Some(speed.clone()),
                    max_speed: speed,
                    max_acceleration: Acceleration::StepsPerSecond2(1000.0),
                    method: TrapezoidMethod::Table,
                    timer_hz,
                    ..Trapezoid::default()
                };
                (Move::Trapezoid(trapezoid), true)
            }
        };
        let dwell = Move::Dwell(Dwell { duration_s: dwell_us as f64 / 1e6 });
        let axis = Axis { moves: vec![dwell, moved], ..Axis::default() };
        let plan = plan_axis(&axis, "x").expect("a valid axis");
        // The dwell takes dwell_us*clock/10^6 cycles.
        let (dwell, clock) = (u128::from(dwell_us) * u128::from(CLOCK_HZ), u128::from(CLOCK_HZ));
        let time_in_move = |k: u64| match &plan.moves()[1].profile {
            Profile::TrapezoidTable(table) => (u128::from(table.step_ticks(k)) * clock, u128::from(timer_hz)),
            _ => (u128::from(2 * k - 1) * clock, u128::from(2 * rate)),
        };
        let is_due = |k: u64, cycle: u64| {
            let (numerator, denominator) = time_in_move(k);
            let time = dwell * denominator + numerator * 1_000_000;
            let cycle_time = u128::from(cycle) * denominator * 1_000_000;
            if steps > 0.0 { time <= cycle_time } else { time < cycle_time }
        };
        let mut due_by = plan.due_by(CLOCK_HZ);
        for cycle in 0..4000 {
            let due = (1..=count).take_while(|k| is_due(*k, cycle)).count() as i64;
            let due = if steps > 0.0 { due } else { -due };
            assert_eq!(due_by.steps(cycle), due, "by cycle {cycle}, by table {by_table}, {axis:?}");
        }
    }
}

/// A step due at the end of a tick and of a move, after moves whose durations f64 does not add exactly.
#[test]
fn the_tick_follows_from_exact_times_of_consecutive_moves() {
    let dwell = |duration_s| Move::Dwell(Dwell { duration_s });
    let constant = |steps| {
        Move::Constant(Constant { distance: Distance::Steps(steps), speed: Speed::StepsPerSecond(500.0) })
    };
    // 0.1 + 0.2 + 0.7 = 1 s with rounding errors in f64; steps at 1.001 and 1.003 s.
    for (there, expected) in [(2.0, [1, 0, 1, 0]), (-2.0, [0, -1, 0, -1])] {
        let moves = [0.1, 0.2, 0.7].map(dwell).into_iter().chain([constant(there)]).collect();
        let ticks = steps_of_ticks(moves);
        assert_eq!(ticks.len(), 1004);
        assert_eq!(ticks[1000..], expected);
    }
}
