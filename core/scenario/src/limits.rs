//! Bounds of a scenario that more than one rule names.

/// First cycle that no run reaches: a JavaScript number is exact up to 2^53, and this is below.
pub const END_OF_TIME: u64 = 9_000_000_000_000_000;

/// Most controllers on a line, the scenario's own first.
pub const MAX_CONTROLLERS: usize = 32;

/// Longest text of a scenario that a program should read, in bytes: a million segments with all their fields fit.
pub const MAX_TEXT_BYTES: usize = 64 << 20;
