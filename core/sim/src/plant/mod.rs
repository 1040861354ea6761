//! Runs with plants behind the controllers (PLANT).

pub(crate) mod behind;
pub mod plant_run;
