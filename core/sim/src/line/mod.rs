//! The serial line of a run: its nodes, its load and its noise (DESIGN A9).

pub(crate) mod bus;
pub(crate) mod bus_load;
pub mod noise;
