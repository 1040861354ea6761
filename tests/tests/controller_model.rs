//! Compares stand-alone controllers with an independent model (CONTROLLER.md G1 to G8): for random setups, programs, presses,
//! switches and power cuts, every edge, panel record, byte of memory and digest is the same, at both speeds.

use stepscope_core::{
    peripheral::signal::Record,
    sim::{Experiment, Run},
};
use stepscope_tests::controller_oracle::{
    self as oracle, Case, Content, Outcome, random_case, refused, to_json,
};

/// Number of random cases, unless `PROPTEST_CASES` sets another.
const CASES: u64 = 400;
/// Maximum work of a case for the slow model.
const MAX_CYCLES: u64 = 50_000_000;
const MAX_STEPS: u64 = 400_000;
/// Maximum cycles of a case that is also run clock by clock.
const MAX_CLOCKED: u64 = 200_000;

fn cases() -> u64 {
    std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(CASES)
}

fn first() -> u64 {
    std::env::var("FIRST_CASE").ok().and_then(|cases| cases.parse().ok()).unwrap_or(0)
}

#[test]
fn random_controllers_match_the_model_in_every_cycle() {
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
        assert_eq!(machine.axis_position(index), Some(theirs.place), "seed {seed}: place {index}\n{json}");
        assert_eq!(machine.axis_error(index), Some(theirs.error), "seed {seed}: error {index}\n{json}");
    }
    assert_eq!(machine.panel_digest(), expected.panel_digest, "seed {seed}");
    assert_eq!(machine.too_many_groups().is_some(), expected.work.is_some(), "seed {seed}\n{json}");
}

/// Values that the model refuses have problems at the same paths in the scenario.
#[test]
fn model_and_core_refuse_a_case_at_the_same_paths() {
    let mut case: Case = random_case(1);
    assert!(refused(&case).is_empty());
    case.controllers[0].max_speed_hz = 10_000_000;
    let expected = refused(&case);
    let problems = Experiment::from_json(&to_json(&case)).expect_err("too fast");
    let found: Vec<&str> = problems.iter().map(|problem| problem.path.as_str()).collect();
    assert_eq!(found, expected);
}

/// The newest record in memory has the maximum number (G7). A later record never becomes the newest, so it
/// is written repeatedly.
#[test]
fn endless_writes_end_with_the_run_with_equal_wear_at_both_speeds() {
    let open = Content { position: 5, trust: 1, open: true, group: 0, of_loop: 0 };
    let newest = oracle::journal_record(u32::MAX, open);
    let initial: String = newest.iter().map(|byte| format!("{byte:02x}")).collect();
    let scenario = |run: &str, fields: &str, byte: u64| {
        format!(
            r#"{{"clock_hz":100000,{run}"bus":{{"pulse_width_cycles":2}},"source":{{"standalone":[{{
                "self_test_cycles":10,"debounce_cycles":0,"max_speed_hz":1000,"groups":[{{"move":{{"length":1,"speed_hz":1000}}}}],
                "memory":{{"policy":"write_ahead","byte_write_cycles":{byte},"initial":"{initial}"}},{fields}}}]}}}}"#
        )
    };
    let rows = [
        // It is idle.
        (scenario(r#""run_cycles":5000,"#, r#""inputs":[]"#, 3), 5000 / 48),
        // Presses during the run, and a power cut.
        (
            scenario(
                r#""run_cycles":9001,"#,
                r#""inputs":[{"cycle":1234,"input":"start"},{"cycle":3001,"input":"power","level":0},{"cycle":7000,"input":"power"}]"#,
                7,
            ),
            20,
        ),
    ];
    for (json, least) in rows {
        let experiment = Experiment::from_json(&json).expect("no problems");
        let (mut fast, mut clocked): (Vec<Record>, Vec<Record>) = (Vec::new(), Vec::new());
        let (run, clock) = (experiment.run(&mut fast), experiment.run_clock_by_clock(&mut clocked));
        let (run, clock) = (run.stand_alone().expect("one"), clock.stand_alone().expect("one"));
        assert_eq!((fast, run.panel(0)), (clocked, clock.panel(0)), "{json}");
        assert_eq!((run.memory(0), run.writes(0)), (clock.memory(0), clock.writes(0)), "{json}");
        let most = run.writes(0).iter().copied().max().expect("cells");
        assert!(most >= least, "{most} writes\n{json}");
    }
    // An event in 3000 years.
    let far = scenario("", r#""inputs":[{"cycle":9000000000000000,"input":"in_0"}]"#, 1);
    let experiment = Experiment::from_json(&far).expect("no problems");
    let run = experiment.run(&mut Vec::<Record>::new());
    assert_eq!(run.stand_alone().expect("one").writes(0).iter().max(), Some(&u32::MAX));
}
