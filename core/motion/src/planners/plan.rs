//! Plans an axis of a scenario, or reports all its problems. What follows from several numbers (a top speed, a table's
//! length) is checked with the curve.

mod motor;

use crate::moves::{Axis, Move};
use crate::problem::ValueError;
use crate::{
    AxisPlan, Problems, Profile, limits, mechanics::Mechanics, planners::budget::Budget,
    planners::quantities::Quantities,
};
use alloc::{format, string::String, vec::Vec};
use stepscope_peripheral::signal::MAX_CHANNELS;

const MAX_DURATION_S: f64 = 1e6;

/// Plans lists of axes with their paths, one per controller. They share the limits of tables and sines of [`plan_axis`].
/// Errors: every problem of every axis, each with its path.
pub fn plan_lists<'a>(
    lists: impl IntoIterator<Item = (String, &'a [Axis])>,
) -> Result<Vec<Vec<AxisPlan>>, Problems> {
    let (mut plans, mut problems, mut budget) = (Vec::new(), Vec::new(), Budget::default());
    for (path, axes) in lists {
        let mut list = Vec::new();
        // The scenario checks the number of axes.
        for (index, axis) in axes.iter().take(MAX_CHANNELS).enumerate() {
            match plan_within(axis, &format!("{path}[{index}]"), &mut budget) {
                Ok(plan) => list.push(plan),
                Err(found) => problems.extend(found),
            }
        }
        plans.push(list);
    }
    Problems::check(problems).map(|()| plans)
}

/// Plans a single move with the default mechanics; `path` is its location in the scenario.
/// Errors: every problem of the move, each with its path.
pub fn plan_move(motion: &Move, path: &str) -> Result<AxisPlan, Problems> {
    let mechanics = Mechanics::default();
    let mut quantities = Quantities::new(&mechanics, path);
    let profile = Profile::plan(&mut quantities, motion, &mut Budget::default());
    let plan = AxisPlan::from_profiles(profile.into_iter().collect());
    quantities.validator.end(plan)
}

/// Plans an axis; `path` is its location in the scenario, such as `source.motion.axes[0]`.
/// Distances are rounded half up to whole steps. An axis has at most 64 moves, 1e6 s, 1e6 rows of acceleration tables, and
/// 65536 segments of sine quarters.
/// Errors: every problem of the axis, each with its path.
pub fn plan_axis(axis: &Axis, path: &str) -> Result<AxisPlan, Problems> {
    plan_within(axis, path, &mut Budget::default())
}

fn plan_within(axis: &Axis, path: &str, budget: &mut Budget) -> Result<AxisPlan, Problems> {
    let mut quantities = Quantities::new(&axis.mechanics, path);
    motor::check(&mut quantities, axis);
    quantities.validator.length("moves", axis.moves.len(), limits::MOVES, "moves");
    // More moves already have a problem.
    let moves = axis.moves.iter().take(*limits::MOVES.end()).enumerate();
    let profiles = quantities.at("moves", |quantities| {
        let plan = |(index, given)| quantities.at_entry(index, |here| Profile::plan(here, given, budget));
        moves.filter_map(plan).collect()
    });
    let plan = AxisPlan::from_profiles(profiles);
    if plan.duration_s() > MAX_DURATION_S {
        let cause = ValueError::TooMuch { given: plan.duration_s(), max: MAX_DURATION_S, of: "seconds" };
        quantities.refuse("moves", cause);
    }
    quantities.validator.end(plan)
}
