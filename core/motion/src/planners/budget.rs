//! What the axes of a scenario may ask of memory, work and speed together.

use crate::{MAX_SPEED, planners::quantities::Quantities, problem::Cause};

pub(crate) const MAX_TABLE_ROWS: u64 = 1_000_000;
pub(crate) const MAX_SEGMENTS: usize = 65_536;
pub(crate) const MAX_SLICES: u64 = 100_000;
pub(crate) struct Budget {
    pub(crate) table_rows: u64,
    pub(crate) segments: usize,
    pub(crate) slices: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { table_rows: MAX_TABLE_ROWS, segments: MAX_SEGMENTS, slices: MAX_SLICES }
    }
}

/// Refuses a speed that no one gave but that follows from the numbers.
pub(crate) fn hold_speed(quantities: &mut Quantities<'_>, step: &str, rate: f64) -> Option<()> {
    if rate <= MAX_SPEED {
        return Some(());
    }
    quantities.refuse(step, Cause::TooFast { rate, most: MAX_SPEED });
    None
}
