//! Between bytes and the level of the line (DESIGN A4 to A6): `schedule` holds what is sent when, `sender` makes edges
//! of it, and `line` the level that all receive; `uart` makes bytes of levels, `packet` and `frame` commands of bytes.
//! `bit_times` computes when bits and bytes begin, and `cobs` decodes COBS.
//!
//! ```
//! use std::rc::Rc;
//! use stepscope_peripheral::{units::{Cycles, Instant}, wire::{Line, Schedule}};
//!
//! // Two packets for one channel, a tick of 32000 cycles apart: 5 steps right, then 3 left.
//! let host = Schedule::paced(Instant(1601), Cycles(32_000), [[0x85], [0x03]].iter());
//! let line = Line::new(Rc::new(host), &[], 16_000_000, 115_200);
//! assert_eq!(line.schedule().get(1).expect("two").start, Instant(33_601));
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
