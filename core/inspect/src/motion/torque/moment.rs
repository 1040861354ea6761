//! What a motor has to give at one time of a plan, and what it has.

use serde::Serialize;

/// What is needed and what there is at one time of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Moment {
    /// Time in s from the start of the axis.
    pub at_s: f64,
    /// Speed without sign, in steps/s.
    pub rate: f64,
    /// Torque in the direction of the motion that the plan needs, in mN*m; negative where the motor brakes.
    pub needed_mn_m: f64,
    /// Torque that the motor has at that rate, in mN*m ([`available_mn_m`](crate::motion::torque::Machine::available_mn_m)); negative where it only
    /// brakes.
    pub available_mn_m: f64,
}

impl Moment {
    /// What is left, in mN*m; negative where there is too little.
    #[must_use]
    pub fn margin_mn_m(&self) -> f64 {
        self.available_mn_m - libm::fabs(self.needed_mn_m)
    }
}
