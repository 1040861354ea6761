//! What a run and its ideal come to: curves for the eye, spectra and distortion.

pub mod curves;
#[cfg(feature = "std")]
mod fourier;
#[cfg(feature = "std")]
pub mod spectrum;
#[cfg(feature = "std")]
mod stretch;
