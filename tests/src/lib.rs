//! Shared by the tests of all targets: the golden cases, and natively the independent models of the contract, the
//! strategies for random input, and the checks of the fuzz targets.
#![cfg_attr(target_os = "none", no_std)]

extern crate alloc;

pub mod golden;

pub mod plant_digests;

/// The slow model of the contract, for comparison with the core.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod oracle;

/// The slow model of the plant, for comparison with the core.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod plant_oracle;

/// The digest of both slow models, computed independently.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
mod xxh64;

/// The slow model of the stand-alone controller, for comparison with the core.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod controller_oracle;

/// Random configurations and line activity for the property tests.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod cases;

/// Random scenarios for the property tests.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod scenarios;

/// Number of random cases of a property test.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod effort;

/// Converts configurations of the slow model to the core's types.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod translate;

/// Compares all ways to run a scenario.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod equivalence;

/// The checks of the fuzz targets.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod fuzzing;

/// The README's examples, compiled and run as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// The examples of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../../docs/how-to/test-firmware.md")]
pub struct TestFirmware;
