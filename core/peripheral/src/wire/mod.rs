//! Bytes and line levels (DESIGN A4 to A6): `schedule` has the sends, `sender` their edges, and `line` the level that all
//! receive; `uart` decodes levels to bytes, `packet` and `frame` bytes to commands. `bit_times` has bit and byte times.

pub mod bit_times;
pub mod cobs;
pub mod frame;
pub mod line;
pub mod packet;
pub mod schedule;
pub mod sender;
pub mod uart;

pub use bit_times::BitTimes;
pub use line::{ForcedLevel, Line};
pub use schedule::{Schedule, Sent};
pub use sender::Sender;
