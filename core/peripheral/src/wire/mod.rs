//! Bytes and line levels (DESIGN A4 to A6): `schedule` has the sends, `sender` their edges, and `line` the level that all
//! receive; `uart` decodes levels to bytes, `packet` and `frame` bytes to commands. `bit_times` has bit and byte times.
//!
//! ```
//! use stepscope_peripheral::{units::{Cycles, Instant}, wire::Schedule};
//!
//! let packets = Schedule::paced(Instant(1601), Cycles(32_000), [[0x85], [0x03]].iter());
//! assert_eq!(packets.get(1).expect("two packets").start, Instant(33_601));
//! ```

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
