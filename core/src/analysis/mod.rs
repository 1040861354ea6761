//! What a run and its ideal come to: curves for the eye, spectra and distortion, and whether a
//! driver could follow the pulses.

pub mod curves;
pub mod drivers;
#[cfg(feature = "std")]
mod fourier;
#[cfg(feature = "std")]
pub mod spectrum;
#[cfg(feature = "std")]
mod stretch;
pub mod timing;
