//! The ideal motion compared with its pulses: curves, errors, spectra, distortion and torque.

pub mod actual_motion;
#[cfg(feature = "std")]
mod analysis_window;
pub mod calibration;
pub mod comparison;
pub mod cursor_stats;
pub mod curves;
#[cfg(feature = "std")]
mod fourier;
pub mod measures;
pub mod position_error;
pub mod sine_optimum;
pub mod sine_polyline;
#[cfg(feature = "std")]
pub mod spectra;
#[cfg(feature = "std")]
pub mod spectrum;
pub(crate) mod step_acceleration;
pub mod torque;
