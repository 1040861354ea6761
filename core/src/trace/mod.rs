//! What a run leaves: records of the signals, what happened on the way, and their digest
//! (DESIGN A3). The records themselves are in [`crate::signal`].

mod columns;
mod digest;
mod log;
mod recording;
mod steps;
mod text;

pub use columns::{Columns, columns};
pub use digest::Digest;
pub use log::{LoggedPacket, PacketLog, Verdict};
pub use recording::Recording;
pub use steps::{Step, steps};
pub use text::{ParseError, parse_line, write_record};
