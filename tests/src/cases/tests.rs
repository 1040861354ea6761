//! The strategies draw valid input that reaches the intended rules.

use std::collections::BTreeMap;

use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::lines::LONGEST_CONVERSATION;
use super::*;
use crate::oracle::segments::{Rule, Segment};
use crate::oracle::{
    BAD_SEQ, CRC, FRAMING, OVERLONG, QUEUE_OVERFLOW, Run, RxEvent, SHORT_PACKET, TOO_MANY_STEPS, UNDERRUN,
    bits, byte_start, hear, kinds, refused, run, run_line, run_segments,
};

fn drawn<S: Strategy>(strategy: S, count: usize) -> Vec<S::Value> {
    let mut runner = TestRunner::deterministic();
    (0..count).map(|_| strategy.new_tree(&mut runner).expect("a case").current()).collect()
}

/// How often each thing was reached.
#[derive(Debug, Default)]
struct Reached(BTreeMap<String, usize>);

impl Reached {
    fn count(&mut self, what: impl Into<String>) {
        *self.0.entry(what.into()).or_default() += 1;
    }

    fn count_faults(&mut self, faults: u16) {
        for (bit, name) in [
            (FRAMING, "framing"),
            (SHORT_PACKET, "short packet"),
            (CRC, "check"),
            (OVERLONG, "overlong"),
            (QUEUE_OVERFLOW, "queue overflow"),
            (TOO_MANY_STEPS, "too many steps"),
            (BAD_SEQ, "bad seq"),
            (UNDERRUN, "underrun"),
        ] {
            if faults & bit != 0 {
                self.count(name);
            }
        }
        if faults == 0 {
            self.count("no fault");
        }
    }

    fn count_mode(&mut self, config: &Config) {
        let Config { spread, common_dir, staggered, .. } = config;
        self.count(format!("ticks: spread {spread}, common {common_dir}, staggered {staggered}"));
    }

    /// Checks that this number of things was reached, each at least this often.
    fn check(&self, things: usize, least: usize) {
        println!("{self:#?}");
        assert_eq!(self.0.len(), things, "{self:#?}");
        assert!(self.0.values().all(|&times| times >= least), "{self:#?}");
    }
}

/// Sends neither overlap nor start before cycle 1.
fn check_input(config: &Config, input: &Input, longest: u64) {
    let mut free_from = 1;
    for (start, bytes) in &input.sends {
        assert!(*start >= free_from && !bytes.is_empty(), "{config:?} {input:?}");
        let last = byte_start(config, *start, bytes.len() as u64 - 1);
        free_from = last + 10 * config.clock_hz / config.baud;
    }
    assert!(input.forced.iter().all(|(cycle, length, _)| *cycle >= 1 && *length >= 1));
    assert!((1..=longest).contains(&input.cycles));
}

/// Common fields are equal, and addresses differ.
fn check_line(line: &[Config]) {
    assert!((1..=4).contains(&line.len()));
    for (k, config) in line.iter().enumerate() {
        assert_eq!((config.clock_hz, config.baud), (line[0].clock_hz, line[0].baud));
        let own = config.address.unwrap_or(0);
        assert!(own != 255 && line[..k].iter().all(|other| other.address != Some(own)), "{line:?}");
    }
}

#[test]
fn raw_cases_reach_every_mode_fault_and_refusal() {
    let mut reached = Reached::default();
    let cases_drawn = 600;
    for (config, input) in drawn(cases(every_mode()), cases_drawn) {
        check_input(&config, &input, LONGEST_RUN);
        if refused(&config) {
            reached.count("refused");
            continue;
        }
        let run = run(&config, &input);
        if run.faults != 0 || run.ticks_done > 0 {
            reached.count_faults(run.faults);
        }
        if run.ticks_done > 2 {
            reached.count_mode(&config);
        }
    }
    // Five faults or none, eight modes, refused.
    reached.check(4 + 1 + 8 + 1, cases_drawn / 60);
    assert!(reached.0["refused"] < cases_drawn / 4, "{reached:#?}");
}

#[test]
fn raw_lines_move_several_controllers() {
    let mut reached = Reached::default();
    let lines = 200;
    for (line, input) in drawn(raw_lines(every_mode()), lines) {
        check_line(&line);
        check_input(&line[0], &input, LONGEST_RUN);
        if line.iter().any(refused) {
            reached.count("refused");
            continue;
        }
        let moved = run_line(&line, &input).iter().filter(|run| run.positions != [0; 16]).count();
        reached.count(match (line.len(), moved) {
            (1, _) => "a lone one",
            (_, 2..) => "several moved",
            (_, 1) => "one of several moved",
            (_, _) => "none of several moved",
        });
    }
    reached.check(5, lines / 20);
    assert!(reached.0["refused"] < lines / 2, "{reached:#?}");
}

/// The levels of one signal, one per cycle.
fn levels(run: &Run, bit: u32, cycles: u64) -> Vec<bool> {
    let ends = run.trace.iter().skip(1).map(|(cycle, _)| *cycle).chain([cycles]);
    let stretches = run.trace.iter().zip(ends);
    stretches.flat_map(|((from, levels), to)| vec![levels >> bit & 1 == 1; (to - from) as usize]).collect()
}

/// The cycles p of the frames whose reply has positions: ten bit times before DE rises for it.
fn positions_told(config: &Config, said: &[u8], de: &[bool]) -> Vec<u64> {
    let rises = (1..de.len()).filter(|at| de[*at] && !de[at - 1]);
    // Code, address and kind; if the address is 0, which COBS removes, two codes and the kind.
    let replies = said.split(|byte| *byte == 0);
    let told = rises.zip(replies).filter(|(_, reply)| reply.get(2) == Some(&(kinds::POSITIONS | 0x80)));
    told.map(|(rise, _)| rise as u64 - 10 * bit_time(config)).collect()
}

#[test]
fn framed_lines_reach_every_fault_reply_and_state() {
    let mut reached = Reached::default();
    let lines = 500;
    let mut cycles = 0;
    for (line, input) in drawn(framed_lines(every_mode()), lines) {
        check_line(&line);
        check_input(&line[0], &input, LONGEST_CONVERSATION);
        if line.iter().any(refused) {
            reached.count("refused");
            continue;
        }
        reached.count(format!("{} controllers", line.len()));
        cycles += input.cycles;
        let runs = run_line(&line, &input);
        for (config, run) in line.iter().zip(&runs) {
            let de = levels(run, bits::DE, input.cycles);
            reached.count_faults(run.faults);
            reached.count(format!("{:?} in the end", run.state));
            if run.ticks_done > 2 {
                reached.count_mode(config);
            }
            if input.sends.iter().any(|(start, _)| de.get(*start as usize) == Some(&true)) {
                reached.count("a send in a reply");
            }
            let replies = hear(config, &levels(run, bits::TX, input.cycles));
            let said: Vec<u8> = replies
                .into_iter()
                .filter_map(|(_, heard)| if let RxEvent::Byte(byte) = heard { Some(byte) } else { None })
                .collect();
            for reason in 1..=7 {
                if said.windows(2).any(|pair| pair == [kinds::NAK, reason]) {
                    reached.count(format!("NAK {reason}"));
                }
            }
            for p in positions_told(config, &said, &de) {
                let step = |cycle: u64| {
                    let after = run.trace.partition_point(|(from, _)| *from <= cycle);
                    run.trace[after - 1].1 & 0xFFFF
                };
                if config.channels > 4 {
                    reached.count("positions of more than four channels");
                }
                if p < config.boot {
                    reached.count("positions during boot");
                }
                if step(p) & !step(p - 1) != 0 {
                    reached.count("positions as STEP rises");
                }
                if step(p) != 0 {
                    reached.count("positions while STEP is high");
                }
            }
            for kind in kinds::TICKS..=kinds::POSITIONS {
                if said.contains(&(kind | 0x80)) {
                    reached.count(format!("ACK {kind}"));
                }
            }
        }
    }
    println!("{cycles} cycles");
    // Eight faults or none, four states, eight modes, seven reasons, seven kinds, one to four controllers, a send in
    // a reply; positions of many channels, during boot, while STEP is high, and in the cycle in which it rises.
    assert!(reached.0.remove("refused").is_some_and(|times| times < lines / 4), "{reached:#?}");
    reached.check(8 + 1 + 4 + 8 + 7 + 7 + 4 + 1 + 4, lines / 60);
}

#[test]
fn controllers_with_the_same_address_reply_together() {
    let mut reached = 0;
    for (line, input) in drawn(framed_lines_of_one_address(every_mode()), 100) {
        if line.iter().any(refused) {
            continue;
        }
        let runs = run_line(&line, &input);
        let driven: Vec<Vec<bool>> = runs.iter().map(|run| levels(run, bits::DE, input.cycles)).collect();
        let at_once = |cycle: usize| driven.iter().filter(|de| de[cycle]).count();
        reached += usize::from((0..input.cycles as usize).any(|cycle| at_once(cycle) > 1));
    }
    assert!(reached >= 20, "{reached}");
}

#[test]
fn segment_lists_reach_every_refusal_and_both_directions() {
    let mut reached = Reached::default();
    let lists_drawn = 2_000;
    for SegmentCase { config, lists, cycles } in drawn(segment_lists(every_mode()), lists_drawn) {
        assert!(!refused(&config) && lists.len() == config.channels);
        match run_segments(&config, &lists, cycles) {
            Err(refused) => reached.count(format!("{:?}", refused.rule)),
            Ok(run) => {
                reached.count("taken");
                let level = |bit: u32| levels(&run, bit, cycles);
                if level(bits::DIR).windows(2).filter(|pair| pair[0] != pair[1]).count() > 2 {
                    reached.count("turns");
                }
                let least = (config.pulse_width + (config.dir_hold + config.dir_setup).max(1)) << 16;
                let steps_at_least = |segment: &Segment| matches!(segment, Segment::Steps { interval, .. } if *interval == least);
                if lists.iter().any(|(_, list)| list.iter().any(steps_at_least)) {
                    reached.count("an interval as short as may be");
                }
                if lists.iter().any(|(_, list)| matches!(list.last(), Some(Segment::Dwell(_)))) {
                    reached.count("a dwell last");
                }
            }
        }
    }
    let rules = [
        Rule::StartBeforeCycle1,
        Rule::NoSteps,
        Rule::ShortInterval,
        Rule::IntervalLeavesU64,
        Rule::NextLeavesU64,
    ];
    assert!(rules.iter().all(|rule| reached.0.contains_key(&format!("{rule:?}"))), "{reached:#?}");
    reached.check(rules.len() + 4, lists_drawn / 100);
    assert!(reached.0["taken"] > lists_drawn / 3, "{reached:#?}");
}
