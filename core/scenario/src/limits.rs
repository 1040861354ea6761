//! Limits that several rules use.

/// First cycle after every run; below 2^53, so that JavaScript numbers are exact.
pub const END_OF_TIME: u64 = 9_000_000_000_000_000;

/// Maximum controllers on a line, the scenario's own included.
pub const MAX_CONTROLLERS: usize = 32;

/// Maximum bytes of a scenario's text; a million segments with all fields fit.
pub const MAX_TEXT_BYTES: usize = 64 << 20;
