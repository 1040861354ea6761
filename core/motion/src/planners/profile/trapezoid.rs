//! Plans a trapezoid, exact or by table (DESIGN B2).

use super::jerk_limited::between;
use crate::curves::acceleration_table::AccelerationTable;
use crate::curves::trapezoid::{Limits, Trapezoid};
use crate::curves::trapezoid_table::{NoTable, TrapezoidTable};
use crate::curves::{between_speeds::MoveLimits, numeric::Numeric, phases::Phases};
use crate::moves::{self, TrapezoidMethod};
use crate::planners::budget::{Budget, MAX_TABLE_ROWS, exceeded};
use crate::planners::start::{EdgeSpeeds, Planned, Start, check_edges, refuse_edges};
use crate::{limits, planners::quantities::Quantities, problem::Cause};

pub(super) fn exact(
    quantities: &mut Quantities<'_>,
    given: &moves::Trapezoid,
    start: Start,
) -> Option<Planned<Trapezoid, Numeric<Phases>>> {
    let numbers = check(quantities, given);
    let acceleration = quantities.acceleration_or("deceleration", given.deceleration.as_ref(), Some(0.0));
    let end = quantities.edge_speed("end_speed", given.end_speed.as_ref());
    let (Numbers { steps, start: given_start, top, acceleration: rising }, falling) =
        (numbers?, acceleration?);
    let falling = if given.deceleration.is_some() { falling } else { rising };
    let start_speed = match given_start {
        Some(start) => start,
        None => start.taken_over(quantities, steps)?,
    };
    // Without an end speed the move ends with the start speed that it is given.
    let end_speed = end?.unwrap_or(given_start.unwrap_or(0.0));
    let edges = EdgeSpeeds { start: start_speed, end: end_speed };
    check_edges(quantities, edges, top)?;
    let mechanics = quantities.mechanics();
    if let Some(speed) = &given.start_speed
        && start_speed == end_speed
        && rising == falling
        && start.offset == 0.0
    {
        let limits = Limits {
            start_speed: speed.exact_in_steps(mechanics).ok()?,
            top_speed: given.max_speed.exact_in_steps(mechanics).ok()?,
            acceleration: given.max_acceleration.exact_in_steps(mechanics).ok()?,
        };
        return Some(Planned::FromRest(Trapezoid::from_exact(steps, limits)));
    }
    let limits = MoveLimits { speed: top, acceleration: rising, deceleration: falling, jerk: f64::INFINITY };
    between(quantities, &limits, (steps, start.offset), edges).map(Planned::General)
}

pub(super) fn table(
    quantities: &mut Quantities<'_>,
    given: &moves::Trapezoid,
    start: Start,
    budget: &mut Budget,
) -> Option<TrapezoidTable> {
    let fields = [
        ("start_speed", given.start_speed.is_none()),
        ("end_speed", given.end_speed.is_some()),
        ("deceleration", given.deceleration.is_some()),
    ];
    // The table has its own start speed, so it takes none over.
    let fits = refuse_edges(quantities, Start { speed: 0.0, ..start }, fields);
    let Numbers { steps, .. } = check(quantities, given)?;
    fits?;
    let mechanics = quantities.mechanics();
    let start_speed = given.start_speed.as_ref()?;
    let (start, top) = (start_speed.exact(mechanics).ok()?, given.max_speed.exact(mechanics).ok()?);
    let table = AccelerationTable::exact(
        [&start, &top],
        &given.max_acceleration.exact(mechanics).ok()?,
        given.timer_hz,
    );
    match TrapezoidTable::new(steps, table, budget.table_rows) {
        Ok(table) => {
            budget.table_rows -= table.used_rows();
            Some(table)
        }
        Err(NoTable::Rows { needed }) => {
            quantities.refuse("", exceeded(MAX_TABLE_ROWS, budget.table_rows, needed, "table rows"));
            None
        }
        Err(NoTable::Timer { rate }) => {
            let cause = Cause::TimerTooSlow { rate, timer_hz: given.timer_hz };
            quantities.refuse("timer_hz", cause);
            None
        }
    }
}

/// The numbers of a trapezoid, in steps and s.
struct Numbers {
    steps: i64,
    /// The given start speed.
    start: Option<f64>,
    top: f64,
    acceleration: f64,
}

/// Checks the numbers; the table's numbers only for that method.
fn check(quantities: &mut Quantities<'_>, given: &moves::Trapezoid) -> Option<Numbers> {
    // The table's first rate must round to one pulse per second; the exact curve may start from rest.
    let start_range = match given.method {
        TrapezoidMethod::Table => limits::TABLE_RATE_STEPS_S,
        TrapezoidMethod::Exact => limits::EDGE_SPEED_STEPS_S,
    };
    let steps = quantities.distance("distance", &given.distance);
    let start = match &given.start_speed {
        Some(start) => quantities.speed_within("start_speed", start, start_range).map(Some),
        None => Some(None),
    };
    let top = quantities.speed("max_speed", &given.max_speed);
    let acceleration = quantities.acceleration("max_acceleration", &given.max_acceleration);
    let timer_hz = match given.method {
        TrapezoidMethod::Table => quantities.range("timer_hz", given.timer_hz.into(), limits::TIMER_HZ, "Hz"),
        TrapezoidMethod::Exact => Some(0.0),
    };
    if let (Some(Some(start)), Some(top)) = (start, top)
        && top < start
    {
        quantities.refuse("max_speed", Cause::TopBelowStart { top, start });
        return None;
    }
    timer_hz?;
    Some(Numbers { steps: steps?, start: start?, top: top?, acceleration: acceleration? })
}
