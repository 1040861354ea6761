//! The random cases are repeatable, and reach every branch that affects the digest.

use super::*;
use crate::plant_oracle::edges::EN;

#[test]
fn a_seed_gives_one_case_and_its_run_is_finite() {
    for seed in 0..60 {
        let case = random_case(seed);
        assert_eq!(case, random_case(seed));
        let run = run(&case);
        assert_eq!(run.points.len() as u64, case.cycles / run.step_cycles + 1);
        for point in &run.points {
            assert!(point.v.is_finite() && point.i_load.is_finite(), "seed {seed}: {point:?}");
            assert!(point.motors.iter().all(|motor| motor.x.is_finite()), "seed {seed}: {point:?}");
        }
    }
}

#[test]
fn random_cases_include_every_kind() {
    let cases: Vec<Case> = (0..300).map(random_case).collect();
    let some = |kind: &dyn Fn(&Case) -> bool| cases.iter().filter(|case| kind(case)).count();
    let motor = |kind: &dyn Fn(&Motor) -> bool| some(&|case: &Case| case.motors.iter().flatten().any(kind));
    let counts = [
        ("buffer", some(&|case| case.plant.buffer_uf.is_some())),
        ("sinks", some(&|case| case.plant.buffer_uf.is_some() && case.plant.source_sinks)),
        ("16 motors", some(&|case| case.motors.len() == 16)),
        ("a gap", some(&|case| case.motors.contains(&None))),
        ("EN drops", some(&|case| case.records.iter().any(|record| record.1 >> EN & 1 == 0))),
        ("coupling", motor(&|motor| motor.coupling_n_m_rad.is_some())),
        ("chopper", motor(&|motor| motor.drive.regulator == Regulator::Chopper)),
        ("averaged", motor(&|motor| motor.drive.regulator == Regulator::Averaged)),
        ("auto", motor(&|motor| matches!(motor.drive.decay, Decay::Auto(_)))),
        ("dac", motor(&|motor| motor.drive.dac_levels.is_some())),
        ("stiction", motor(&|motor| motor.stiction_mn_m.is_some())),
        ("detent", motor(&|motor| motor.detent_torque_mn_m > 0.0)),
        ("sine", motor(&|motor| motor.sine_torque_mn_m > 0.0)),
    ];
    for (kind, count) in counts {
        assert!(count >= 10, "{kind}: {count} of {}", cases.len());
    }
    let refused = (0..300).filter(|seed| is_refused(&drawn_case(*seed)).is_some()).count();
    assert!((10..280).contains(&refused), "{refused} of 300 are refused");
}
