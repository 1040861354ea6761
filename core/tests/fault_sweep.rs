//! A short fault sweep: seeds of faults with and without the framed protocol. The long form is
//! `stepscope faults --seeds 100000`.

use stepscope_core::{
    peripheral::config::Protocol,
    scenario::{Noise, Scenario},
    sim::fault_sweep::{FaultSweep, Tally},
};

fn sweep(protocol: Protocol) -> FaultSweep {
    FaultSweep::new(FaultSweep::small(protocol)).expect("the small scenario has no problems")
}

fn run(sweep: &FaultSweep, seeds: u32) -> Tally {
    (0..seeds).fold(Tally::default(), |mut sum, seed| {
        sum += sweep.run(seed).expect("seeds make no problems");
        sum
    })
}

#[test]
fn framed_ticks_are_executed_exactly_once_despite_line_faults() {
    let sweep = sweep(Protocol::Framed);
    let tally = run(&sweep, 300);
    assert_eq!((tally.seeds, tally.wrong_seeds, tally.is_wrong()), (300, 0, false), "{tally:?}");
    // A host that may repeat completes its job unless no byte passes, and gives up for no other reason.
    assert_eq!((tally.given_up_in_reach, tally.stuck, tally.cut), (0, 0, 0), "{tally:?}");
    assert_eq!(tally.executed + tally.unreached, tally.commanded, "{tally:?}");
    assert_eq!(tally.commanded % 300, 0);
    // Every kind of fault has an effect.
    for count in [
        tally.repeated,
        tally.crashes,
        tally.bad_check,
        tally.short,
        tally.framing,
        tally.replies_lost,
        tally.acknowledged_again,
        tally.given_up,
    ] {
        assert!(count > 0, "{tally:?}");
    }
}

#[test]
fn raw_packets_are_lost_or_corrupted_by_line_faults() {
    let tally = run(&sweep(Protocol::Raw), 100);
    assert_eq!((tally.repeated, tally.replies, tally.unreached), (0, 0, 0));
    for count in [tally.wrong_seeds, tally.wrong, tally.wrong_steps, tally.missing, tally.position_error] {
        assert!(count > 0, "{tally:?}");
    }
}

#[test]
fn a_line_without_faults_executes_all_ticks_in_both_protocols() {
    let quiet = |protocol| {
        let sweep = sweep(protocol);
        let is_quiet = |scenario: &Scenario| {
            let noise = Noise { seed: scenario.line.noise.seed, ..Noise::default() };
            scenario.line.noise == noise && scenario.line.receiver_baud.is_none()
        };
        // A mixture may have no noise.
        let seed = (0..10_000).find(|&seed| is_quiet(&sweep.scenario(seed))).expect("there is one");
        sweep.run(seed).expect("no problems")
    };
    for protocol in [Protocol::Raw, Protocol::Framed] {
        let tally = quiet(protocol);
        assert!(!tally.is_wrong() && tally.executed == tally.commanded && tally.repeated == 0, "{tally:?}");
    }
}

/// The scenario of a seed reproduces the seed.
#[test]
fn a_seeds_scenario_reproduces_itself() {
    let sweep = sweep(Protocol::Framed);
    for seed in 0..50 {
        let scenario = sweep.scenario(seed);
        assert_eq!(scenario.line.noise.seed, seed);
        let again = FaultSweep::new(scenario.clone()).expect("no problems").scenario(seed);
        assert_eq!((again.line, again.source), (scenario.line, scenario.source));
    }
}

#[test]
fn several_controllers_and_a_line_held_low_lose_no_step() {
    let json = r#"{
        "bus": { "channels": 2, "queue_depth": 3 },
        "line": { "baud": 460800, "protocol": "framed", "address": 5, "host": { "attempts": 255 },
            "glitches": [ { "start_cycle": 300000, "length_cycles": 200000, "level": 0 } ] },
        "source": { "packets": { "packets": [ "8102", "8304", "8506", "0708", "090a", "8b8c" ] } },
        "controllers": [ { "address": 9, "bus": { "slots": 50, "queue_depth": 1 },
            "packets": [ "81", "02", "83", "04", "85" ] } ] }"#;
    let base = Scenario::from_json(json).expect("reads");
    let tally = run(&FaultSweep::new(base).expect("no problems"), 60);
    assert!(!tally.is_wrong(), "{tally:?}");
    assert_eq!((tally.given_up_in_reach, tally.stuck, tally.commanded), (0, 0, 60 * (7 + 6)), "{tally:?}");
    assert!(tally.repeated > 0 && tally.crashes > 0, "{tally:?}");
}

#[test]
fn a_base_without_ticks_is_rejected() {
    let base = Scenario::from_json(r#"{ "source": { "line": {} } }"#).expect("reads");
    let problems = FaultSweep::new(base).expect_err("there is nothing to go wrong");
    assert_eq!(problems[0].path, "source");
}
