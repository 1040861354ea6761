//! What a run leaves: records of the signals, what happened on the way, and their digest
//! (DESIGN A3). The records themselves are in [`crate::signal`].

mod digest;
mod log;
mod recording;
mod steps;
mod text;

pub use digest::Digest;
pub use log::{LoggedPacket, LoggedTick, PacketLog, RowOutcome};
pub use recording::{Recording, levels_at};
pub use steps::{Step, steps};
pub use text::{ParseError, parse_line, write_record};

/// Bits of the signals that exports show: STEP and DIR of the channels in use, then EN, RX, TX, DE.
pub fn shown_signals(channels: u8) -> impl Iterator<Item = u32> {
    let channels = 0..u32::from(channels);
    channels.flat_map(|channel| [channel, 16 + channel]).chain(32..36)
}
