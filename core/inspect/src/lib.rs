//! What one looks at in a run and its plan: packets and their fields, changes of signals, curves for the eye, spectra and
//! distortion, which segments make the best sine, what each shape of a ramp costs, whether a driver could follow the
//! pulses and a motor the plan, and the files of all of it.
//!
//! ```
//! use stepscope_inspect::{actual_motion::Pulses, measures::Measures};
//! use stepscope_peripheral::trace::{Recording, steps};
//! use stepscope_sim::Experiment;
//!
//! let experiment = Experiment::from_json("{}").expect("everything has a default");
//! let mut recording = Recording::default();
//! experiment.run(&mut recording);
//! let made = steps(&recording.trace, 0);
//! let pulses =
//!     Pulses::of_run(0, &made, &recording.packets, None, experiment.config());
//! let measures = Measures::of(&experiment.plans()[0], &pulses, None);
//! assert!(measures.pulses.largest_steps.abs() < 200.0);
//! ```
#![cfg_attr(not(any(test, feature = "std")), no_std)]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod actual_motion;
#[cfg(feature = "std")]
mod analysis_window;
pub mod calibration;
pub mod changes;
pub mod columns;
pub mod comparison;
pub mod cursor_stats;
pub mod curves;
pub mod dissector;
pub mod drivers;
pub mod edges;
pub mod fingerprint;
#[cfg(feature = "std")]
mod fourier;
pub mod judgement;
pub mod line_decoder;
pub mod measures;
pub mod model_agreement;
pub mod motors;
pub mod packet_table;
pub mod panel;
pub mod plain_text;
pub mod plant;
pub mod plant_log;
pub mod plant_report;
pub mod position_error;
pub mod recorded_run;
#[cfg(feature = "std")]
pub mod recording;
pub mod remedies;
pub mod run_fingerprint;
pub mod run_sink;
pub mod sine_optimum;
pub mod sine_polyline;
pub mod source_code;
#[cfg(feature = "std")]
pub mod spectra;
#[cfg(feature = "std")]
pub mod spectrum;
pub mod step_acceleration;
pub mod step_tables;
pub mod tables;
pub mod timing;
pub mod torque;
pub mod trace_diff;
pub mod trace_window;
#[cfg(feature = "std")]
pub mod vcd;
