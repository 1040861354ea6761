//! What a run and its ideal come to: curves for the eye, spectra and distortion, which segments
//! make the best sine, what each shape of a ramp costs, and whether a driver could follow the pulses
//! and a motor the plan.

pub mod between;
pub mod calibration;
pub mod comparison;
pub mod curves;
pub mod difference;
pub mod drivers;
#[cfg(feature = "std")]
mod fourier;
pub mod made;
pub mod measures;
pub mod sine_optimum;
pub mod sine_polyline;
#[cfg(feature = "std")]
pub mod spectrum;
#[cfg(feature = "std")]
mod stretch;
pub mod timing;
pub mod torque;
