//! Tests of the public API of scenarios, in one program so that it is linked once.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

mod json_schema;
mod schema;
mod standalone;
