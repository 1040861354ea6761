//! Hosts: who sends, simulated and real.

pub mod framed_host;
pub mod raw_host;
pub(crate) mod script;
