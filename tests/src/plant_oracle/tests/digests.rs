//! K1, K2 and K3 of F10: the digests of the contract.

use super::*;

fn k1_case(motor: Motor) -> Case {
    let bus = segment_bus(&[(1600, vec![Segment::whole(40, 32_768, 0, true)])], 16);
    alone(motor, &bus, 1_600_000)
}

#[test]
fn k1_full_steps_averaged() {
    let run = run(&k1_case(Motor { microsteps: 1, ..Motor::default() }));
    // F10 prints 16 digits of it: 39.91075131887101.
    assert_eq!(run.points.last().unwrap().motors[0].x, 39.910751318871014);
    assert_eq!(format!("{:016x}", run.digest), "35f26c3311391d20");
}

#[test]
fn k2_microsteps_up_and_down_a_ramp() {
    let list = vec![Segment::whole(600, 6000, -8, true), Segment::whole(600, 1200, 8, true)];
    let run = run(&alone(Motor::default(), &segment_bus(&[(1, list)], 16), 6_000_000));
    assert_eq!(format!("{:016x}", run.digest), "a699812c01ef3b7e");
}

#[test]
fn k3_full_steps_chopped() {
    let drive = Drive { regulator: Regulator::Chopper, decay: Decay::Mixed(0.31), ..Drive::default() };
    let run = run(&k1_case(Motor { microsteps: 1, drive, ..Motor::default() }));
    assert_eq!(run.step_cycles, 16);
    assert_eq!(format!("{:016x}", run.digest), "bf86f4b1cc5e03fc");
}
