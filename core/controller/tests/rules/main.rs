//! The rules of CONTROLLER.md as tables and runs that can be counted by hand, and random controllers.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::panic, clippy::unwrap_used, clippy::expect_used, reason = "an invalid setup fails the test")]

mod bench;
mod common;
mod extremes;
mod panel;
mod power;
mod programs;
mod refusals;
mod two_speeds;
