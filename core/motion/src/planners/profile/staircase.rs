//! Plans a staircase of rates (DESIGN B3).

use crate::curves::{staircase::Staircase, staircase_table::StaircaseTable};
use crate::planners::budget::{Budget, MAX_TABLE_ROWS, exceeded};
use crate::{limits, moves, planners::quantities::Quantities, problem::Cause};

/// Acceleration of level 1, in steps/s^2.
const LEVEL_ACCELERATION: f64 = 1000.0;

pub(super) fn plan(
    quantities: &mut Quantities<'_>,
    given: &moves::Staircase,
    budget: &mut Budget,
) -> Option<Staircase> {
    let steps = quantities.distance("distance", &given.distance);
    let top = quantities.speed_within("top_speed", &given.top_speed, limits::TABLE_RATE_STEPS_S);
    let level = quantities.range("acceleration_level", given.level.into(), limits::LEVEL, "");
    let start = quantities.speed_within("start_speed", &given.start_speed, limits::TABLE_RATE_STEPS_S);
    let max = quantities.speed_within("max_speed", &given.max_speed, limits::TABLE_RATE_STEPS_S);
    if let (Some(start), Some(max)) = (start, max)
        && max < start
    {
        quantities.refuse("max_speed", Cause::TopBelowStart { top: max, start });
        return None;
    }
    if let (Some(top), Some(max)) = (top, max)
        && top > max
    {
        quantities.refuse("top_speed", Cause::TopAboveTable { top, max });
        return None;
    }
    let table = StaircaseTable::new(start?, max?, level? * LEVEL_ACCELERATION);
    top?;
    let top_rate = given.top_speed.exact(quantities.mechanics()).ok()?.rounded().unsigned_abs();
    match Staircase::new(steps?, table, top_rate, given.short_move, budget.table_rows) {
        Ok(staircase) => {
            budget.table_rows -= staircase.ramp_rows() + 1;
            Some(staircase)
        }
        Err(needed) => {
            quantities.refuse("", exceeded(MAX_TABLE_ROWS, budget.table_rows, needed, "table rows"));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        mechanics::{Distance, Speed},
        moves::{Axis, Move, Staircase},
        plan_axis,
    };
    use alloc::{string::ToString, vec, vec::Vec};

    #[test]
    fn reports_every_problem_of_a_staircase_with_its_path() {
        let speed = Speed::StepsPerSecond;
        let rows: [(Staircase, &[&str]); 4] = [
            (Staircase::default(), &[]),
            (
                Staircase {
                    distance: Distance::Millimeters(1.0),
                    level: 6,
                    top_speed: speed(0.4),
                    ..Staircase::default()
                },
                &[
                    "axis.moves[0].staircase.distance: 1 mm is not available with rotary mechanics; use steps or other mechanics",
                    "axis.moves[0].staircase.top_speed: 0.4 steps/s is out of range; use 0.5 to 10000000 steps/s",
                    "axis.moves[0].staircase.acceleration_level: 6 is out of range; use 1 to 5",
                ],
            ),
            (
                Staircase { top_speed: speed(20_001.0), ..Staircase::default() },
                &[
                    "axis.moves[0].staircase.top_speed: a top speed of 20001 steps/s is above the table's maximum of 20000 steps/s; use a lower top speed or a higher maximum",
                ],
            ),
            (
                Staircase { max_speed: speed(999.0), ..Staircase::default() },
                &[
                    "axis.moves[0].staircase.max_speed: a top speed of 999 steps/s is below the start speed of 1000 steps/s; use a higher top speed or a lower start speed",
                ],
            ),
        ];
        for (given, expected) in rows {
            let axis = Axis { moves: vec![Move::Staircase(given)], ..Axis::default() };
            let found: Vec<_> =
                plan_axis(&axis, "axis").err().iter().flatten().map(ToString::to_string).collect();
            assert_eq!(found, expected);
        }
    }
}
