//! Random controllers run the same cycle by cycle and event by event: trace, panel, memory, wear, end (DESIGN A2).

use crate::common::{self, Random};
use std::collections::BTreeMap;
use stepscope_controller::{StandAlone, State, input::Change, input::Signal};
use stepscope_peripheral::{
    signal::Record,
    units::{Cycles, Instant},
};

/// Runs without end are compared up to this cycle.
const MAX_CYCLES: u64 = 40_000;

/// The seeds: 400 from 0, or as set by environment variables.
fn seeds() -> std::ops::Range<u64> {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let first = number("STEPSCOPE_FIRST_SEED").unwrap_or(0);
    first..first + number("STEPSCOPE_SEEDS").unwrap_or(400)
}

fn compare(seed: u64, slow: &StandAlone, fast: &StandAlone) {
    assert_eq!(slow.now(), fast.now(), "seed {seed}: the end");
    assert_eq!(slow.too_many_groups(), fast.too_many_groups(), "seed {seed}: work");
    assert_eq!(slow.is_idle(), fast.is_idle(), "seed {seed}: rest");
    assert_eq!(slow.positions(), fast.positions(), "seed {seed}: positions");
    for i in 0..slow.checked().controllers().len() {
        assert_eq!(slow.panel(i), fast.panel(i), "seed {seed}: panel {i}");
        assert_eq!(slow.memory(i), fast.memory(i), "seed {seed}: memory {i}");
        assert_eq!(slow.writes(i), fast.writes(i), "seed {seed}: wear {i}");
        assert_eq!(slow.ignored(i), fast.ignored(i), "seed {seed}: presses {i}");
        let position =
            |machine: &StandAlone| (machine.axis_position(i), machine.axis_error(i), machine.word(i));
        assert_eq!(position(slow), position(fast), "seed {seed}: axis {i}");
        assert_eq!(slow.numbers(i), fast.numbers(i), "seed {seed}: numbers {i}");
    }
    assert_eq!(slow.panel_digest(), fast.panel_digest());
}

#[test]
fn cycle_by_cycle_and_event_by_event_runs_are_equal() {
    let mut seen: BTreeMap<(u8, u8), u64> = BTreeMap::new();
    for seed in seeds() {
        let checked =
            common::setup(seed).check().unwrap_or_else(|refused| panic!("seed {seed}: {refused:?}"));
        let (mut slow, mut slow_trace) = (StandAlone::new(&checked), Vec::<Record>::new());
        while slow.now() < Instant(MAX_CYCLES) && !slow.is_idle() {
            slow.clock(&mut slow_trace);
        }
        let (mut fast, mut fast_trace) = (StandAlone::new(&checked), Vec::<Record>::new());
        fast.run(if slow.is_idle() { Instant::NEVER } else { Instant(MAX_CYCLES) }, &mut fast_trace);
        assert_eq!(slow_trace, fast_trace, "seed {seed}: trace");
        compare(seed, &slow, &fast);
        for record in fast.panel(0) {
            let state_and_alarm = (record.word.state() as u8, record.word.alarm() as u8);
            *seen.entry(state_and_alarm).or_default() += 1;
        }
    }
    println!("{seen:?}");
    for state in State::ALL {
        assert!(seen.keys().any(|&(seen, _)| seen == state as u8), "no run reached {state:?}");
    }
}

#[test]
fn runs_in_slices_with_entered_inputs_equal_whole_runs() {
    for seed in seeds().take(200) {
        let mut setup = common::setup(seed);
        let random = &mut Random(seed ^ 0x55);
        let until = Instant(MAX_CYCLES / 2);
        let mut whole = StandAlone::new(&setup.clone().check().unwrap());
        let mut whole_trace = Vec::<Record>::new();
        whole.run(until, &mut whole_trace);
        // The same inputs, entered before their cycles, in a run of slices.
        let mut inputs: Vec<(usize, _)> = Vec::new();
        for (index, controller) in setup.controllers.iter_mut().enumerate() {
            inputs.extend(std::mem::take(&mut controller.inputs).into_iter().map(|input| (index, input)));
        }
        inputs.sort_by_key(|(_, input)| input.cycle);
        let (mut sliced, mut trace) = (StandAlone::new(&setup.check().unwrap()), Vec::<Record>::new());
        let mut inputs = inputs.into_iter().peekable();
        while sliced.now() < until {
            let slice = Instant((sliced.now().0 + 1 + random.below(300)).min(until.0));
            while let Some((index, input)) = inputs.next_if(|(_, input)| input.cycle < slice) {
                sliced.enter(input.cycle, index, input.change).unwrap();
                assert!(sliced.enter(input.cycle, index, input.change).is_err(), "twice");
            }
            if random.one_in(3) {
                let max = slice.0.saturating_sub(sliced.now().0);
                sliced.advance(Cycles(random.below(50).min(max)));
                while sliced.now() < slice {
                    sliced.clock(&mut trace);
                }
            } else {
                sliced.run(slice, &mut trace);
            }
        }
        assert_eq!(whole_trace, trace, "seed {seed}: trace");
        compare(seed, &whole, &sliced);
        let late = sliced.enter(Instant(until.0 - 1), 0, Change::Level(Signal::Start, true));
        assert!(late.is_err(), "that cycle has been run");
    }
}
