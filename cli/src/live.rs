//! The wall clock's side of `stepscope serve` and `stepscope send` (LIVE H1 to H3): ports, the clock, Ctrl-C. What is said on
//! a line, and in which cycle, the core decides.

pub(crate) mod histogram;
pub(crate) mod interrupt;
pub(crate) mod port;
pub(crate) mod raw;
pub(crate) mod send;
pub(crate) mod serve;
pub(crate) mod sidecar;
pub(crate) mod status_line;
pub(crate) mod stop_watch;
pub(crate) mod wire;
