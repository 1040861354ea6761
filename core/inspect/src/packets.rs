//! ```
//! use stepscope_inspect::packets::dissector::Reading;
//! use stepscope_inspect::packets::log::RowOutcome;
//! use stepscope_peripheral::{config::Protocol, signal::PacketOutcome};
//!
//! let reading = Reading { protocol: Protocol::Raw, addressed: false, channels: &|_| 2 };
//! let meaning = reading.of(&[0x85, 0x03], RowOutcome::Packet(PacketOutcome::Queued));
//! assert_eq!(meaning.fields.len(), 2); // one command per channel
//! ```

pub mod dissector;
pub mod line_decoder;
pub mod log;
pub mod packet_table;
