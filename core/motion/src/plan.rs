//! From a scenario's axis to its plan, or to every problem that it has.
//!
//! A number is judged where it stands, with the path of its field; what only follows from several
//! (a top speed, a table's length) is judged when the curve is made.

mod budget;
mod motor;
mod points;
mod staircase;
mod timed;

use crate::{
    AxisPlan, Curve, MAX_SPEED, Profile,
    acceleration_table::AccelerationTable,
    constant_velocity::{Constant, Dwell},
    jerk_limited::{JerkLimited, Limits},
    limits,
    quantities::Quantities,
    sine::Sine,
    sine_segments::SineSegments,
    trapezoid::Trapezoid,
    trapezoid_table::{NoTable, TrapezoidTable},
};
use crate::{
    moves::{self, Axis, Move, TrapezoidMethod},
    problem::{Cause, Problem, ValueError},
};
use alloc::{format, string::String, vec::Vec};
use budget::{Budget, MAX_SEGMENTS, MAX_TABLE_ROWS, hold_speed};
use stepscope_peripheral::signal::MAX_CHANNELS;

/// Longest time of an axis in s.
const MAX_DURATION_S: f64 = 1e6;

/// Plans several lists of axes, one for each controller, each with its path.
///
/// Each axis is as [`plan_axis`] says; the tables and the sines of all together have to stay under
/// its bounds.
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
    motor::judge(&mut quantities, axis);
    quantities.validator.length("moves", axis.moves.len(), limits::MOVES, "moves");
    // Past the most moves none is planned: the list's length is refused already.
    let moves = axis.moves.iter().take(*limits::MOVES.end()).enumerate();
    let profiles = quantities.at("moves", |quantities| {
        let plan = |(index, each)| quantities.at_entry(index, |here| plan_move(here, each, budget));
        moves.filter_map(plan).collect()
    });
    let plan = AxisPlan::of(profiles);
    if plan.duration_s() > MAX_DURATION_S {
        let cause = ValueError::TooMuch { given: plan.duration_s(), most: MAX_DURATION_S, of: "seconds" };
        quantities.refuse("moves", cause);
    }
    quantities.validator.end(plan)
}

fn plan_move(quantities: &mut Quantities<'_>, given: &Move, budget: &mut Budget) -> Option<Profile> {
    match given {
        Move::Trapezoid(given) => quantities.at("trapezoid", |here| plan_trapezoid(here, given, budget)),
        Move::Staircase(given) => quantities.at("staircase", |here| staircase::plan(here, given, budget)),
        Move::Cosine(given) => quantities.at("cosine", |here| timed::plan_cosine(here, given, budget)),
        Move::Ramps(given) => quantities.at("ramps", |here| timed::plan_ramps(here, given)),
        Move::SineSegments(given) => quantities.at("sine_segments", |here| plan_sine(here, given, budget)),
        Move::Sine(given) => quantities.at("sine", |here| plan_exact_sine(here, given)),
        Move::JerkLimited(given) => quantities.at("jerk_limited", |here| plan_jerk_limited(here, given)),
        Move::Points(given) => quantities.at("points", |here| points::plan(here, given)),
        Move::Constant(given) => quantities.at("constant", |here| {
            let steps = here.distance("distance", &given.distance);
            let speed = here.speed("speed", &given.speed);
            Some(Profile::Constant(Constant::new(steps?, speed?)))
        }),
        Move::Dwell(given) => quantities.at("dwell", |here| {
            let duration_s = here.pause("duration_s", given.duration_s);
            Some(Profile::Dwell(Dwell::new(duration_s?)))
        }),
    }
}

fn plan_trapezoid(
    quantities: &mut Quantities<'_>,
    given: &moves::Trapezoid,
    budget: &mut Budget,
) -> Option<Profile> {
    // The table's first rate has to round to a pulse a second; the exact curve may start from rest.
    let starts = match given.method {
        TrapezoidMethod::Table => limits::TABLE_RATE_STEPS_S,
        TrapezoidMethod::Exact => 0.0..=MAX_SPEED,
    };
    let steps = quantities.distance("distance", &given.distance);
    let start = quantities.speed_within("start_speed", &given.start_speed, starts);
    let top = quantities.speed("top_speed", &given.top_speed);
    let acceleration = quantities.acceleration("acceleration", &given.acceleration);
    let timer_hz = match given.method {
        TrapezoidMethod::Table => quantities.range("timer_hz", given.timer_hz.into(), limits::TIMER_HZ, "Hz"),
        TrapezoidMethod::Exact => Some(0.0),
    };
    if let (Some(start), Some(top)) = (start, top)
        && top < start
    {
        quantities.refuse("top_speed", Cause::TopBelowStart { top, start });
        return None;
    }
    let (steps, start, top, acceleration) = (steps?, start?, top?, acceleration?);
    timer_hz?;
    if given.method == TrapezoidMethod::Exact {
        return Some(Profile::Trapezoid(Trapezoid::new(steps, start, top, acceleration)));
    }
    let table = AccelerationTable::new(start, top, acceleration, given.timer_hz);
    match TrapezoidTable::new(steps, table, budget.table_rows) {
        Ok(table) => {
            budget.table_rows -= table.kept_rows();
            Some(Profile::TrapezoidTable(table))
        }
        Err(NoTable::Rows { needed }) => {
            let (given, most) = ((MAX_TABLE_ROWS - budget.table_rows).saturating_add(needed), MAX_TABLE_ROWS);
            let cause = ValueError::TooMuch { given: given as f64, most: most as f64, of: "table rows" };
            quantities.refuse("", cause);
            None
        }
        Err(NoTable::Timer { rate }) => {
            let cause = Cause::TimerTooSlow { rate, timer_hz: given.timer_hz };
            quantities.refuse("timer_hz", cause);
            None
        }
    }
}

fn plan_sine(
    quantities: &mut Quantities<'_>,
    given: &moves::SineSegments,
    budget: &mut Budget,
) -> Option<Profile> {
    let amplitude = quantities.distance("amplitude", &given.amplitude);
    let period_s = quantities.duration("period_s", given.period_s);
    let periods = quantities.range("periods", given.periods.into(), limits::PERIODS, "");
    let deviation = quantities.range("max_deviation", given.max_deviation, limits::MAX_DEVIATION, "");
    let (amplitude, period_s, deviation) = (amplitude?, period_s?, deviation?);
    periods?;
    let curve = SineSegments::new(amplitude, period_s, given.periods, deviation);
    let segments = curve.segments().len();
    let Some(still_left) = budget.segments.checked_sub(segments) else {
        let (given, most) = (MAX_SEGMENTS - budget.segments + segments, MAX_SEGMENTS);
        let cause = ValueError::TooMuch { given: given as f64, most: most as f64, of: "sine segments" };
        quantities.refuse("", cause);
        return None;
    };
    budget.segments = still_left;
    hold_speed(quantities, "period_s", curve.peaks().speed)?;
    Some(Profile::SineSegments(curve))
}

fn plan_exact_sine(quantities: &mut Quantities<'_>, given: &moves::Sine) -> Option<Profile> {
    let amplitude = quantities.distance("amplitude", &given.amplitude);
    let period_s = quantities.duration("period_s", given.period_s);
    quantities.range("periods", given.periods.into(), limits::PERIODS, "")?;
    let curve = Sine::new(amplitude?, period_s?, given.periods);
    hold_speed(quantities, "period_s", curve.peaks().speed)?;
    Some(Profile::Sine(curve))
}

fn plan_jerk_limited(quantities: &mut Quantities<'_>, given: &moves::JerkLimited) -> Option<Profile> {
    let steps = quantities.distance("distance", &given.distance);
    let speed = quantities.speed("max_speed", &given.max_speed);
    let acceleration = quantities.acceleration("max_acceleration", &given.max_acceleration);
    let jerk = quantities.jerk("max_jerk", &given.max_jerk);
    let limits = Limits { speed: speed?, acceleration: acceleration?, jerk: jerk? };
    Some(Profile::JerkLimited(JerkLimited::new(steps?, limits)))
}
