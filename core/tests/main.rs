//! Tests of several crates together, in one program so that it is linked once.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod exchange;
mod fault_sweep;
mod motion;
mod moves;
mod plans;
mod prelude;
mod segments;
mod source_code;
mod spectrum;
mod tables;
mod timing;
