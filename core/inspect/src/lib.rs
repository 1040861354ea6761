//! Views and files of a run and its plan: packets, signals, curves, spectra, timing, torque, motors, recordings.
//!
//! ```
//! use stepscope_inspect::trace::stored_run::record_run;
//! use stepscope_peripheral::trace::steps;
//! use stepscope_sim::Experiment;
//!
//! let experiment = Experiment::from_json("{}").expect("every field has a default");
//! let (run, recordings) = record_run(&experiment, 1).expect("it is short");
//! assert_eq!(run.positions()[0], 3200);
//! assert_eq!(steps(&recordings[0].trace, 0).len(), 3200); // each with its cycle
//! ```
#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![allow(missing_docs, reason = "a field whose name has its meaning and unit needs no comment")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod export;
pub mod motion;
pub mod packets;
pub mod plant;
#[cfg(feature = "std")]
pub mod recording;
pub mod trace;
pub mod validation;
