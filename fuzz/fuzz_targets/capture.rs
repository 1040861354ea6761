//! libFuzzer's inputs for the check of the same name: see tests/src/fuzzing/capture.rs.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| stepscope_tests::fuzzing::capture::check(data));
