//! Views and files of a run and its plan: packets, signals, curves, spectra, timing, torque, motors, recordings.
//!
//! ```
//! use stepscope_inspect::motion::{actual_motion::Pulses, measures::Measures};
//! use stepscope_inspect::trace::stored_run::Recording;
//! use stepscope_peripheral::trace::steps;
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
#![allow(missing_docs, reason = "a name with its unit needs no comment that repeats it")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Files of a run: value change dumps, CSV tables, step tables and source code.
pub mod export;
/// What a motion is and what the pulses make of it: curves, errors, spectra, distortion and torque.
pub mod motion;
/// Packets with their fields, outcomes and faults.
pub mod packets;
/// What drivers, motors and loads did.
pub mod plant;
#[cfg(feature = "std")]
pub mod recording;
/// Signals over time: edges, views, timing checks, trace diffs and fingerprints.
pub mod trace;
pub mod validation;
