//! The interface of the page: the core behind wasm-bindgen.
//!
//! The page builds this crate twice: with the feature [`view`] for the first screen, and with [`tools`], which loads in the
//! background.

#![allow(clippy::missing_errors_doc, reason = "without an errors section only converting a value can fail")]

mod convert;
mod scenario;
#[cfg(feature = "tools")]
pub mod tools;
#[cfg(feature = "view")]
pub mod view;

pub use scenario::ValidatedScenario;
