//! From a scenario's axis to its plan, or to every problem that it has.
//!
//! A number is checked with the path of its field; what only follows from several
//! (a top speed, a table's length) is checked when the curve is made.

mod motor;

use crate::{
    AxisPlan, Profile, limits,
    mechanics::Mechanics,
    moves::{Axis, Move},
    planners::budget::Budget,
    planners::quantities::Quantities,
    problem::{Problem, ValueError},
};
use alloc::{format, string::String, vec::Vec};
use stepscope_peripheral::signal::MAX_CHANNELS;

/// Longest time of an axis in s.
const MAX_DURATION_S: f64 = 1e6;

/// Plans several lists of axes, one for each controller, each with its path.
///
/// Each axis is as [`plan_axis`] says; the tables and the sines of all together have to stay under its bounds.
///
/// # Errors
/// Every problem of every axis, each with its path.
pub fn plan_lists<'a>(
    lists: impl IntoIterator<Item = (String, &'a [Axis])>,
) -> Result<Vec<Vec<AxisPlan>>, Vec<Problem>> {
    let (mut plans, mut problems, mut budget) = (Vec::new(), Vec::new(), Budget::default());
    for (path, axes) in lists {
        let mut list = Vec::new();
        // More axes than that are refused by their number.
        for (index, axis) in axes.iter().take(MAX_CHANNELS).enumerate() {
            match plan_within(axis, &format!("{path}[{index}]"), &mut budget) {
                Ok(plan) => list.push(plan),
                Err(found) => problems.extend(found),
            }
        }
        plans.push(list);
    }
    if problems.is_empty() { Ok(plans) } else { Err(problems) }
}

/// Plans one move by itself, of an axis with the default mechanics; `path` is where it stands in the scenario.
///
/// # Errors
/// Every problem of the move, each with its path.
pub fn plan_move(motion: &Move, path: &str) -> Result<AxisPlan, Vec<Problem>> {
    let mechanics = Mechanics::default();
    let mut quantities = Quantities::new(&mechanics, path);
    let profile = Profile::plan(&mut quantities, motion, &mut Budget::default());
    let plan = AxisPlan::of(profile.into_iter().collect());
    quantities.validator.end(plan)
}

/// Plans an axis; `path` is where it stands in the scenario, such as `source.motion.axes[0]`.
///
/// Distances are rounded half up to whole steps; an axis has at most 64 moves and 1e6 s, its
/// acceleration tables 1e6 rows and the quarters of its sines 65536 segments.
///
/// # Errors
/// Every problem of the axis, each with its path.
pub fn plan_axis(axis: &Axis, path: &str) -> Result<AxisPlan, Vec<Problem>> {
    plan_within(axis, path, &mut Budget::default())
}

fn plan_within(axis: &Axis, path: &str, budget: &mut Budget) -> Result<AxisPlan, Vec<Problem>> {
    let mut quantities = Quantities::new(&axis.mechanics, path);
    motor::check(&mut quantities, axis);
    quantities.validator.length("moves", axis.moves.len(), limits::MOVES, "moves");
    // Past the most moves none is planned: the list's length is refused already.
    let moves = axis.moves.iter().take(*limits::MOVES.end()).enumerate();
    let profiles = quantities.at("moves", |quantities| {
        let plan = |(index, each)| quantities.at_entry(index, |here| Profile::plan(here, each, budget));
        moves.filter_map(plan).collect()
    });
    let plan = AxisPlan::of(profiles);
    if plan.duration_s() > MAX_DURATION_S {
        let cause = ValueError::TooMuch { given: plan.duration_s(), most: MAX_DURATION_S, of: "seconds" };
        quantities.refuse("moves", cause);
    }
    quantities.validator.end(plan)
}
