//! The strategies keep their word: what they draw is legal input, and together it reaches the rules it aims
//! at.

use std::collections::BTreeMap;

use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::*;
use crate::oracle::{FRAMING, QUEUE_OVERFLOW, SHORT_PACKET, TOO_MANY_STEPS, byte_start, refused, run};

fn drawn(count: usize) -> Vec<(Config, Input)> {
    let mut runner = TestRunner::deterministic();
    (0..count).map(|_| cases(every_mode()).new_tree(&mut runner).expect("a case").current()).collect()
}

#[test]
fn sends_neither_overlap_nor_start_before_cycle_1() {
    for (config, input) in drawn(300) {
        let mut free_from = 1;
        for (start, bytes) in &input.sends {
            assert!(*start >= free_from && !bytes.is_empty(), "{config:?} {input:?}");
            let last = byte_start(&config, *start, bytes.len() as u64 - 1);
            free_from = last + 10 * config.clock_hz / config.baud;
        }
        assert!(input.forced.iter().all(|(cycle, length, _)| *cycle >= 1 && *length >= 1));
        assert!((1..=LONGEST_RUN).contains(&input.cycles));
    }
}

#[test]
fn the_cases_reach_every_mode_every_fault_and_both_sides_of_the_rules() {
    let mut reached: BTreeMap<String, usize> = BTreeMap::new();
    let mut count = |what: String| *reached.entry(what).or_default() += 1;
    let cases = 600;
    for (config, input) in drawn(cases) {
        if refused(&config) {
            count("refused".into());
            continue;
        }
        let run = run(&config, &input);
        for (fault, name) in [
            (FRAMING, "framing"),
            (SHORT_PACKET, "short packet"),
            (QUEUE_OVERFLOW, "queue overflow"),
            (TOO_MANY_STEPS, "too many steps"),
        ] {
            if run.faults & fault != 0 {
                count(name.into());
            }
        }
        if run.faults == 0 && run.ticks_done > 0 {
            count("no fault".into());
        }
        if run.ticks_done > 2 {
            let Config { spread, common_dir, staggered, .. } = config;
            count(format!("ticks: spread {spread}, common {common_dir}, staggered {staggered}"));
        }
    }
    println!("{reached:#?}");
    assert_eq!(reached.len(), 6 + 8, "{reached:#?}");
    assert!(reached.values().all(|&times| times >= cases / 60), "{reached:#?}");
    assert!(reached["refused"] < cases / 4, "{reached:#?}");
}
