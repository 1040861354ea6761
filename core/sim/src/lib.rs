//! An experiment: a scenario that is validated once, planned once, and run (DESIGN A2, A9).
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
#![allow(missing_docs, reason = "a name with its unit needs no comment that repeats it")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod controller_plan;
mod controllers;
mod cost;
mod experiment;
mod faults;
mod hosts;
mod line;
mod live;
mod plant;
mod run;
mod stand_alone;
mod summary;
mod validated;

pub use cost::{BUDGET_MOTOR_STEPS, BUDGET_RECORDS, Cost};
pub use experiment::Experiment;
pub use faults::{fault_sweep, power_cut};
pub use hosts::{
    framed_host, raw_host,
    script::{replayed, scripted},
};
pub use line::noise;
pub use live::{lateness, live_trace, session, session_times, twin};
pub use plant::plant_run;
pub use run::{Run, RunLimits};
pub use stand_alone::{PanelSummary, StandAloneSummary};
pub use summary::{ControllerSummary, JobSummary, Summary};
pub use validated::{SelectedAxis, ValidatedScenario, axes_of, bus_of};
