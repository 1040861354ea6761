//! Setups that are refused, with the values and a remedy.

use crate::common::one;
use stepscope_plant::{
    Plant,
    parameters::{CurrentDecay, DriverModel, MotorModel, Setup, Supply},
};

fn refused(setup: &Setup) -> Vec<String> {
    Plant::new(setup).err().unwrap_or_default().iter().map(ToString::to_string).collect()
}

#[test]
fn each_error_states_the_field_the_value_and_the_fix() {
    let coupled =
        MotorModel { coupling_n_m_rad: Some(1e5), load_inertia_g_cm2: 10.0, ..MotorModel::default() };
    let rows: Vec<(Setup, &str)> = vec![
        (Setup::default(), "motors: 0 is out of range; use 1 to 16"),
        (
            one(MotorModel { friction_mn_m: -1.0, ..MotorModel::default() }),
            "motor 0: friction_mn_m: -1 is out of range; use 0 to 1000000",
        ),
        (
            one(MotorModel { stiction_mn_m: Some(4.0), ..MotorModel::default() }),
            "motor 0: stiction_mn_m: 4 is out of range; use 5 to 1000000",
        ),
        (
            one(MotorModel { detent_torque_mn_m: 201.0, ..MotorModel::default() }),
            "motor 0: detent_torque_mn_m: 201 is out of range; use 0 to 200",
        ),
        (
            one(MotorModel {
                drive: DriverModel { decay: CurrentDecay::Mixed(1.5), ..DriverModel::default() },
                ..MotorModel::default()
            }),
            "motor 0: drive.decay.share: 1.5 is out of range; use 0 to 1",
        ),
        (
            Setup {
                supply: Supply { source_ohm: f64::NAN, ..Supply::default() },
                ..one(MotorModel::default())
            },
            "source_ohm: NaN is out of range; use 0.001 to 100",
        ),
        (
            one(MotorModel { inductance_mh: 0.03, ..MotorModel::default() }),
            "motor 0: R*h/L is 0.267 at grid steps of 80 cycles, above the maximum of 0.25; use a smaller \
             step_cycles, or more inductance",
        ),
        (
            one(MotorModel { rotor_inertia_g_cm2: 0.05, ..MotorModel::default() }),
            "motor 0: 2*pi*f_n*h is 0.266 at grid steps of 80 cycles, above the maximum of 0.25; use a smaller \
             step_cycles, or more inertia",
        ),
        (
            one(coupled.clone()),
            "motor 0: h*sqrt(C*(1/M + 1/M_l)) is 1.748 at grid steps of 80 cycles, above the maximum of 0.25; \
             use a smaller step_cycles, more inertia, or a softer coupling",
        ),
        (
            one(MotorModel { coupling_n_m_rad: Some(1.0), coupling_un_m_s: 1e8, ..coupled }),
            "motor 0: h*Cd*(1/M + 1/M_l) is 611.111 at grid steps of 80 cycles, above the maximum of 0.25; use a \
             smaller step_cycles, more inertia, or less damping of the coupling",
        ),
        (
            Setup {
                supply: Supply { source_ohm: 50.0, buffer_uf: Some(100.0), ..Supply::default() },
                ..one(MotorModel::default())
            },
            "50 ohm is too high to supply the 3.6 W of the motors at rest; use a smaller source_ohm",
        ),
    ];
    for (setup, expected) in rows {
        assert_eq!(refused(&setup), [expected]);
    }
}

#[test]
fn the_same_motor_on_a_finer_grid_is_accepted() {
    let motor = MotorModel { inductance_mh: 0.03, ..MotorModel::default() };
    assert_eq!(refused(&Setup { step_cycles: Some(64), ..one(motor) }), [""; 0]);
}

#[test]
fn all_numbers_out_of_range_are_reported_together() {
    let motor = MotorModel { microsteps: 0, resistance_ohm: 0.0, ..MotorModel::default() };
    let setup =
        Setup { step_cycles: Some(0), motors: vec![MotorModel::default(), motor], ..Setup::default() };
    let fields: Vec<String> =
        refused(&setup).iter().map(|text| text.split(" is ").next().unwrap_or("").to_owned()).collect();
    assert_eq!(fields, ["step_cycles: 0", "motor 1: microsteps: 0", "motor 1: resistance_ohm: 0"]);
}
