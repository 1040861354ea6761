//! Hosts of simulated and real lines.

pub mod framed_host;
pub mod raw_host;
pub(crate) mod script;
