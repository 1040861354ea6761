//! Judges the numbers of an axis' motor. They decide nothing in a plan; `inspect` asks them how
//! much torque there is.

use crate::{MAX_SPEED, quantities::Quantities};
use crate::{motor::MAX_PEAK_CURRENT, moves::Axis, problem::ValueError};
use alloc::format;

/// Judges the motor of an axis, if it has one; `path` is the axis'.
pub(super) fn judge(quantities: &mut Quantities<'_>, axis: &Axis, path: &str) {
    let Some(motor) = &axis.motor else { return };
    let at = |field: &str| format!("{path}.motor.{field}");
    if axis.mechanics.step_deg().is_none() {
        let detail = "a motor needs the angle of its steps, which mechanics of kind direct do not have; choose rotary, wheel or screw, or take the motor out";
        quantities.refuse(format!("{path}.motor"), ValueError::Conflict { detail });
    }
    let rated = quantities.range(at("rated_current_a"), motor.rated_current_a, 0.001, 100.0, "A");
    quantities.range(at("resistance_ohm"), motor.resistance_ohm, 0.001, 1000.0, "ohm");
    quantities.range(at("inductance_mh"), motor.inductance_mh, 0.001, 10_000.0, "mH");
    quantities.range(at("holding_torque_mn_m"), motor.holding_torque_mn_m, 0.001, 1e6, "mN*m");
    quantities.range(at("rotor_inertia_g_cm2"), motor.rotor_inertia_g_cm2, 0.0, 1e9, "g*cm^2");
    quantities.range(at("supply_v"), motor.supply_v, 0.1, 1000.0, "V");
    if let (Some(given), Some(rated)) = (motor.peak_current_a, rated) {
        quantities.range(at("peak_current_a"), given, 0.001 * rated, MAX_PEAK_CURRENT * rated, "A");
    }
    quantities.range(at("load_inertia_g_cm2"), motor.load_inertia_g_cm2, 0.0, 1e9, "g*cm^2");
    quantities.range(at("load_torque_mn_m"), motor.load_torque_mn_m, 0.0, 1e6, "mN*m");
    if let Some(given) = motor.working_rate_hz {
        quantities.range(at("working_rate_hz"), given, 1.0, MAX_SPEED, "steps/s");
    }
}
