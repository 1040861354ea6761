//! Signals over time: edges, views, timing checks, trace diffs and fingerprints.
//!
//! ```
//! use stepscope_inspect::trace::{drivers::A4988, timing::TimingCheck};
//! use stepscope_sim::Experiment;
//!
//! // Are the pulses of the default motion long enough for an A4988?
//! let experiment = Experiment::from_json("{}").expect("every field has a default");
//! let mut check = TimingCheck::new(&A4988.rules, experiment.config().clock_hz(), 100);
//! experiment.run(&mut check);
//! assert_eq!(check.total(), 0);
//! ```

pub mod changes;
pub mod diff;
pub mod drivers;
pub mod edges;
pub mod fingerprint;
#[cfg(feature = "std")]
pub mod recorded_run;
pub mod run_fingerprint;
pub mod run_sink;
pub mod stored_run;
pub mod timing;
pub mod window;
