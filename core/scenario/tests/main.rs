//! Scenarios from outside: one program of all these tests, so that it is linked once.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

mod json_schema;
mod schema;
mod standalone;
