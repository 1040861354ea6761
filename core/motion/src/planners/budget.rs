//! Limits of memory, work and speed that all axes of a scenario share.

use crate::problem::{Cause, ValueError};
use crate::{MAX_SPEED, planners::quantities::Quantities};

pub(crate) const MAX_TABLE_ROWS: u64 = 1_000_000;
pub(crate) const MAX_SEGMENTS: u64 = 65_536;
pub(crate) const MAX_SLICES: u64 = 100_000;
/// Points of all groups, times the axes.
pub(crate) const MAX_WAY_POINTS: u64 = 16_384;
/// Changes of the formula of an axis with an input shaper.
pub(crate) const MAX_SHAPED_CHANGES: u64 = 100_000;

pub(crate) struct Budget {
    pub(crate) table_rows: u64,
    pub(crate) segments: u64,
    pub(crate) slices: u64,
    pub(crate) way_points: u64,
}

impl Default for Budget {
    fn default() -> Self {
        Self {
            table_rows: MAX_TABLE_ROWS,
            segments: MAX_SEGMENTS,
            slices: MAX_SLICES,
            way_points: MAX_WAY_POINTS,
        }
    }
}

/// The problem of a motion that needs `needed` of something of which `left` of `max` are left.
pub(crate) fn exceeded(max: u64, left: u64, needed: u64, of: &'static str) -> ValueError {
    ValueError::too_much((max - left).saturating_add(needed), max, of)
}

/// Adds a problem of a speed in steps/s that follows from other numbers, if it is too high.
pub(crate) fn check_speed(quantities: &mut Quantities<'_>, field: &str, rate: f64) -> Option<()> {
    if rate <= MAX_SPEED {
        return Some(());
    }
    quantities.refuse(field, Cause::TooFast { rate, max: MAX_SPEED });
    None
}
