//! Between bytes and the level of the line (DESIGN A4 to A6): `schedule` holds what is sent when, `sender` makes edges
//! of it and `line` the level that all hear; `uart` makes bytes of levels, `packet` and `frame` orders of bytes. When bits
//! and bytes begin says `bit_times`, what COBS carries `cobs`.

pub mod bit_times;
pub mod cobs;
pub mod frame;
pub mod line;
pub mod packet;
pub mod schedule;
pub mod sender;
pub mod uart;

pub use bit_times::BitTimes;
pub use line::{Forced, Line};
pub use schedule::{Schedule, Sent};
pub use sender::Sender;
