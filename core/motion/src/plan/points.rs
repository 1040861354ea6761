//! Plans a curve through points (DESIGN B6).

use crate::plan::hold_speed;
use crate::{
    Curve, Profile,
    moves::{self, Interpolation, MAX_POINTS},
    points::{Between, Points},
    problem::{Cause, ValueError},
    quantities::Quantities,
};
use alloc::{format, vec::Vec};

/// Least time from point to point in s: a cycle of the fastest clock.
const MIN_TIME_S: f64 = 1e-9;
/// Problems of single points that are told; in a table of another kind every row would be one.
const MAX_TOLD: usize = 16;

pub(super) fn plan(quantities: &mut Quantities<'_>, given: &moves::Points, path: &str) -> Option<Profile> {
    let list = format!("{path}.points");
    let count = given.points.len();
    if !(2..=MAX_POINTS).contains(&count) {
        quantities
            .refuse(list, ValueError::Length { given: count, least: 2, most: MAX_POINTS, of: "points" });
        return None;
    }
    let step = quantities.step_of(&format!("{path}.unit"), &given.unit.of(0.0))?;
    let earlier = quantities.validator.len();
    let mut points = Vec::with_capacity(count);
    let mut before = None;
    for (index, point) in given.points.iter().enumerate() {
        let at = || format!("{list}[{index}]");
        if let Some(before) = before.filter(|before| !is_after(point.time_s, *before)) {
            quantities.refuse(at(), Cause::NotRising { given: point.time_s, before, least: MIN_TIME_S });
        }
        before = Some(point.time_s);
        points
            .extend(quantities.position(at, &given.unit.of(point.position), step).map(|y| (point.time_s, y)));
        if quantities.validator.len() >= earlier + MAX_TOLD {
            break;
        }
    }
    if quantities.validator.len() > earlier {
        return None;
    }
    let between = match given.interpolation {
        Interpolation::Straight => Between::Straight,
        Interpolation::Smooth => Between::Smooth,
    };
    let curve = Points::new(&points, between)?;
    quantities.duration(list.as_str(), curve.duration_s())?;
    if curve.step_count() == 0 {
        quantities.refuse(list, Cause::NoSteps { steps: curve.reach() });
        return None;
    }
    // The point that the curve is on its way to when it is too fast.
    let (piece, speed) = curve.quickest();
    hold_speed(quantities, format!("{list}[{}]", piece + 1), speed)?;
    Some(Profile::Points(curve))
}

/// Whether a time comes late enough; not-a-number does not.
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

    /// Unit, points, and the problems that they have.
    type Row<'a> = (PointUnit, Vec<(f64, f64)>, &'a [&'a str]);

    #[test]
    fn every_problem_of_points_is_told_with_its_place() {
        let straight = Interpolation::Straight;
        let rows: [Row; 9] = [
            (PointUnit::Steps, vec![(5.0, 3.0), (5.5, 4.0)], &[]),
            (PointUnit::Steps, vec![(0.0, 0.0)], &["points: 1 points; give 2 to 4096"]),
            (PointUnit::Steps, vec![(0.0, 0.0); MAX_POINTS + 1], &["points: 4097 points; give 2 to 4096"]),
            (
                PointUnit::Millimetres,
                vec![(0.0, 0.0), (1.0, 1.0)],
                &[
                    "unit: 0 mm, but mechanics of kind rotary have no such unit; give steps, or choose mechanics that have it",
                ],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (0.0, 1e10), (0.5, 4.0), (0.25, 1.0)],
                &[
                    "points[1]: a time of 0 s after one of 0 s; give times that rise by 1e-9 s at least",
                    "points[1]: 10000000000 steps is out of range; give -1000000000 to 1000000000 steps",
                    "points[3]: a time of 0.25 s after one of 0.5 s; give times that rise by 1e-9 s at least",
                ],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (f64::NAN, 1.0)],
                &["points[1]: a time of NaN s after one of 0 s; give times that rise by 1e-9 s at least"],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (86_401.0, 1.0)],
                &["points: 86401 s is out of range; give 1e-6 to 86400 s"],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (1.0, 0.49), (2.0, -0.3)],
                &["points: 0.49 steps is less than one step; give at least one step, or a dwell"],
            ),
            (
                PointUnit::Steps,
                vec![(0.0, 0.0), (1.0, 10.0), (1.001, 20_000.0)],
                &[
                    "points[2]: this needs 19990001 steps/s, at most 10000000 are allowed; give more time or less distance",
                ],
            ),
        ];
        for (unit, points, expected) in rows {
            let points = points.into_iter().map(|(time_s, position)| Point { time_s, position }).collect();
            let given = Points { unit, interpolation: straight, points };
            let axis = Axis { moves: vec![Move::Points(given)], ..Axis::default() };
            let found: Vec<_> =
                plan_axis(&axis, "axis").err().unwrap_or_default().iter().map(ToString::to_string).collect();
            let expected: Vec<_> =
                expected.iter().map(|text| alloc::format!("axis.moves[0].points.{text}")).collect();
            assert_eq!(found, expected);
        }
    }
}
