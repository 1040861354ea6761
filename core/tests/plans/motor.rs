//! Problems of an axis' motor.

use super::check;

#[test]
fn invalid_numbers_of_a_motor_are_reported_with_their_paths() {
    check(r#"{"motor":null}"#, &[]);
    check(r#"{"motor":{}}"#, &[]);
    check(r#"{"motor":{"peak_current_a":2.1213,"working_rate_hz":19200}}"#, &[]);
    check(
        r#"{"motor":{"inductance_mh":0,"peak_current_a":2.2,"load_inertia_g_cm2":-1,"working_rate_hz":0}}"#,
        &[
            "axis.motor.inductance_mh: 0 mH is out of range; use 0.001 to 10000 mH",
            "axis.motor.peak_current_a: 2.2 A is out of range; use 0.0015 to 2.1214 A",
            "axis.motor.load_inertia_g_cm2: -1 g*cm^2 is out of range; use 0 to 1000000000 g*cm^2",
            "axis.motor.working_rate_hz: 0 steps/s is out of range; use 1 to 10000000 steps/s",
        ],
    );
    // Without a rated current the range of the peak current is unknown.
    check(
        r#"{"motor":{"rated_current_a":0,"peak_current_a":9}}"#,
        &["axis.motor.rated_current_a: 0 A is out of range; use 0.001 to 100 A"],
    );
}

#[test]
fn a_motor_on_direct_mechanics_is_rejected_with_a_remedy() {
    check(
        r#"{"mechanics":{"direct":{}},"motor":{}}"#,
        &[
            "axis.motor: a motor needs a step angle, which direct mechanics do not have; use rotary, wheel or screw mechanics, or remove the motor",
        ],
    );
}
