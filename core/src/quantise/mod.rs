//! From motions to what the peripheral runs: the only rounding of positions and of step times
//! (DESIGN B7, B8).
//!
//! `motion` gives positions over time, `wire` and `device` know only ticks and segments; here the one becomes
//! the other.

mod segments;
mod ticks;

pub use segments::exact_segments;
pub use ticks::{TickClock, Ticks, ticks};
