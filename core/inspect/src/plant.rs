//! ```
//! use stepscope_inspect::plant::motors::MOTORS;
//!
//! assert!(MOTORS.iter().all(|motor| motor.holding_torque_mn_m > 0.0));
//! ```

pub mod log;
pub mod model_agreement;
pub mod motors;
pub mod outcome;
pub mod report;
