//! Each rule at its limit and one cycle below it, and times that are not measured.

use super::*;

const STEP: u64 = 1;
const DIR: u64 = 1 << 16;
const IDLE: u64 = Levels::RESET.0;

/// A check of records, each of which toggles signals at a cycle.
fn checked(rules: &TimingRules, clock_hz: u32, toggles: &[(u64, u64)]) -> TimingCheck {
    let mut check = TimingCheck::new(rules, clock_hz, 1000);
    let mut levels = Levels::RESET;
    check.record(Record { cycle: Instant(0), levels });
    for (cycle, toggled) in toggles {
        levels.0 ^= toggled;
        check.record(Record { cycle: Instant(*cycle), levels });
    }
    check
}

/// Channel, rule, cycle, measured, required.
type Row = (u8, Rule, u64, u64, u64);
/// Toggles and the violations that they make.
type Case<'a> = (&'a [(u64, u64)], &'a [Row]);

fn found(check: &TimingCheck) -> Vec<Row> {
    let row = |v: &Violation| (v.channel, v.rule, v.at.0, v.measured.0, v.required.0);
    check.violations().iter().map(row).collect()
}

/// Rules that require `nanos` for `rule` and no other time.
fn only(rule: Rule, nanos: u32) -> TimingRules {
    let mut rules = TimingRules::default();
    let required = match rule {
        Rule::StepHigh => &mut rules.step_high_ns,
        Rule::StepLow => &mut rules.step_low_ns,
        Rule::DirSetup => &mut rules.dir_setup_ns,
        Rule::DirHold => &mut rules.dir_hold_ns,
        Rule::EnableWake => &mut rules.enable_wake_ns,
    };
    *required = nanos;
    assert_eq!(rule.nanos(&rules), nanos);
    rules
}

/// The toggles of a time of `cycles` that `rule` measures, and the channel's bits.
fn time(rule: Rule, cycles: u64) -> Vec<(u64, u64)> {
    match rule {
        Rule::StepHigh => alloc::vec![(5000, STEP), (5000 + cycles, STEP)],
        Rule::StepLow => alloc::vec![(10, STEP), (5000, STEP), (5000 + cycles, STEP)],
        Rule::DirSetup => alloc::vec![(5000, DIR), (5000 + cycles, STEP)],
        Rule::DirHold => alloc::vec![(5000, STEP), (5000 + cycles, DIR)],
        Rule::EnableWake => {
            alloc::vec![(10, Levels::EN), (5000, Levels::EN), (5000 + cycles, STEP)]
        }
    }
}

#[test]
fn each_rule_accepts_its_limit_and_rejects_one_cycle_less() {
    // 1900 ns are 30.4 cycles of 62.5 ns; 333 ns at 3 MHz are 0.999 cycles, 334 ns are 1.002.
    let limits: [(u32, u32, u64); 9] = [
        (16_000_000, 1900, 31),
        (16_000_000, 1000, 16),
        (16_000_000, 1, 1),
        (3_000_000, 333, 1),
        (3_000_000, 334, 2),
        (1_000_000_000, 107, 107),
        (7, 1_000_000_000, 7),
        (999_999_937, 1_000_000_000, 999_999_937),
        (72_000_000, 650, 47),
    ];
    for (clock_hz, nanos, limit) in limits {
        assert_eq!(cycles_at_least(nanos, clock_hz), Cycles(limit), "{nanos} ns at {clock_hz} Hz");
        for rule in Rule::ALL {
            let check = checked(&only(rule, nanos), clock_hz, &time(rule, limit));
            assert_eq!(found(&check), [], "{rule:?}, {nanos} ns at {clock_hz} Hz");
            let shortest = check.results()[rule as usize].shortest.expect("it was measured");
            assert_eq!((shortest.measured.0, shortest.at.0, shortest.channel), (limit, 5000 + limit, 0));
            if limit > 1 {
                let short = limit - 1;
                let check = checked(&only(rule, nanos), clock_hz, &time(rule, short));
                assert_eq!(found(&check), [(0, rule, 5000 + short, short, limit)]);
                assert_eq!((check.total(), check.results()[rule as usize].violations[0]), (1, 1));
            }
        }
    }
    assert_eq!(cycles_at_least(u32::MAX, u32::MAX), Cycles(18_446_744_066));
}

#[test]
fn levels_that_never_changed_are_not_measured() {
    // One pulse with DIR as at reset, cut by the end.
    let all = TimingRules {
        step_high_ns: 1_000_000_000,
        step_low_ns: 1_000_000_000,
        dir_setup_ns: 1_000_000_000,
        dir_hold_ns: 1_000_000_000,
        enable_wake_ns: 0,
    };
    let check = checked(&all, 16_000_000, &[(100, STEP)]);
    assert_eq!(found(&check), []);
    let measured: Vec<Rule> =
        check.results().iter().filter(|r| r.shortest.is_some()).map(|r| r.rule).collect();
    assert_eq!(measured, [Rule::EnableWake], "only the wake-up, which counts from reset");
    // Edges of the serial line are not measured.
    let check = checked(&all, 16_000_000, &[(5, Levels::RX), (6, Levels::TX | Levels::DE), (7, Levels::RX)]);
    assert!(check.results().iter().all(|result| result.shortest.is_none()));
}

#[test]
fn simultaneous_edges_and_enable_follow_the_rules() {
    use Rule::{DirHold, DirSetup, EnableWake, StepHigh};
    let rules = TimingRules {
        step_high_ns: 3,
        dir_setup_ns: 3,
        dir_hold_ns: 8,
        enable_wake_ns: 20,
        ..TimingRules::default()
    };
    let other = (STEP | DIR) << 15;
    let rows: &[Case] = &[
        // DIR that changes with the rise has a set-up of 0; its hold counts from the rise before.
        (
            &[(20, STEP), (25, STEP), (27, STEP | DIR), (30, STEP)],
            &[(0, DirHold, 27, 7, 8), (0, DirSetup, 27, 0, 3)],
        ),
        (&[(20, STEP), (25, STEP), (40, STEP | DIR)], &[(0, DirSetup, 40, 0, 3)]),
        // DIR violates the hold within a pulse, and just after a short one.
        (&[(20, STEP), (24, DIR), (25, STEP)], &[(0, DirHold, 24, 4, 8)]),
        (&[(20, STEP), (22, STEP | DIR)], &[(0, DirHold, 22, 2, 8), (0, StepHigh, 22, 2, 3)]),
        // The set-up is measured at each step.
        (
            &[(20, DIR), (21, STEP), (22, STEP), (22 + 1, STEP)],
            &[(0, DirSetup, 21, 1, 3), (0, StepHigh, 22, 1, 3)],
        ),
        // The wake-up is measured at a channel's first step after reset, and after each EN.
        (
            &[(19, STEP | STEP << 15), (25, STEP | STEP << 15), (30, STEP)],
            &[(0, EnableWake, 19, 19, 20), (15, EnableWake, 19, 19, 20)],
        ),
        (
            &[(30, Levels::EN), (40, Levels::EN), (40 + 19, STEP), (63, STEP), (70, STEP)],
            &[(0, EnableWake, 59, 19, 20)],
        ),
        (&[(30, Levels::EN), (40, Levels::EN | STEP)], &[(0, EnableWake, 40, 0, 20)]),
        // While EN is low there is no wake-up; a pulse cut by STOP is short.
        (&[(30, Levels::EN), (31, STEP), (35, STEP), (60, Levels::EN), (80, STEP)], &[]),
        (&[(20, STEP), (21, STEP | Levels::EN)], &[(0, StepHigh, 21, 1, 3)]),
        // One cycle's channels in ascending order.
        (
            &[(30, STEP | other), (32, STEP | other)],
            &[
                (15, DirSetup, 30, 0, 3),
                (0, StepHigh, 32, 2, 3),
                (15, DirHold, 32, 2, 8),
                (15, StepHigh, 32, 2, 3),
            ],
        ),
    ];
    for (toggles, expected) in rows {
        assert_eq!(found(&checked(&rules, 1_000_000_000, toggles)), *expected, "{toggles:?}");
    }
}

#[test]
fn only_the_first_violations_are_listed_and_all_are_counted() {
    let mut check = TimingCheck::new(&only(Rule::StepHigh, 10), 1_000_000_000, 3);
    for pulse in 1..=5_u64 {
        let width = if pulse == 4 { 2 } else { 9 };
        check.record(Record { cycle: Instant(pulse * 100), levels: Levels(IDLE | STEP << 2) });
        check.record(Record { cycle: Instant(pulse * 100 + width), levels: Levels(IDLE) });
    }
    assert_eq!(check.violations().iter().map(|v| v.at.0).collect::<Vec<_>>(), [109, 209, 309]);
    let result = &check.results()[0];
    assert_eq!((check.total(), result.total(), result.violations[2]), (5, 5, 5));
    assert_eq!(result.shortest, Some(Shortest { measured: Cycles(2), at: Instant(402), channel: 2 }));
    for (at, forward, expected) in [
        (0, true, Some(0)),
        (108, true, Some(0)),
        (109, true, Some(1)),
        (309, true, None),
        (310, false, Some(2)),
        (309, false, Some(1)),
        (109, false, None),
    ] {
        assert_eq!(check.next(Instant(at), forward), expected, "{at}, forward {forward}");
    }
}

#[test]
fn rules_longer_than_the_pulses_of_a_run_are_violated() {
    use crate::trace::{
        drivers::TB6600_CLASS,
        timing::{Rule, TimingCheck},
    };
    use stepscope_scenario::TimingRules;
    use stepscope_sim::Experiment;

    // The default motion's pulses of 2.5 us are just long enough for an opto-isolated driver.
    let experiment = Experiment::from_json("{}").expect("the default motion");
    let violations = |rules: &TimingRules| {
        let mut check = TimingCheck::new(rules, experiment.config().clock_hz(), 10);
        experiment.run(&mut check);
        (check.total(), check.violations().first().map(|violation| violation.rule))
    };
    assert_eq!(violations(&TB6600_CLASS.rules), (0, None));
    let longer = TimingRules { step_high_ns: 3000, ..TB6600_CLASS.rules.clone() };
    assert_eq!(violations(&longer), (3200, Some(Rule::StepHigh)));
}
