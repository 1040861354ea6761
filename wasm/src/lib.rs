//! What the page calls: the core behind wasm-bindgen. Nothing is decided here.
//!
//! The page builds this crate twice. The first module has the feature [`view`] and is all that the first screen needs; the
//! second one has [`tools`] and loads in the background.

mod convert;
mod judged;
#[cfg(feature = "tools")]
pub mod tools;
#[cfg(feature = "view")]
pub mod view;

pub use judged::Judged;
