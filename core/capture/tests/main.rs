//! Files of recordings: one program of all these tests, so that it is linked once. `others_files` needs programs of others.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;
mod formats;
mod hostile;
mod round_trip;
mod values;
mod writers;
