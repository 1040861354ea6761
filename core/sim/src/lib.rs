//! Runs scenarios: an [`Experiment`] is a scenario that is validated and planned once (DESIGN A2, A9).
//!
//! [`Run`] is a run in progress. [`framed_host`] and [`raw_host`] send a scenario to real controllers, [`session`] simulates
//! controllers for a real host, and [`fault_sweep`] and [`power_cut`] inject faults.
//!
//! ```
//! use stepscope_peripheral::trace::Digest;
//! use stepscope_scenario::Scenario;
//! use stepscope_sim::Experiment;
//!
//! let scenario = Scenario::from_json(r#"{ "title": "the default motion" }"#).expect("valid JSON");
//! let experiment = Experiment::new(&scenario).expect("no problems");
//! let mut digest = Digest::default();
//! let run = experiment.run(&mut digest);
//! assert_eq!(run.positions()[0], 3200); // one turn
//! println!("{:016x}", digest.value()); // digest of all edges, the same on every target
//! ```
#![cfg_attr(not(test), no_std)]
#![allow(missing_docs, reason = "a name that has its meaning and unit needs no comment")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod clocked_device;
mod controller_plan;
mod controllers;
mod cost;
mod experiment;
mod faults;
mod finished_run;
mod hosts;
mod line;
mod live;
mod plant;
mod run;
mod stand_alone;
mod summary;
mod validated;

pub use clocked_device::{ClockedDevice, ClockedDeviceError};
pub use controllers::RunLimits;
pub use cost::{BUDGET_MOTOR_GRID_STEPS, BUDGET_RECORDS, Cost};
pub use experiment::Experiment;
pub use faults::{fault_sweep, power_cut};
pub use finished_run::{
    ControllerRun, FinishedRun, MAX_RECORDS, axis_plan, planned_steps, run, run_watched, step_times,
    too_many_edges,
};
pub use hosts::script::{replayed, scripted};
pub use hosts::{framed_host, raw_host};
pub use line::noise;
pub use live::{lateness, live_trace, session, session_times, twin};
pub use plant::plant_run;
pub use run::Run;
pub use stand_alone::{PanelSummary, StandAloneSummary};
pub use summary::{ControllerSummary, JobSummary, Summary};
pub use validated::{SelectedAxis, ValidatedScenario, axes_of, bus_of};
