//! Plans the moves of an axis, and counts the steps due by a cycle (DESIGN Part B).

pub(crate) mod axis;
pub(crate) mod budget;
mod chain;
pub(crate) mod due_by;
mod groups;
pub(crate) mod plan;
pub(crate) mod profile;
pub(crate) mod quantities;
mod retarget;
mod start;
