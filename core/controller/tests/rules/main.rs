//! The rules of CONTROLLER.md, each as a table or a run that can be counted by hand, and the equality of both speeds on
//! random controllers.
#![cfg(not(target_arch = "wasm32"))]
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "what cannot be run fails the test"
)]

mod bench;
mod common;
mod extremes;
mod panel;
mod power;
mod programs;
mod refusals;
mod two_speeds;
