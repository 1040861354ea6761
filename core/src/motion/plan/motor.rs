//! Judges the numbers of an axis' motor. They decide nothing in a plan; [`crate::analysis`] asks them how
//! much torque there is.

use super::super::{MOST_SPEED, asked::Asked};
use crate::scenario::{Axis, Cause, MOST_PEAK_CURRENT};
use alloc::format;

/// Judges the motor of an axis, if it has one; `path` is the axis'.
pub(super) fn judge(asked: &mut Asked<'_>, axis: &Axis, path: &str) {
    let Some(motor) = &axis.motor else { return };
    let at = |field: &str| format!("{path}.motor.{field}");
    if axis.mechanics.step_deg().is_none() {
        let detail = "a motor needs the angle of its steps, which mechanics of kind direct do not have; choose rotary, wheel or screw, or take the motor out";
        asked.refuse(format!("{path}.motor"), Cause::Conflict { detail });
    }
    let rated = asked.range(at("rated_current_a"), motor.rated_current_a, 0.001, 100.0, "A");
    asked.range(at("resistance_ohm"), motor.resistance_ohm, 0.001, 1000.0, "ohm");
    asked.range(at("inductance_mh"), motor.inductance_mh, 0.001, 10_000.0, "mH");
    asked.range(at("holding_torque_mn_m"), motor.holding_torque_mn_m, 0.001, 1e6, "mN*m");
    asked.range(at("rotor_inertia_g_cm2"), motor.rotor_inertia_g_cm2, 0.0, 1e9, "g*cm^2");
    asked.range(at("supply_v"), motor.supply_v, 0.1, 1000.0, "V");
    if let (Some(given), Some(rated)) = (motor.peak_current_a, rated) {
        asked.range(at("peak_current_a"), given, 0.001 * rated, MOST_PEAK_CURRENT * rated, "A");
    }
    asked.range(at("load_inertia_g_cm2"), motor.load_inertia_g_cm2, 0.0, 1e9, "g*cm^2");
    asked.range(at("load_torque_mn_m"), motor.load_torque_mn_m, 0.0, 1e6, "mN*m");
    if let Some(given) = motor.working_rate_hz {
        asked.range(at("working_rate_hz"), given, 1.0, MOST_SPEED, "steps/s");
    }
}

#[cfg(test)]
mod tests {
    use crate::{motion::plan_axis, scenario::Axis};
    use alloc::{string::ToString, vec::Vec};

    #[track_caller]
    fn check(json: &str, expected: &[&str]) {
        let axis: Axis = serde_json::from_str(json).unwrap();
        let problems = plan_axis(&axis, "axis").err().unwrap_or_default();
        let found: Vec<_> = problems.iter().map(ToString::to_string).collect();
        assert_eq!(found, expected, "{json}");
    }

    #[test]
    fn a_motors_numbers_are_judged_with_their_paths() {
        check(r#"{"motor":null}"#, &[]);
        check(r#"{"motor":{}}"#, &[]);
        check(r#"{"motor":{"peak_current_a":2.1213,"working_rate_hz":19200}}"#, &[]);
        check(
            r#"{"motor":{"inductance_mh":0,"peak_current_a":2.2,"load_inertia_g_cm2":-1,"working_rate_hz":0}}"#,
            &[
                "axis.motor.inductance_mh: 0 mH is out of range; give 0.001 to 10000 mH",
                "axis.motor.peak_current_a: 2.2 A is out of range; give 0.0015 to 2.1214 A",
                "axis.motor.load_inertia_g_cm2: -1 g*cm^2 is out of range; give 0 to 1000000000 g*cm^2",
                "axis.motor.working_rate_hz: 0 steps/s is out of range; give 1 to 10000000 steps/s",
            ],
        );
        // Without a rated current the peak's range is not known.
        check(
            r#"{"motor":{"rated_current_a":0,"peak_current_a":9}}"#,
            &["axis.motor.rated_current_a: 0 A is out of range; give 0.001 to 100 A"],
        );
    }

    #[test]
    fn a_motor_on_direct_mechanics_is_refused_with_the_remedy() {
        check(
            r#"{"mechanics":{"direct":{}},"motor":{}}"#,
            &[
                "axis.motor: a motor needs the angle of its steps, which mechanics of kind direct do not have; choose rotary, wheel or screw, or take the motor out",
            ],
        );
    }
}
