//! Plans a curve through points (DESIGN B6).

use crate::curves::points::{Point, Points};
use crate::{
    limits, moves, planners::budget::check_speed, planners::quantities::Quantities, problem::Cause,
    timing::Exact,
};
use alloc::vec::Vec;

/// Minimum time between points in s: one cycle of the fastest clock.
const MIN_TIME_S: f64 = 1e-9;
/// Maximum number of listed problems of single points, because in a file of another kind every row has one.
const MAX_LISTED: usize = 16;

pub(super) fn plan(quantities: &mut Quantities<'_>, given: &moves::Points) -> Option<Points> {
    let count = given.points.len();
    quantities.validator.length("points", count, limits::POINTS, "points");
    if !limits::POINTS.contains(&count) {
        return None;
    }
    let step_size = quantities.step_size_of("unit", &given.unit.of(0.0))?;
    let points = quantities.at("points", |here| check(here, given, step_size))?;
    // Checked first, because the curve needs times that differ in f64.
    let duration_s = points.last().map_or(0.0, |last| last.time_s.high);
    quantities.range("points", duration_s, limits::DURATION_S, "s")?;
    let curve = Points::from_exact(points, given.interpolation)?;
    if curve.step_count() == 0 {
        quantities.refuse("points", Cause::NoSteps { steps: curve.max_distance() });
        return None;
    }
    // The path of a speed that is too high is that of the point at the end of its piece.
    let (piece, speed) = curve.fastest_piece();
    quantities.at("points", |here| here.at_entry(piece + 1, |here| check_speed(here, "", speed)))?;
    Some(curve)
}

fn check(quantities: &mut Quantities<'_>, given: &moves::Points, step_size: f64) -> Option<Vec<Point>> {
    let earlier_problems = quantities.validator.count();
    let mut points = Vec::with_capacity(given.points.len());
    let mut before_s = None;
    let finite = |number: f64| if number.is_finite() { number } else { 0.0 };
    let (first_s, first) =
        given.points.first().map_or((0.0, 0.0), |first| (finite(first.time_s), finite(first.position)));
    let since = |time_s: f64| {
        if time_s.is_finite() { Exact::difference(time_s, first_s).double() } else { time_s.into() }
    };
    for (index, point) in given.points.iter().enumerate() {
        quantities.at_entry(index, |here| {
            if let Some(before) = before_s.filter(|before| !is_after(point.time_s, *before)) {
                here.refuse("", Cause::NotRising { given: point.time_s, before, min: MIN_TIME_S });
            }
            let travel = here.travel(first, &given.unit.of(point.position), step_size);
            points.extend(travel.map(|position| Point { time_s: since(point.time_s), position }));
        });
        before_s = Some(point.time_s);
        if quantities.validator.count() >= earlier_problems + MAX_LISTED {
            break;
        }
    }
    (quantities.validator.count() == earlier_problems).then_some(points)
}

fn is_after(given: f64, before: f64) -> bool {
    given - before >= MIN_TIME_S
}

#[cfg(test)]
mod tests {
    use crate::{
        moves::{Axis, Interpolation, MAX_POINTS, Move, Point, PointUnit, Points},
        plan_axis,
    };
    use alloc::{string::ToString, vec, vec::Vec};

    type Row<'a> = (PointUnit, Vec<(f64, f64)>, &'a [&'a str]);

    #[test]
    fn reports_every_problem_of_points_with_its_path() {
        let straight = Interpolation::Straight;
        let rows: [Row; 10] = [
            (
                PointUnit::Steps,
                vec![(-1e12, 0.0), (-1e-6, 0.0), (0.0, 5.0)],
                &["points: 1000000000000 s is out of range; use 1e-6 to 86400 s"],
            ),
            (PointUnit::Steps, vec![(5.0, 3.0), (5.5, 4.0)], &[]),
            (PointUnit::Steps, vec![(0.0, 0.0)], &["points: 1 point; use 2 to 4096"]),
            (PointUnit::Steps, vec![(0.0, 0.0); MAX_POINTS + 1], &["points: 4097 points; use 2 to 4096"]),
            (
                PointUnit::Millimeters,
                vec![(0.0, 0.0), (1.0, 1.0)],
                &["unit: 0 mm is not available with rotary mechanics; use steps or other mechanics"],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (0.0, 1e10), (0.5, 4.0), (0.25, 1.0)],
                &[
                    "points[1]: a time of 0 s is not at least 1e-9 s after the previous time of 0 s; use rising times",
                    "points[1]: 10000000000 steps is out of range; use -1000000000 to 1000000000 steps",
                    "points[3]: a time of 0.25 s is not at least 1e-9 s after the previous time of 0.5 s; use rising times",
                ],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (f64::NAN, 1.0)],
                &[
                    "points[1]: a time of NaN s is not at least 1e-9 s after the previous time of 0 s; use rising times",
                ],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (86_401.0, 1.0)],
                &["points: 86401 s is out of range; use 1e-6 to 86400 s"],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (1.0, 0.49), (2.0, -0.3)],
                &["points: 0.49 steps is less than one step; use at least one step, or a dwell"],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (1.0, 10.0), (1.001, 20_000.0)],
                &[
                    "points[2]: the motion needs 19990001 steps/s, above the maximum of 10000000; use more time or less distance",
                ],
            ),
        ];
        for (unit, points, expected) in rows {
            let points = points.into_iter().map(|(time_s, position)| Point { time_s, position }).collect();
            let given = Points { unit, interpolation: straight, points };
            let axis = Axis { moves: vec![Move::Points(given)], ..Axis::default() };
            let found: Vec<_> =
                plan_axis(&axis, "axis").err().iter().flatten().map(ToString::to_string).collect();
            let expected: Vec<_> =
                expected.iter().map(|text| alloc::format!("axis.moves[0].points.{text}")).collect();
            assert_eq!(found, expected);
        }
    }
}
