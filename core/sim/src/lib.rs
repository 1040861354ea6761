//! An experiment: a scenario judged once, planned once, and run (DESIGN A2, A9).
//!
//! ```
//! use stepscope_peripheral::trace::Digest;
//! use stepscope_scenario::Scenario;
//! use stepscope_sim::Experiment;
//!
//! let scenario = Scenario::from_json(r#"{ "title": "the default motion" }"#).expect("reads");
//! let experiment = Experiment::new(&scenario).expect("has no problems");
//! let mut digest = Digest::default();
//! let run = experiment.run(&mut digest);
//! assert_eq!(run.device().positions()[0], 3200);
//! ```
#![cfg_attr(not(test), no_std)]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod alone;

mod bus_load;

#[cfg(test)]
mod counts;

pub mod noise;

pub mod framed_host;

mod ignored;

mod raw_receiver;

mod framed_line;

mod bus;

mod controller_plan;

mod controllers;

mod cost;

mod experiment;

mod judged;

#[cfg(feature = "plant")]
mod plants;

#[cfg(feature = "plant")]
pub mod plant_run;

#[cfg(feature = "controller")]
pub mod power_cut;

mod script;

#[cfg(feature = "controller")]
mod stand_alone;

mod summary;

pub mod fault_sweep;

pub mod lateness;

pub mod live_trace;

pub mod raw_host;

pub mod session;

pub mod session_times;

pub mod twin;

pub use cost::{BUDGET_MOTOR_STEPS, BUDGET_RECORDS, Cost};
pub use experiment::{Experiment, Run};
pub use judged::{Judged, SelectedAxis, axes_of};
pub use script::{replayed, scripted};
#[cfg(feature = "controller")]
pub use stand_alone::{PanelSummary, StandAloneSummary};
pub use summary::{ControllerSummary, JobSummary, Summary};
