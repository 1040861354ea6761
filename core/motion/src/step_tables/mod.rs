//! From the steps of a motion to ticks, segments and step tables (DESIGN B7, B8).
//!
//! ```
//! use stepscope_motion::{
//!     moves::Axis,
//!     plan_axis,
//!     step_tables::{AxesPath, exact_segments},
//! };
//! use stepscope_peripheral::{segment::PulseTimes, units::Cycles};
//!
//! let plans = [plan_axis(&Axis::default(), "x").expect("a valid axis")];
//! let pulse = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) };
//! let segments = exact_segments(&plans, AxesPath::MOTION, 1, pulse, 16_000_000).expect("no step is too soon");
//! assert_eq!(segments.steps(), 3200);
//! ```

mod compressed;
mod document;
mod entry_format;
mod feasible_window;
mod fewest;
mod longest;
mod segments;
mod stored;
mod ticks;
mod timing_error;
mod walk;
mod wire_bytes;

pub use compressed::{Compressed, MAX_TOLERANCE, Side, Tolerance, compressed, compressed_quickly};
pub use entry_format::{Entry, EntryFormat};
pub use segments::exact_segments;
pub use stored::{Form, MAX_TABLE_STEPS, Stored, stored, stored_steps};
pub use ticks::{TickClock, Ticks, ticks};
pub use timing_error::TimingError;
pub use walk::{TableEvent, TableWalk};

/// Paths of problems of a list of axes.
#[derive(Clone, Copy, Debug)]
pub struct AxesPath<'a> {
    /// Path of the list; axis i is at `[i]`.
    pub axes: &'a str,
    /// Path of problems that concern all axes together.
    pub whole: &'a str,
}

impl AxesPath<'static> {
    /// The axes of a scenario's motion.
    pub const MOTION: Self = Self { axes: "source.motion.axes", whole: "source.motion" };
}

impl AxesPath<'_> {
    fn axis(&self, index: usize) -> alloc::string::String {
        alloc::format!("{}[{index}]", self.axes)
    }
}
