//! The planners and their tables from outside: one program of all these tests, so that it is linked once. `exact_curves` is
//! one of its own, which walks for hours on request.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod decimals;
mod fewest_entries;
mod klipper;
mod smallest_tables;
mod tick_ends;
