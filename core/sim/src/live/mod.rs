//! Runs against the wall clock (LIVE).

pub mod lateness;
pub mod live_trace;
pub mod session;
pub mod session_times;
pub mod twin;
