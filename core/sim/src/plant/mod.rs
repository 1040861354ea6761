//! Runs with plants attached to the controllers (PLANT).

pub(crate) mod attached;
pub mod plant_run;
