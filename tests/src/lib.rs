//! What the tests of all targets share: the golden cases, and natively the independent model of the contract, the
//! strategies that feed it, and the checks that fuzzing feeds.
#![cfg_attr(target_os = "none", no_std)]

extern crate alloc;

pub mod golden;

pub mod plant_digests;

/// The slow model of the contract that the core is compared with.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod oracle;

/// The slow model of the plant that the core's is compared with.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod plant_oracle;

/// The digest that both slow models reckon by themselves.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
mod xxh64;

/// The slow model of the stand-alone controller that the core's is compared with.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod controller_oracle;

/// Random configurations and line activity for the property tests.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod cases;

/// Random scenarios for the property tests.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod scenarios;

/// How many random cases a property test takes.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod effort;

/// A configuration of the slow model in the core's words.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod translate;

/// Every way through a scenario, compared.
#[cfg(not(any(target_arch = "wasm32", target_os = "none")))]
pub mod equivalence;

/// What the fuzz targets check.
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
