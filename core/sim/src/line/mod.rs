//! The serial line of a run: what is on it, whether it can carry what is sent, and its noise (DESIGN A9).

pub(crate) mod bus;
pub(crate) mod bus_load;
pub mod noise;
