//! Between the host's packets and the level of the line: bytes and their meaning.
//!
//! `host` makes a schedule of sends, `sender` edges of them and `line` the level that all hear;
//! `uart` makes bytes of levels, `packet` and `frame` orders of bytes. `framed_host` is a host that
//! waits for replies.

pub mod frame;
pub mod framed_host;
pub mod host;
pub mod line;
pub mod noise;
pub mod packet;
pub mod sender;
pub mod uart;

pub use host::Schedule;
pub use line::Line;
pub use sender::Sender;
