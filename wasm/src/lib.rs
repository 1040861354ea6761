//! The interface of the page: the core behind wasm-bindgen.
//!
//! The page builds this crate twice: with the feature [`simulation`](view) for the first screen, and with [`recordings`], which
//! loads in the background. The two share little code, so the page loads nearly nothing twice.

#![allow(clippy::missing_errors_doc, reason = "without an errors section only converting a value can fail")]

mod convert;
#[cfg(feature = "simulation")]
pub mod live;
#[cfg(feature = "recordings")]
pub mod recordings;
#[cfg(feature = "simulation")]
mod scenario;
#[cfg(feature = "simulation")]
pub mod study;
#[cfg(feature = "simulation")]
pub mod view;

#[cfg(feature = "simulation")]
pub use scenario::ValidatedScenario;
