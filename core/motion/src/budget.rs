//! What the axes of a scenario may ask of memory, work and speed together.

use crate::{MAX_SPEED, problem::Cause, quantities::Quantities};

/// Most rows that all acceleration tables of a scenario may have together.
pub(super) const MAX_TABLE_ROWS: u64 = 1_000_000;
/// Most segments that the quarters of all sines of a scenario may have together.
pub(super) const MAX_SEGMENTS: usize = 65_536;
/// Most slices that all sliced cosines of a scenario may have together.
pub(super) const MAX_SLICES: u64 = 100_000;
/// What the axes of a scenario may still ask of memory and work.
pub(super) struct Budget {
    pub(super) table_rows: u64,
    pub(super) segments: usize,
    pub(super) slices: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self { table_rows: MAX_TABLE_ROWS, segments: MAX_SEGMENTS, slices: MAX_SLICES }
    }
}

/// Refuses a speed that no one gave but that follows from the numbers.
pub(super) fn hold_speed(quantities: &mut Quantities<'_>, step: &str, rate: f64) -> Option<()> {
    if rate <= MAX_SPEED {
        return Some(());
    }
    quantities.refuse(step, Cause::TooFast { rate, most: MAX_SPEED });
    None
}
