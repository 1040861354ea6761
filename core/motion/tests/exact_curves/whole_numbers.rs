//! Steps whose cycles follow from integers (DESIGN B1): of a timer's table, a constant rate and consecutive moves; compared with
//! 128-bit integers.

use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use stepscope_motion::{
    AxisPlan,
    mechanics::{Acceleration, Distance, Mechanics, Screw, Speed},
    moves::{
        Axis, Constant, Dwell, Interpolation, Move, Point, PointUnit, Points, Trapezoid, TrapezoidMethod,
    },
    plan_axis,
};

fn plan(moves: Vec<Move>) -> AxisPlan {
    plan_axis(&Axis { moves, ..Axis::default() }, "x").unwrap_or_else(|problems| panic!("{problems:?}"))
}

#[test]
fn a_late_step_of_a_table_is_in_its_exact_cycle() {
    let table = plan(vec![Move::Trapezoid(Trapezoid {
        distance: Distance::Steps(20_000.0),
        start_speed: Some(Speed::StepsPerSecond(1.0)),
        max_speed: Speed::StepsPerSecond(2.0),
        max_acceleration: Acceleration::StepsPerSecond2(1.0),
        method: TrapezoidMethod::Table,
        timer_hz: u32::MAX,
        ..Trapezoid::default()
    })]);
    let step = |k: usize| table.due_steps(1_000_000_000).nth(k - 1).map(|due| due.cycle);
    // (4294967295 + 7426*2147483647)/4294967295 s are 3713999999135.4998 cycles.
    assert_eq!(step(7427), Some(3_713_999_999_135));
    let profile = &table.moves()[0].profile;
    assert_eq!(profile.step_cycle(7427, 1_000_000_000), step(7427));
}

/// Straight pieces between decimals: t_0 + (k - 1/2 - y_0)*(t_1 - t_0)/(y_1 - y_0) in integers.
#[test]
fn points_on_straight_pieces_are_quotients_of_decimals() {
    let mut noise = Xoshiro256PlusPlus::seed_from_u64(8);
    let mut draw = |from: i128, to: i128| from + i128::from(noise.next_u64()).rem_euclid(to - from + 1);
    let mut ties = 0;
    for _ in 0..2000 {
        let clock = [16_000_000, 1_000_000_000, 1000][draw(0, 2) as usize];
        // In ms and tenths of steps, always to the right.
        let (mut t, mut y) = (0, 0);
        let mut list = vec![(t, y)];
        for _ in 0..3 {
            (t, y) = (t + draw(100, 4000), y + 2 * draw(1, 400));
            list.push((t, y));
        }
        let points =
            list.iter().map(|&(t, y)| Point { time_s: t as f64 / 1e3, position: y as f64 / 10.0 }).collect();
        let given = Points { unit: PointUnit::Steps, interpolation: Interpolation::Straight, points };
        let axis = Axis { moves: vec![Move::Points(given)], ..Axis::default() };
        let Ok(plan) = plan_axis(&axis, "x") else { continue };
        for (k, due) in (1..).zip(plan.due_steps(clock as u32)) {
            // 10*(k - 1/2), in tenths.
            let position = 10 * k - 5;
            let piece = list.windows(2).find(|pair| pair[0].1 < position && position <= pair[1].1);
            let Some(&[(t_0, y_0), (t_1, y_1)]) = piece else { panic!("no piece has {position}") };
            let under = 1000 * (y_1 - y_0);
            let over = clock * (t_0 * (y_1 - y_0) + (position - y_0) * (t_1 - t_0));
            ties += i128::from((2 * over) % under == 0 && (2 * over / under) % 2 == 1);
            assert_eq!(i128::from(due.cycle), rounded(over, under), "step {k} of {list:?} at {clock} Hz");
        }
    }
    assert!(ties > 300, "only {ties} steps stood at a half");
}

/// floor(a/b + 1/2).
fn rounded(a: i128, b: i128) -> i128 {
    (2 * a + b).div_euclid(2 * b)
}

#[test]
fn constant_rates_after_dwells_are_quotients_of_decimals() {
    let mut noise = Xoshiro256PlusPlus::seed_from_u64(4);
    let mut draw = |from: i128, to: i128| from + i128::from(noise.next_u64()).rem_euclid(to - from + 1);
    let mut ties = 0;
    for _ in 0..400 {
        let clock = [16_000_000, 1_000_000_000, 72_000_000, 1000][draw(0, 3) as usize];
        // Half of the rates are products of 2 and 5, whose steps are often at half cycles.
        let digits = match draw(0, 1) {
            0 => draw(1, 99_999),
            _ => (1 << draw(0, 12)) * 5_i128.pow(draw(0, 3) as u32),
        };
        let ten = 10_i128.pow(draw(0, 4) as u32);
        let wait_ms = [0, 1, 125, 333, 86_400_000][draw(0, 4) as usize];
        let speed = digits as f64 / ten as f64;
        let count = draw(1, 2000);
        if count * ten > digits * 86_400 {
            continue;
        }
        let moves = vec![
            Move::Dwell(Dwell { duration_s: wait_ms as f64 / 1000.0 }),
            Move::Constant(Constant {
                distance: Distance::Steps(count as f64),
                speed: Speed::StepsPerSecond(speed),
            }),
        ];
        for (k, due) in (1..).zip(plan(moves).due_steps(clock as u32)) {
            // wait + (2k - 1)/(2v), over the common 2000*digits.
            let (over, under) = (clock * (2 * wait_ms * digits + 1000 * (2 * k - 1) * ten), 2000 * digits);
            ties += i128::from((2 * over) % under == 0 && (2 * over / under) % 2 == 1);
            let cycle = i128::from(due.cycle);
            assert_eq!(cycle, rounded(over, under), "step {k} of {speed}/s after {wait_ms} ms at {clock} Hz");
        }
    }
    assert!(ties > 1000, "only {ties} steps stood at a half");
}

/// With a screw of 3 mm per turn and 100 steps per turn, a step is 0.03 mm: 10 mm/s are 1000/3 steps/s, which is no f64.
#[test]
fn a_rate_in_millimeters_is_the_quotient_of_its_decimals() {
    let screw = || Screw { full_step_deg: 3.6, microsteps: 1, lead_mm: 3.0 };
    for (digits, clock) in [(10, 1000), (7, 1000), (1, 999_983), (70, 16_000_000)] {
        let given =
            Constant { distance: Distance::Steps(5000.0), speed: Speed::MillimetersPerSecond(digits as f64) };
        // Two moves, so that the second begins at a fraction of a cycle.
        let moves = vec![Move::Constant(given.clone()), Move::Constant(given)];
        let axis = Axis { mechanics: Mechanics::Screw(screw()), moves, ..Axis::default() };
        let plan = plan_axis(&axis, "x").unwrap_or_else(|problems| panic!("{problems:?}"));
        for (k, due) in (1..).zip(plan.due_steps(clock as u32)) {
            // (k - 1/2)*3/(100*digits) s.
            let expected = rounded(3 * clock * (2 * k - 1), 200 * digits);
            assert_eq!(i128::from(due.cycle), expected, "step {k} of {digits} mm/s at {clock} Hz");
        }
    }
}
