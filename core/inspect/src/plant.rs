//! Drivers, motors and loads of a run.
//!
//! ```
//! use stepscope_inspect::plant::report::PlantReport;
//! use stepscope_sim::{Experiment, plant_run::PlantRun};
//!
//! let experiment = Experiment::from_json(r#"{ "plant": {} }"#).expect("it is valid");
//! let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("it has a plant");
//! run.finish();
//! let report = PlantReport::of(&experiment, &run, 0).expect("the controller has a plant");
//! assert_eq!(report.motors[0].verdict, "follows"); // no step is lost
//! ```

pub mod log;
pub mod model_agreement;
pub mod motors;
pub mod outcome;
pub mod report;
