//! Plans a trapezoid, exact or by table (DESIGN B2).

use crate::curves::acceleration_table::AccelerationTable;
use crate::curves::trapezoid::{Limits, Trapezoid};
use crate::curves::trapezoid_table::{NoTable, TrapezoidTable};
use crate::moves::{self, TrapezoidMethod};
use crate::planners::budget::{Budget, MAX_TABLE_ROWS, exceeded};
use crate::{MAX_SPEED, limits, planners::quantities::Quantities, problem::Cause};

pub(super) fn exact(quantities: &mut Quantities<'_>, given: &moves::Trapezoid) -> Option<Trapezoid> {
    let steps = check(quantities, given)?;
    let mechanics = quantities.mechanics();
    let limits = Limits {
        start_speed: given.start_speed.exact_in_steps(mechanics).ok()?,
        top_speed: given.max_speed.exact_in_steps(mechanics).ok()?,
        acceleration: given.max_acceleration.exact_in_steps(mechanics).ok()?,
    };
    Some(Trapezoid::from_exact(steps, limits))
}

pub(super) fn table(
    quantities: &mut Quantities<'_>,
    given: &moves::Trapezoid,
    budget: &mut Budget,
) -> Option<TrapezoidTable> {
    let steps = check(quantities, given)?;
    let mechanics = quantities.mechanics();
    let (start, top) = (given.start_speed.exact(mechanics).ok()?, given.max_speed.exact(mechanics).ok()?);
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

/// Checks the numbers; those of the table only for that method. Returns the steps.
fn check(quantities: &mut Quantities<'_>, given: &moves::Trapezoid) -> Option<i64> {
    // The table's first rate must round to one pulse per second; the exact curve may start from rest.
    let start_range = match given.method {
        TrapezoidMethod::Table => limits::TABLE_RATE_STEPS_S,
        TrapezoidMethod::Exact => 0.0..=MAX_SPEED,
    };
    let steps = quantities.distance("distance", &given.distance);
    let start = quantities.speed_within("start_speed", &given.start_speed, start_range);
    let top = quantities.speed("max_speed", &given.max_speed);
    let acceleration = quantities.acceleration("max_acceleration", &given.max_acceleration);
    let timer_hz = match given.method {
        TrapezoidMethod::Table => quantities.range("timer_hz", given.timer_hz.into(), limits::TIMER_HZ, "Hz"),
        TrapezoidMethod::Exact => Some(0.0),
    };
    if let (Some(start), Some(top)) = (start, top)
        && top < start
    {
        quantities.refuse("max_speed", Cause::TopBelowStart { top, start });
        return None;
    }
    timer_hz?;
    let (steps, _, _, _) = (steps?, start?, top?, acceleration?);
    Some(steps)
}
