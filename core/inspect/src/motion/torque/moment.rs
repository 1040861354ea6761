//! Needed and available torque at one time of a plan.

use serde::Serialize;

/// Needed and available torque at one time, with the rate in steps/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Moment {
    pub at_s: f64,
    pub rate: f64,
    /// Torque in the direction of motion; negative where the motor brakes.
    pub needed_mn_m: f64,
    pub available_mn_m: f64,
}

impl Moment {
    /// Available less needed torque; negative for a shortage.
    pub fn margin_mn_m(&self) -> f64 {
        self.available_mn_m - libm::fabs(self.needed_mn_m)
    }
}
