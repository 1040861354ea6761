//! Bounds of a scenario that more than one rule names.

/// First cycle that no run reaches: a JavaScript number is exact up to 2^53, and this is below.
pub const END_OF_TIME: u64 = 9_000_000_000_000_000;

/// Most controllers on a line, the scenario's own first.
pub const MAX_CONTROLLERS: usize = 32;
