//! Tests of planners and step tables through the public API, in one program to link them once. `exact_curves` is separate,
//! because it can run for hours.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod curves;
mod decimals;
mod entries;
mod fewest_entries;
mod groups;
mod klipper;
mod smallest_tables;
mod tick_ends;
