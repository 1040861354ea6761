//! The real-time side of `serve` and `send` (LIVE H1 to H3); the core decides what is sent in which cycle.

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
