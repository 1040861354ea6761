//! Texts as scenarios (PAGE "Share link"): none causes a panic, accepted scenarios have bounded work, and
//! a scenario round-trips through JSON.

use crate::equivalence::{self, Ways};
use stepscope_core::{
    inspect::plant::{
        model_agreement::FirstSlips,
        outcome::{table_head, table_row, too_coarse, verdict},
    },
    peripheral::{trace::Digest, units::Cycles},
    plant::State,
    scenario::{Compact, END_OF_TIME, Problem, Problems, Scenario},
    sim::{Experiment, plant_run::PlantRun},
};

/// Maximum invalid fields that a reading lists.
pub const MAX_PROBLEMS: usize = 100;
/// Maximum cost of a run: packets or bytes of a script, and the records of the busiest ticks.
const MAX_SENDS: u64 = 4 << 20;
const MAX_BYTES: u64 = 2_000_000 * 17;
const MAX_RECORDS: u64 = 1 + (MAX_BYTES + 10_000) * (10 + 16 * 127 * 4);
/// Of segments: an edge in each cycle of 48 bits on each channel.
const MAX_SEGMENT_RECORDS: u64 = 16 << 48;

/// Maximum records and cycles of runs that are made, also clock by clock.
const RUN_RECORDS: u64 = 5_000;
const RUN_CYCLES: u64 = 5_000;
/// Maximum grid steps of all motors of these runs.
const RUN_MOTOR_STEPS: u64 = 20_000;

/// Short runs with a plant: two motors with choppers on a weak supply, one of them with a spring, all sensors, and a threshold
/// that is reached; a self-test; a torque that accelerates the rotor without limit.
const PLANTS: [&str; 3] = [
    r#"{"run_cycles":20000,"bus":{"channels":2},"plant":{"step_cycles":40,"buffer_uf":100,"source_ohm":1,"idle_ma":5,
        "current_sensor":{"poles":3,"adc_steps":2},"encoder":{"period_steps":7,"noise_lsb":2,"hysteresis_lsb":1,"seed":5},
        "protection":{"threshold_a":0.01,"samples":3},"motors":[{"motor":{"drive":{"regulator":"chopper","decay":"auto"}}},
        {"microsteps":4,"motor":{"load_inertia_g_cm2":50,"coupling_n_m_rad":10,"detent_torque_mn_m":20,"gravity_torque_mn_m":30,
        "drive":{"regulator":"chopper","decay":"mixed","dac_levels":31}}}]},
        "source":{"segments":{"channels":[{"start_cycle":100,"segments":[{"steps":{"count":9,"interval_q16":104857600}}]},
        {"start_cycle":100,"segments":[{"steps":{"count":9,"interval_q16":104857600,"dir":0}}]}]}}}"#,
    r#"{"bus":{"step_period_cycles":200,"slots":2,"self_test_cycles":5000,"pulse_width_cycles":10,"dir_setup_cycles":2},
        "line":{"baud":1000000},"run_cycles":7000,"plant":{"self_test":true,"step_cycles":8},
        "source":{"packets":{"packets":["81","81"]}}}"#,
    r#"{"run_cycles":20000,"plant":{"motors":[{"motor":{"sine_torque_mn_m":1000000,"sine_per_turn":1000}}]},
        "source":{"segments":{"channels":[{"segments":[{"steps":{"count":9,"interval_q16":104857600}}]}]}}}"#,
];

/// Reads, validates and, if it is cheap, runs a text. Bytes that are not UTF-8 are ignored.
///
/// # Panics
/// If a property is violated.
pub fn check(data: &[u8]) {
    let Ok(text) = str::from_utf8(data) else { return };
    let Ok(experiment) = judge(text) else { return };
    let cost = experiment.cost();
    if cost.records <= RUN_RECORDS && cost.motor_grid_steps <= RUN_MOTOR_STEPS {
        let (scenario, _) = Scenario::from_json_lenient(text);
        // An overload and a self-test change the results of the device.
        let plant = scenario.plant.as_ref();
        if plant.is_none_or(|plant| plant.protection.is_none() && !plant.self_test) {
            let ways = Ways { slices: &[1, 7, 100], hurry: 100, most_clocked: RUN_CYCLES };
            equivalence::check(&scenario, &experiment, ways);
        }
        drive(&experiment);
    }
}

/// Runs the plants of an experiment, whole and in slices: no value is NaN, both runs have the same bits, and the
/// results can be printed. Returns the grid steps of all motors, so that a caller can check that runs were made.
///
/// # Panics
/// If a property is violated.
pub fn drive(experiment: &Experiment) -> u64 {
    let Some(plants) = experiment.plants() else { return 0 };
    let parts = || plants.setups.iter().map(|_| (Digest::default(), FirstSlips::default())).collect();
    let (Some(mut whole), Some(mut sliced)) =
        (PlantRun::new(experiment, parts()), PlantRun::new(experiment, parts()))
    else {
        return 0;
    };
    whole.finish();
    while !sliced.advance(Cycles(997)) {}
    let mut motor_grid_steps = 0;
    let both = whole.results().into_iter().zip(sliced.results()).zip(&plants.setups);
    for (index, ((result, again), setup)) in both.enumerate() {
        assert_eq!((result.cycle, result.digest), (again.cycle, again.digest), "in slices");
        assert_eq!(whole.overload(index), sliced.overload(index), "in slices");
        for (channel, (motor, again)) in result.motors.iter().zip(&again.motors).enumerate() {
            let (State { x, w, i_a, i_b, .. }, other) = (motor.state, again.state);
            let bits = |numbers: [f64; 4]| numbers.map(f64::to_bits);
            assert_eq!(bits([x, w, i_a, i_b]), bits([other.x, other.w, other.i_a, other.i_b]), "in slices");
            assert!([x, w, i_a, i_b].into_iter().all(f64::is_finite), "{:?}", motor.state);
            assert!(!verdict(motor, setup.clock_hz, None).is_empty());
            let _ = too_coarse(setup, channel, motor);
        }
        motor_grid_steps += result.cycle / u64::from(setup.grid_cycles()) * setup.motors.len() as u64;
        if let Some(plant) = whole.plant(index) {
            assert_eq!(table_head(plant).split(',').count(), table_row(plant).split(',').count());
        }
    }
    motor_grid_steps
}

/// The presets, the golden cases and some plants.
#[must_use]
pub fn seeds() -> Vec<Vec<u8>> {
    super::scenarios().chain(PLANTS).map(|json| json.as_bytes().to_vec()).collect()
}

/// Reads and validates a text: its problems can be printed, and accepted work is bounded.
///
/// # Errors
/// The problems of an invalid text.
///
/// # Panics
/// If a property is violated.
pub fn judge(text: &str) -> Result<Experiment, Problems> {
    let (scenario, unread) = Scenario::from_json_lenient(text);
    assert!(unread.as_ref().is_none_or(|unread| unread.len() <= MAX_PROBLEMS));
    assert_eq!(Scenario::from_json(text).is_ok(), unread.is_none());
    let canonical = scenario.compact().to_string();
    for json in [scenario.to_json(), canonical.clone()] {
        let again = Scenario::from_json(&json);
        assert_eq!(again.as_ref(), Ok(&scenario), "what is left of it is a scenario");
        assert_eq!(again.map(|again| again.compact().to_string()).as_ref(), Ok(&canonical));
    }
    let judged = Experiment::from_json(text);
    assert!(unread.is_none() || judged.is_err());
    match &judged {
        Ok(experiment) => bounded(experiment),
        Err(problems) => told(problems, text),
    }
    judged
}

fn bounded(experiment: &Experiment) {
    let cost = experiment.cost();
    assert!(cost.sends <= MAX_SENDS && cost.bytes <= MAX_BYTES.max(MAX_SENDS), "{cost:?}");
    let most = if experiment.segments().is_some() { MAX_SEGMENT_RECORDS } else { MAX_RECORDS };
    assert!(cost.records <= most && cost.end_cycle <= END_OF_TIME, "{cost:?}");
}

/// Every problem has a message without NaN.
fn told(problems: &[Problem], given: &str) {
    assert!(!problems.is_empty(), "refused without a reason");
    for problem in problems {
        let text = problem.to_string();
        assert!(text.len() > problem.path.len(), "{text}");
        assert!(!text.contains("NaN") || given.contains("NaN"), "{text}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plants_of_the_seeds_are_run() {
        for text in PLANTS {
            let experiment = judge(text).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
            let cost = experiment.cost();
            assert!(cost.records <= RUN_RECORDS && cost.motor_grid_steps <= RUN_MOTOR_STEPS, "{cost:?}");
            assert!(drive(&experiment) > 100);
            check(text.as_bytes());
        }
        let overload = judge(PLANTS[0]).ok().and_then(|experiment| {
            let mut run = PlantRun::new(&experiment, vec![(Digest::default(), ())])?;
            run.finish();
            run.overload(0)
        });
        assert!(overload.is_some(), "the threshold is reached");
    }
}
