//! From motions to what the peripheral runs: the only rounding of positions and of step times
//! (DESIGN B7, B8).
//!
//! `motion` gives positions over time, `wire` and `device` know only ticks and segments; here the one becomes
//! the other.

mod compressed;
mod document;
mod entry_format;
mod line_fit;
mod longest;
mod segments;
pub mod source_code;
mod stored;
mod ticks;

pub use compressed::{Compressed, MOST_TOLERANCE, Tolerance, compressed};
pub use entry_format::{Entry, EntryFormat};
pub use segments::exact_segments;
pub use stored::{Form, MOST_TABLE_STEPS, Stored, TimingError, stored};
pub use ticks::{TickClock, Ticks, ticks};
