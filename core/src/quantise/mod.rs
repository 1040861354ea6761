//! From motions to what the peripheral runs: the only rounding of positions (DESIGN B7).
//!
//! `motion` gives positions over time, `wire` and `device` know only ticks; here the one becomes
//! the other.

mod ticks;

pub use ticks::{TickClock, Ticks, ticks};
