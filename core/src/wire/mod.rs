//! Between the host's packets and the level of the line: bytes and their meaning.
//!
//! `host` makes a schedule of sends, `line` makes levels of it, `uart` makes bytes of levels and
//! `packet` makes orders of bytes. The first two are the host's side, the last two the
//! peripheral's.

pub mod host;
pub mod line;
pub mod packet;
pub mod uart;

pub use host::Schedule;
pub use line::Line;
