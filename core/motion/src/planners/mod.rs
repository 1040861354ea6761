//! From the moves of a scenario to the plan of an axis and its steps (DESIGN Part B).

pub(crate) mod axis;
pub(crate) mod budget;
pub(crate) mod due_by;
pub(crate) mod plan;
pub(crate) mod profile;
pub(crate) mod quantities;
