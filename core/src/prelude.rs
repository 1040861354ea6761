//! What most programs need, for the enabled features.
//!
//! ```
//! use stepscope_core::peripheral::config::{Bus, SerialLine};
//! use stepscope_core::prelude::*;
//!
//! let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("valid defaults");
//! let (mut device, mut trace) = (Device::new(&config), Vec::<Record>::new());
//! assert_eq!(device.clock(true, &mut trace), device.levels());
//! assert_eq!(device.positions(), [0]);
//! ```

pub use crate::first_difference::first_difference;
#[cfg(feature = "motion")]
pub use stepscope_motion::ScheduledStep;
pub use stepscope_peripheral::config::Config;
pub use stepscope_peripheral::device::{Device, ModelBus};
pub use stepscope_peripheral::signal::{Levels, Record};
pub use stepscope_peripheral::trace::{Digest, Step};
pub use stepscope_peripheral::units::{Cycles, Instant};
pub use stepscope_registers::RegisterBus;
#[cfg(feature = "scenario")]
pub use stepscope_scenario::{Problem, Problems, Scenario};
#[cfg(feature = "sim")]
pub use stepscope_sim::{ControllerRun, Experiment, FinishedRun, run, step_times};
