//! Tests of the plant's public API, in one program so that it is linked once.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod analytic;
mod common;
mod digests;
mod refusals;
mod supply;
mod worked_numbers;
