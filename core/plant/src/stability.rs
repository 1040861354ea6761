//! Criteria for a grid that is fine enough for the equations (PLANT F3): four numbers per motor, each at most 0.25. Also the
//! natural frequency of a rotor held by its currents.
//!
//! ```
//! use stepscope_plant::{parameters::MotorModel, stability::Natural};
//!
//! let natural = Natural::of(&MotorModel::default());
//! assert!((natural.frequency_hz - 282.14).abs() < 0.05);
//! ```

use crate::motor_constants::{MotorConstants, TURN};
use crate::{parameters::MotorModel, root::square_root};

/// Small oscillations of a rotor around the position that its currents hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Natural {
    /// f_n = sqrt(p*k*I/J)/(2*pi) in Hz; J includes the load unless a coupling separates it.
    pub frequency_hz: f64,
    /// viscous/(4*pi*f_n*J): the damping without other friction.
    pub damping_ratio: f64,
}

impl Natural {
    /// Of a motor at its peak current.
    pub fn of(motor: &MotorModel) -> Self {
        let constants = MotorConstants::new(motor);
        let inertia = constants.m / (constants.g * constants.g);
        let k = constants.k / constants.g;
        let frequency_hz =
            square_root(90.0 / motor.full_step_deg * k * motor.peak_current_a / inertia) / TURN;
        let damping_ratio = motor.viscous_un_m_s / 1e6 / (2.0 * TURN * frequency_hz * inertia);
        Self { frequency_hz, damping_ratio }
    }
}

/// A number that limits the grid step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// R*h/L: the currents.
    Electrical,
    /// 2*pi*f_n*h: the rotor in the field of its currents.
    Rotor,
    /// h*sqrt(C*(1/M + 1/M_l)): the two masses.
    Spring,
    /// h*Cd*(1/M + 1/M_l): the coupling's damper.
    Damper,
}

impl Criterion {
    pub const fn formula(self) -> &'static str {
        match self {
            Self::Electrical => "R*h/L",
            Self::Rotor => "2*pi*f_n*h",
            Self::Spring => "h*sqrt(C*(1/M + 1/M_l))",
            Self::Damper => "h*Cd*(1/M + 1/M_l)",
        }
    }
}

/// The numbers of a motor on a grid of `h` seconds.
pub(crate) fn criteria(motor: &MotorModel, h: f64) -> impl Iterator<Item = (Criterion, f64)> {
    let constants = MotorConstants::new(motor);
    let natural = Natural::of(motor).frequency_hz;
    let (spring, damper) = constants.coupling.as_ref().map_or((0.0, 0.0), |c| {
        let masses = 1.0 / constants.m + 1.0 / c.mass;
        (h * square_root(c.stiffness * masses), h * c.damping * masses)
    });
    [
        (Criterion::Electrical, constants.r * h / constants.l),
        (Criterion::Rotor, TURN * natural * h),
        (Criterion::Spring, spring),
        (Criterion::Damper, damper),
    ]
    .into_iter()
}
