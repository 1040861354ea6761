//! Independent parts: XXH64, SplitMix64, sine, exponential, segments, refusals.

use super::*;
use crate::{plant_oracle::numbers::exp_of_minus, xxh64::xxh64};

#[test]
fn xxh64_gives_its_published_values() {
    let long: Vec<u8> = (0..100).collect();
    for (bytes, expected) in [
        (&b""[..], 0xEF46_DB37_51D8_E999),
        (b"a", 0xD24E_C4F1_A98C_6E5B),
        (b"abc", 0x44BC_2CF5_AD77_0999),
        (&long, 0x6AC1_E580_3216_6597),
    ] {
        assert_eq!(xxh64(bytes), expected, "{bytes:?}");
    }
}

#[test]
fn splitmix64_gives_its_published_values() {
    let mut bits = SplitMix64(1_234_567);
    assert_eq!([bits.bits(), bits.bits()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
}

#[test]
fn quarter_turns_are_exact_and_the_sine_is_accurate() {
    for (q, expected) in [(0.0, (0.0, 1.0)), (1.0, (1.0, 0.0)), (-1.0, (-1.0, 0.0)), (6.0, (0.0, -1.0))] {
        assert_eq!(sincos(q), expected, "{q}");
    }
    for k in -4000..4000 {
        let (s, c) = sincos(f64::from(k) * 0.01);
        close(s * s + c * c, 1.0, 2e-11);
    }
    close(sincos(1.0 / 3.0).0, 0.5, 1e-12);
    close(exp_of_minus(1.0), 0.36787944117144233, 1e-15);
    close(exp_of_minus(0.1), 0.9048374180359595, 1e-15);
}

#[test]
fn a_dwell_delays_and_dir_waits_for_the_fall() {
    let list =
        vec![Segment::whole(2, 100, 10, true), Segment::Dwell(50 << 16), Segment::whole(1, 100, 0, false)];
    let records = segment_bus(&[(10, list)], 5).records(1000);
    let expected = [
        (0, RESET),
        (10, RESET | 1 << 16),
        (110, RESET | 1 << 16 | 1),
        (115, RESET | 1 << 16),
        (220, RESET | 1 << 16 | 1),
        (225, RESET | 1 << 16),
        (270, RESET),
        (370, RESET | 1),
        (375, RESET),
    ];
    assert_eq!(records, expected);
}

#[test]
fn a_motor_too_fast_for_the_grid_is_refused() {
    let case = |change: fn(&mut Motor), step_cycles| {
        let mut motor = Motor::default();
        change(&mut motor);
        let mut case = alone(motor, &Bus::default(), 100);
        case.plant.step_cycles = step_cycles;
        is_refused(&case)
    };
    assert_eq!(case(|_| (), None), None);
    assert!(matches!(case(|motor| motor.inductance_mh = 0.01, None), Some(Refusal::Winding(_))));
    assert!(matches!(case(|_| (), Some(3000)), Some(Refusal::NaturalFrequency(_))));
    assert!(matches!(
        case(|motor| motor.rotor_inertia_g_cm2 = 0.0, None),
        Some(Refusal::NaturalFrequency(_))
    ));
    assert!(matches!(
        case(|motor| motor.coupling_n_m_rad = Some(20.0), None),
        Some(Refusal::CouplingSpring(_))
    ));
    let damped = |motor: &mut Motor| {
        motor.load_inertia_g_cm2 = 200.0;
        motor.coupling_n_m_rad = Some(20.0);
        motor.coupling_un_m_s = 1e6;
    };
    assert!(matches!(case(damped, None), Some(Refusal::CouplingDamper(_))));
}

#[test]
fn a_source_that_cannot_hold_the_motors_is_refused() {
    let mut case = alone(Motor::default(), &Bus::default(), 100);
    case.plant.buffer_uf = Some(1000.0);
    assert_eq!(is_refused(&case), None);
    case.plant.source_ohm = 100.0;
    assert_eq!(is_refused(&case), Some(Refusal::StartVoltage));
}
