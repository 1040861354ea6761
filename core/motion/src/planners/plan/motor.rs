//! Checks the numbers of an axis' motor, which `inspect` uses to compute torques.

use crate::{limits, motor::Motor, moves::Axis, planners::quantities::Quantities, problem::ValueError};

pub(super) fn check(quantities: &mut Quantities<'_>, axis: &Axis) {
    let Some(motor) = &axis.motor else { return };
    if axis.mechanics.step_deg().is_none() {
        let detail = "a motor needs a step angle, which direct mechanics do not have; use rotary, wheel or screw mechanics, or remove the motor";
        quantities.refuse("motor", ValueError::Conflict { detail });
    }
    quantities.at("motor", |here| check_numbers(here, motor));
}

fn check_numbers(here: &mut Quantities<'_>, motor: &Motor) {
    let rated = here.range("rated_current_a", motor.rated_current_a, limits::RATED_CURRENT_A, "A");
    here.range("resistance_ohm", motor.resistance_ohm, limits::RESISTANCE_OHM, "ohm");
    here.range("inductance_mh", motor.inductance_mh, limits::INDUCTANCE_MH, "mH");
    here.range("holding_torque_mN_m", motor.holding_torque_mn_m, limits::HOLDING_TORQUE_MN_M, "mN*m");
    here.range("rotor_inertia_g_cm2", motor.rotor_inertia_g_cm2, limits::INERTIA_G_CM2, "g*cm^2");
    here.range("supply_v", motor.supply_v, limits::SUPPLY_V, "V");
    if let (Some(given), Some(rated)) = (motor.peak_current_a, rated) {
        let (min, max) = limits::PEAK_CURRENT.into_inner();
        here.range("peak_current_a", given, min * rated..=max * rated, "A");
    }
    here.range("load_inertia_g_cm2", motor.load_inertia_g_cm2, limits::INERTIA_G_CM2, "g*cm^2");
    here.range("load_torque_mN_m", motor.load_torque_mn_m, limits::LOAD_TORQUE_MN_M, "mN*m");
    if let Some(given) = motor.working_rate_hz {
        here.range("working_rate_hz", given, limits::WORKING_RATE_HZ, "steps/s");
    }
}
