//! Distances and points mean their decimals (DESIGN B1): compared with 128-bit integers, independently of the planner's
//! arithmetic.

use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use stepscope_motion::{
    mechanics::{Direct, Distance, Mechanics, Rotary, Screw, Speed},
    moves::{Axis, Constant, Interpolation, Move, Point, PointUnit, Points},
    plan_axis,
};

fn steps_of(mechanics: Mechanics, one: Move) -> i64 {
    let axis = Axis { mechanics, moves: vec![one], ..Axis::default() };
    plan_axis(&axis, "x").unwrap_or_else(|problems| panic!("{problems:?}")).steps()
}

fn constant(distance: Distance) -> Move {
    Move::Constant(Constant { distance, speed: Speed::StepsPerSecond(1000.0) })
}

fn points(unit: PointUnit, points: &[(f64, f64)]) -> Move {
    let points = points.iter().map(|&(time_s, position)| Point { time_s, position }).collect();
    Move::Points(Points { unit, interpolation: Interpolation::Straight, points })
}

#[test]
fn rounds_decimal_half_steps_up() {
    let direct = |step_mm| Mechanics::Direct(Direct { step_mm });
    assert_eq!(steps_of(direct(0.1), constant(Distance::Millimeters(88.35))), 884);
    assert_eq!(steps_of(direct(0.1), constant(Distance::Millimeters(-88.35))), -883);
    let shaft = Mechanics::Rotary(Rotary { full_step_deg: 1.8, microsteps: 16 });
    assert_eq!(steps_of(shaft, constant(Distance::Degrees(41.456_25))), 369);
    let table = points(PointUnit::Millimeters, &[(0.0, 0.0), (1.0, 0.145)]);
    assert_eq!(steps_of(direct(0.01), table), 15);
}

#[test]
fn invalid_quantities_give_the_quotient_in_f64() {
    let direct = |step_mm| Mechanics::Direct(Direct { step_mm });
    let steps =
        |mm: f64, step_mm: f64| Distance::Millimeters(mm).in_steps(&direct(step_mm)).expect("they have mm");
    assert!(steps(f64::NAN, 0.1).is_nan() && steps(0.0, 0.0).is_nan());
    assert_eq!(
        (steps(f64::INFINITY, 0.1), steps(1.0, 0.0), steps(1.0, -0.5)),
        (f64::INFINITY, f64::INFINITY, -2.0)
    );
    assert_eq!(Distance::Millimeters(f64::NAN).whole_steps(&direct(0.1)), Ok(0));
}

/// Decimals n/10^places have a quotient of integers: floor(a/b + 1/2) = floor((2a + b)/(2b)).
#[test]
fn distances_are_quotients_of_decimals() {
    let mut noise = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut draw = |from: i128, to: i128| from + i128::from(noise.next_u64()).rem_euclid(to - from + 1);
    let mut halves = 0;
    for _ in 0..20_000 {
        let (places, unit_places) = (draw(0, 5) as u32, draw(0, 4) as u32);
        let (ten, unit_ten) = (10_i128.pow(places), 10_i128.pow(unit_places));
        let (whole, unit) =
            (draw(-200_000, 200_000), [1, 2, 3, 4, 5, 7, 8, 10, 20, 25, 50, 99][draw(0, 11) as usize]);
        // As JSON reads them: the number nearest to the decimal.
        let number = |digits: i128, ten: i128| digits as f64 / ten as f64;
        let (given, size) = (number(whole, ten), number(unit, unit_ten));
        let (mechanics, distance, numerator, denominator) = match draw(0, 2) {
            0 => (
                Mechanics::Direct(Direct { step_mm: size }),
                Distance::Millimeters(given),
                whole * unit_ten,
                unit * ten,
            ),
            1 => {
                let microsteps = [1, 8, 10, 256][draw(0, 3) as usize];
                let screw = Screw { full_step_deg: 1.8, microsteps, lead_mm: size };
                // lead*1.8/microsteps/360 mm per step.
                let numerator = whole * 3600 * i128::from(microsteps) * unit_ten;
                (Mechanics::Screw(screw), Distance::Millimeters(given), numerator, unit * 18 * ten)
            }
            _ => {
                let microsteps = [1, 16, 5, 128][draw(0, 3) as usize];
                let shaft = Rotary { full_step_deg: 0.9, microsteps };
                (
                    Mechanics::Rotary(shaft),
                    Distance::Degrees(given),
                    whole * 10 * i128::from(microsteps),
                    9 * ten,
                )
            }
        };
        let expected = (2 * numerator + denominator).div_euclid(2 * denominator);
        let twice = 2 * numerator;
        halves += usize::from(
            twice.rem_euclid(denominator) == 0 && twice.div_euclid(denominator).rem_euclid(2) == 1,
        );
        if expected == 0 || expected.abs() > 1_000_000 {
            continue;
        }
        let found = distance.whole_steps(&mechanics);
        assert_eq!(found.map(i128::from), Ok(expected), "{distance:?} on {mechanics:?}");
        assert_eq!(i128::from(steps_of(mechanics, constant(distance))), expected);
    }
    assert!(halves > 300, "only {halves} halves were drawn");
}

#[test]
fn an_offset_of_all_points_changes_no_step() {
    let steps = |list: &[(f64, f64)]| steps_of(Mechanics::default(), points(PointUnit::Steps, list));
    assert_eq!(
        steps(&[(0.0, 20.45), (1.0, 46.95), (2.0, 39.95)]),
        steps(&[(0.0, 0.0), (1.0, 26.5), (2.0, 19.5)])
    );
    assert_eq!(steps(&[(0.0, -15.87), (1.0, -21.37)]), -5);

    let mut noise = Xoshiro256PlusPlus::seed_from_u64(2);
    let mut draw = |from: i64, to: i64| from + (noise.next_u64() % (to - from + 1) as u64) as i64;
    for _ in 0..2000 {
        let offset = draw(-100_000, 100_000);
        let positions: Vec<i64> = (0..6).map(|_| 50 * draw(-20, 20)).collect();
        let tenths: i64 = draw(1, 9);
        // Shifts times and positions.
        let at = |offset: i64| {
            let all = core::iter::once(0).chain(positions.iter().copied());
            let time_s = |index: i64| (offset.abs() + tenths * index) as f64 / 10.0;
            let list: Vec<(f64, f64)> =
                (0..7).map(time_s).zip(all.map(|position| (offset + position) as f64 / 100.0)).collect();
            let axis = Axis { moves: vec![points(PointUnit::Steps, &list)], ..Axis::default() };
            plan_axis(&axis, "x").map(|plan| plan.due_steps(16_000_000).collect::<Vec<_>>())
        };
        match (at(0), at(offset)) {
            (Ok(own), Ok(moved)) => assert_eq!(own, moved, "{offset} {positions:?}"),
            (own, moved) => {
                assert!(own.is_err() && moved.is_err(), "{offset} {positions:?}: {own:?} {moved:?}")
            }
        }
    }
}
