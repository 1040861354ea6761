//! The ideal motion compared with its pulses: curves, errors, spectra, distortion and torque.
//!
//! ```
//! use stepscope_inspect::motion::sine_polyline::{distortion, vertices};
//!
//! // Six segments per quarter of a sine: 0.269 % distortion.
//! assert!((distortion(&vertices(0.0054), 4000).position - 0.002_69).abs() < 0.000_02);
//! ```

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
#[cfg(feature = "std")]
pub mod run_figures;
pub mod sine_optimum;
pub mod sine_polyline;
#[cfg(feature = "std")]
pub mod spectra;
#[cfg(feature = "std")]
pub mod spectrum;
pub(crate) mod step_acceleration;
pub mod torque;
