//! The timing check compared with brute force, which measures every time cycle by cycle in random traces and
//! compares it with its rule in exact arithmetic.

use proptest::prelude::*;
use stepscope_core::{
    inspect::trace::{
        drivers,
        timing::{Rule, TimingCheck},
    },
    peripheral::{
        signal::{Levels, Record, Sink},
        units::Instant,
    },
    scenario::{Scenario, TimingRules, presets::PRESETS},
    sim::Experiment,
};

const CHANNELS: [u8; 3] = [0, 7, 15];

/// Pauses and the changes after each.
fn traces() -> impl Strategy<Value = Vec<Record>> {
    let signals = CHANNELS.iter().flat_map(|channel| [*channel, channel + 16]).chain([32, 33]);
    let toggled = prop::collection::vec(prop::sample::select(signals.collect::<Vec<u8>>()), 1..4);
    let pause = prop_oneof![6 => 1..6_u64, 1 => 1..40_u64];
    prop::collection::vec((pause, toggled), 0..60).prop_map(|changes| {
        let mut last = Record { cycle: Instant(0), levels: Levels::RESET };
        let mut trace = vec![last];
        for (pause, toggled) in changes {
            last.cycle.0 += pause;
            let mask = toggled.iter().fold(0, |mask, bit| mask | 1 << bit);
            last.levels.0 ^= mask;
            trace.push(last);
        }
        trace
    })
}

fn rules() -> impl Strategy<Value = TimingRules> {
    let nanos = || prop_oneof![2 => 0..20_000_u32, 1 => 0..2_000_u32, 1 => Just(0)];
    (nanos(), nanos(), nanos(), nanos(), nanos()).prop_map(
        |(step_high_ns, step_low_ns, dir_setup_ns, dir_hold_ns, enable_wake_ns)| TimingRules {
            step_high_ns,
            step_low_ns,
            dir_setup_ns,
            dir_hold_ns,
            enable_wake_ns,
        },
    )
}

/// A time: channel, rule, the cycle at its end, its length.
type Time = (u8, Rule, u64, u64);

/// All times of a trace, in the order of the check's report.
fn times(trace: &[Record]) -> Vec<Time> {
    let end = trace.last().map_or(0, |record| record.cycle.0);
    let levels: Vec<u64> = (0..=end)
        .map(|cycle| trace.iter().rev().find(|record| record.cycle.0 <= cycle).map_or(0, |r| r.levels.0))
        .collect();
    let high = |cycle: u64, bit: u8| levels[cycle as usize] >> bit & 1 == 1;
    let rises = |cycle: u64, bit: u8| cycle > 0 && high(cycle, bit) && !high(cycle - 1, bit);
    let falls = |cycle: u64, bit: u8| cycle > 0 && !high(cycle, bit) && high(cycle - 1, bit);
    let turns = |cycle: u64, bit: u8| rises(cycle, bit) || falls(cycle, bit);
    let mut found = Vec::new();
    for cycle in 1..=end {
        for channel in CHANNELS {
            let (step, dir) = (channel, channel + 16);
            let mut add = |rule, from: Option<u64>| {
                if let Some(from) = from {
                    found.push((channel, rule, cycle, cycle - from));
                }
            };
            if turns(cycle, dir) {
                add(Rule::DirHold, (0..cycle).rev().find(|c| rises(*c, step)));
            }
            if falls(cycle, step) {
                add(Rule::StepHigh, (0..cycle).rev().find(|c| rises(*c, step)));
            }
            if rises(cycle, step) {
                add(Rule::StepLow, (0..cycle).rev().find(|c| falls(*c, step)));
                add(Rule::DirSetup, (0..=cycle).rev().find(|c| turns(*c, dir)));
                let enabled = (0..=cycle).rev().find(|c| *c == 0 || rises(*c, 32));
                let first = enabled.filter(|from| {
                    (*from..=cycle).all(|c| high(c, 32)) && (*from..cycle).all(|c| !rises(c, step) || c == 0)
                });
                add(Rule::EnableWake, first);
            }
        }
    }
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn the_check_agrees_with_brute_force(
        trace in traces(),
        rules in rules(),
        clock_hz in prop_oneof![Just(1_000_000), 1..5_000_000_u32],
        most_kept in prop_oneof![Just(usize::MAX), 0..5_usize],
    ) {
        let mut check = TimingCheck::new(&rules, clock_hz, most_kept);
        trace.iter().for_each(|record| check.record(*record));
        let times = times(&trace);
        let kept = |rule: Rule, cycles: u64| {
            u128::from(cycles) * 1_000_000_000 >= u128::from(rule.nanos(&rules)) * u128::from(clock_hz)
        };
        let broken: Vec<Time> = times.iter().copied().filter(|time| !kept(time.1, time.3)).collect();

        let found: Vec<Time> =
            check.violations().iter().map(|v| (v.channel, v.rule, v.at.0, v.measured.0)).collect();
        prop_assert_eq!(&found, &broken[..broken.len().min(most_kept)]);
        for violation in check.violations() {
            let required = violation.required.0;
            prop_assert!(kept(violation.rule, required) && !kept(violation.rule, required - 1));
        }
        prop_assert_eq!(check.total(), broken.len() as u64);
        for (rule, result) in Rule::ALL.iter().zip(check.results()) {
            prop_assert_eq!(result.rule, *rule);
            for channel in 0..16 {
                let count = broken.iter().filter(|time| (time.0, time.1) == (channel, *rule)).count();
                prop_assert_eq!(result.violations[usize::from(channel)], count as u64);
            }
            let of_rule = times.iter().filter(|time| time.1 == *rule);
            let least = of_rule.min_by_key(|time| time.3).map(|time| (time.0, time.2, time.3));
            prop_assert_eq!(result.shortest.map(|least| (least.channel, least.at.0, least.measured.0)), least);
        }
    }
}

/// Violations of each rule of its own driver by the pulses of a scenario.
fn violations(scenario: &Scenario) -> [u64; 5] {
    let rules = scenario.driver_timing.as_ref().map(drivers::rules).unwrap_or_default();
    let mut check = TimingCheck::new(&rules, scenario.clock_hz, 0);
    Experiment::new(scenario).expect("has no problems").run(&mut check);
    let mut totals = [0; 5];
    totals.iter_mut().zip(check.results()).for_each(|(total, result)| *total = result.total());
    totals
}

#[test]
fn the_broken_preset_has_the_violations_and_fixes_of_its_note() {
    let preset = PRESETS.iter().find(|preset| preset.id == "driver-timing-broken").expect("it is there");
    let mut scenario = preset.scenario();
    // 128 pulses, three changes of direction: right from reset, left, right.
    assert_eq!(violations(&scenario), [128, 0, 3, 0, 0]);
    scenario.bus.pulse_width_cycles = 31;
    scenario.bus.dir_setup_cycles = 10;
    assert_eq!(violations(&scenario), [0, 0, 3, 0, 0]);
    scenario.bus.dir_setup_cycles = 11;
    assert_eq!(violations(&scenario), [0; 5]);
}
