//! The wall clock's side of `stepscope serve` and `stepscope send` (LIVE H1 to H3): ports, the clock, Ctrl-C. What is said on
//! a line, and in which cycle, the core decides.

mod buttons;
mod closed_peer;
mod keyboard;
mod line_errors;
mod panel;
pub(crate) mod port;
pub(crate) mod raw;
mod recording;
pub(crate) mod send;
pub(crate) mod serve;
mod server;
pub(crate) mod status_line;
pub(crate) mod stop_watch;
pub(crate) mod wire;
