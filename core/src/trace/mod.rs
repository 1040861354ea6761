//! What a run leaves: records of the signals, what happened on the way, and their digest
//! (DESIGN A3). The records themselves are in [`crate::signal`].

mod against;
mod changes;
mod columns;
mod digest;
mod fields;
mod fingerprint;
mod log;
mod proof;
mod recording;
mod steps;
mod table;
mod text;
#[cfg(feature = "std")]
mod vcd;

pub use against::{Against, BadLine, Difference, Outcome};
pub use changes::{Changes, Edge};
pub use columns::{Columns, columns};
pub use digest::Digest;
pub use fields::{Check, Field, Meaning, Reading};
pub use fingerprint::{Comparison, Fingerprint, Fingerprinter, Likeness, Mark, Shorter};
pub use log::{LoggedPacket, LoggedTick, PacketLog, Verdict};
pub use proof::{Proof, ProofError, VERSION};
pub use recording::Recording;
pub use steps::{Step, steps};
pub use table::{Quoted, write_edges_head, write_edges_row, write_packets_head, write_packets_row};
pub use text::{ParseError, parse_line, write_record};
#[cfg(feature = "std")]
pub use vcd::VcdWriter;

/// Bits of the signals that exports show: STEP and DIR of the channels in use, then EN, RX, TX, DE.
pub fn shown_signals(channels: u8) -> impl Iterator<Item = u32> {
    let channels = 0..u32::from(channels);
    channels.flat_map(|channel| [channel, 16 + channel]).chain(32..36)
}
