//! Stand-alone controllers against an independent model (CONTROLLER.md G1 to G8): random setups, programs, presses, switches
//! and power cuts, of which every edge, panel record, byte of memory and digest is the same, at both speeds.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::expect_used, clippy::panic, reason = "what is missing fails the test")]

use stepscope_core::{
    peripheral::signal::Record,
    sim::{Experiment, Run},
};
use stepscope_tests::controller_oracle::{self as oracle, Case, Outcome, random_case, refused, to_json};

/// Random cases; `PROPTEST_CASES` sets another number.
const CASES: u64 = 400;
/// Work that a case may be to the slow model.
const MAX_CYCLES: u64 = 50_000_000;
const MAX_STEPS: u64 = 400_000;
/// Cycles up to which a case is also run clock by clock.
const MAX_CLOCKED: u64 = 200_000;

fn cases() -> u64 {
    std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(CASES)
}

fn first() -> u64 {
    std::env::var("FIRST_CASE").ok().and_then(|cases| cases.parse().ok()).unwrap_or(0)
}

#[test]
fn random_controllers_are_the_models_to_the_cycle() {
    let mut compared = 0;
    for seed in first()..first() + cases() {
        let case = random_case(seed);
        let json = to_json(&case);
        let experiment = match Experiment::from_json(&json) {
            Ok(experiment) => experiment,
            Err(problems) => panic!("seed {seed}: {problems:?}\n{json}"),
        };
        let Some(expected) = oracle::run_up_to(&case, MAX_CYCLES, MAX_STEPS) else { continue };
        let mut trace: Vec<Record> = Vec::new();
        let run = experiment.run(&mut trace);
        same(seed, &expected, &trace, &run, &json);
        if expected.cycles < MAX_CLOCKED {
            let mut clocked: Vec<Record> = Vec::new();
            let run = experiment.run_clock_by_clock(&mut clocked);
            same(seed, &expected, &clocked, &run, &json);
        }
        compared += 1;
    }
    assert!(compared * 2 > cases(), "only {compared} cases were no more work than the slow model may have");
}

fn same(seed: u64, expected: &Outcome, trace: &[Record], run: &Run, json: &str) {
    let machine = run.stand_alone().expect("controllers");
    for (index, theirs) in expected.controllers.iter().enumerate() {
        let ours = machine.panel(index);
        for (at, (a, b)) in ours.iter().zip(&theirs.panel).enumerate() {
            let a = (a.cycle.0, a.word.0, a.position, a.display);
            let b = (b.cycle, b.word, i64::from(b.position), b.display);
            let before = &theirs.panel[at.saturating_sub(3)..at];
            assert!(
                a == b,
                "seed {seed}: panel {index}, record {at}: {a:x?}, model {b:x?}; before it {before:x?}\n{json}"
            );
        }
        assert_eq!(ours.len(), theirs.panel.len(), "seed {seed}: panel {index}\n{json}");
    }
    for (at, (record, expected)) in trace.iter().zip(&expected.trace).enumerate() {
        let ours = (record.cycle.0, record.levels.0);
        assert!(ours == *expected, "seed {seed}: record {at}: {ours:x?}, model {expected:x?}\n{json}");
    }
    assert_eq!(trace.len(), expected.trace.len(), "seed {seed}: edges\n{json}");
    for (index, theirs) in expected.controllers.iter().enumerate() {
        assert_eq!(machine.memory(index), theirs.memory, "seed {seed}: memory {index}\n{json}");
        assert_eq!(machine.writes(index), theirs.writes, "seed {seed}: writes {index}\n{json}");
        assert_eq!(machine.position(index), Some(theirs.position), "seed {seed}: position {index}\n{json}");
        assert_eq!(machine.axis_place(index), Some(theirs.place), "seed {seed}: place {index}\n{json}");
        assert_eq!(machine.axis_error(index), Some(theirs.error), "seed {seed}: error {index}\n{json}");
    }
    assert_eq!(machine.panel_digest(), expected.panel_digest, "seed {seed}");
    assert_eq!(machine.work().is_some(), expected.work.is_some(), "seed {seed}\n{json}");
}

/// What the model refuses, the scenario refuses at the same paths.
#[test]
fn a_refused_case_is_refused_at_the_same_paths() {
    let mut case: Case = random_case(1);
    assert!(refused(&case).is_empty());
    case.controllers[0].max_speed_hz = 10_000_000;
    let expected = refused(&case);
    let problems = Experiment::from_json(&to_json(&case)).expect_err("too fast");
    let found: Vec<&str> = problems.iter().map(|problem| problem.path.as_str()).collect();
    assert_eq!(found, expected);
}
