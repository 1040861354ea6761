//! Plans the moves of an axis, and counts the steps due by a cycle (DESIGN Part B).

pub(crate) mod axis;
pub(crate) mod budget;
pub(crate) mod due_by;
pub(crate) mod plan;
pub(crate) mod profile;
pub(crate) mod quantities;
