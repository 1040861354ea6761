//! Computes the cycle of each step: numbers with enough digits, and the loop that all curves share (DESIGN B1).

mod cycle_time;
mod decimal;
mod double;
mod interpolated;
mod number;
mod rounding;
mod run;
mod step_loop;

pub(crate) use cycle_time::{CycleTime, tie};
pub(crate) use decimal::Exact;
pub(crate) use double::F106;
pub(crate) use interpolated::{Interpolated, one_searched_run};
pub(crate) use number::Number;
#[cfg(test)]
pub(crate) use rounding::decide_cycle;
pub(crate) use rounding::{IsDueBefore, MAX_ERROR, ROUNDING, due_near, is_mirrored_due_before};
pub(crate) use run::{Run, Runs, Schedule, Times, one_run};
pub(crate) use step_loop::MoveSteps;
pub use step_loop::ScheduledStep;
