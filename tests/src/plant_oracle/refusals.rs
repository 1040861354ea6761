//! Cases that F3, F4, F5 and F9 refuse before a run.

use super::parameters::{Case, Motor, MotorConstants, grid_step};
use super::run::start_voltage;

/// Why a case has no run, with the rejected numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refusal {
    /// R*h/L above 0.25 (F3).
    Winding(f64),
    /// 2*pi*f_n*h above 0.25 (F3).
    NaturalFrequency(f64),
    /// h*sqrt(C*(1/M + 1/M_l)) above 0.25 (F3).
    CouplingSpring(f64),
    /// h*Cd*(1/M + 1/M_l) above 0.25 (F3).
    CouplingDamper(f64),
    /// V at cycle 0 is NaN (F5).
    StartVoltage,
    /// Motors of one plant with different supplies (F9).
    Supplies(f64, f64),
    /// Stiction below friction, or a detent above half the holding torque (F9).
    Torque,
}

/// F3's and F5's limits, and F9's rules between fields; the ranges of single fields are not checked.
pub fn is_refused(case: &Case) -> Option<Refusal> {
    let h = grid_step(case) as f64 / case.clock_hz as f64;
    let supply_v = case.motors.iter().flatten().next()?.supply_v;
    for motor in case.motors.iter().flatten() {
        if motor.supply_v != supply_v {
            return Some(Refusal::Supplies(supply_v, motor.supply_v));
        }
        if let Some(refusal) = motor_refused(motor, h) {
            return Some(refusal);
        }
    }
    if start_voltage(case, supply_v).is_nan() {
        return Some(Refusal::StartVoltage);
    }
    None
}

fn motor_refused(motor: &Motor, h: f64) -> Option<Refusal> {
    // NaN exceeds any limit, too: a rotor without inertia.
    let above = |number: f64| number.is_nan() || number > 0.25;
    if motor.stiction_mn_m.is_some_and(|stiction| stiction < motor.friction_mn_m)
        || motor.detent_torque_mn_m > motor.holding_torque_mn_m / 2.0
    {
        return Some(Refusal::Torque);
    }
    let c = MotorConstants::new(motor);
    let winding = c.r * h / c.l;
    if above(winding) {
        return Some(Refusal::Winding(winding));
    }
    let natural = 2.0 * std::f64::consts::PI * natural_frequency_hz(motor) * h;
    if above(natural) {
        return Some(Refusal::NaturalFrequency(natural));
    }
    if let Some((m_l, stiffness, damper)) = c.coupling {
        let inverse = 1.0 / c.m + 1.0 / m_l;
        let spring = h * (stiffness * inverse).sqrt();
        if above(spring) {
            return Some(Refusal::CouplingSpring(spring));
        }
        let damped = h * damper * inverse;
        if above(damped) {
            return Some(Refusal::CouplingDamper(damped));
        }
    }
    None
}

/// f_n = sqrt(p*k*I/J)/(2*pi) (F3), Hz.
pub(super) fn natural_frequency_hz(motor: &Motor) -> f64 {
    let c = MotorConstants::new(motor);
    let p = 90.0 / motor.full_step_deg;
    let mut inertia = motor.rotor_inertia_g_cm2;
    if c.coupling.is_none() {
        inertia += motor.load_inertia_g_cm2;
    }
    let j = inertia * 1e-7;
    (p * (c.k / c.g) * c.peak / j).sqrt() / (2.0 * std::f64::consts::PI)
}
