//! An exact table has the fewest entries (DESIGN B8): with integer intervals as few as an exhaustive search finds, with
//! fractional ones no more.

use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use std::num::NonZeroU32;
use stepscope_motion::{
    ScheduledStep,
    step_tables::{EntryFormat, Form, Tolerance, stored_steps},
};
use stepscope_peripheral::{segment::PulseTimes, units::Cycles};

const PULSE: PulseTimes = PulseTimes { width: Cycles(3), setup: Cycles(1), hold: Cycles(0) };

/// Whether these steps fit in one entry after a step at cycle `before`.
fn is_entry(before: u64, steps: &[ScheduledStep]) -> bool {
    let cycles: Vec<i64> = std::iter::once(before)
        .chain(steps.iter().map(|step| step.cycle))
        .map(|cycle| cycle as i64)
        .collect();
    let intervals: Vec<i64> = cycles.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let adds: Vec<i64> = intervals.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.iter().all(|step| step.right == steps[0].right) && adds.iter().all(|add| *add == adds[0])
}

/// The fewest entries, by exhaustive search.
fn fewest(steps: &[ScheduledStep]) -> usize {
    let mut min_entries = vec![0];
    for end in 1..=steps.len() {
        let of = |start: usize| {
            let before = if start == 0 { 0 } else { steps[start - 1].cycle };
            is_entry(before, &steps[start..end]).then(|| min_entries[start] + 1)
        };
        let found = (0..end).filter_map(of).min().expect("a single step is an entry");
        min_entries.push(found);
    }
    min_entries[steps.len()]
}

#[test]
fn an_exact_table_has_the_fewest_entries() {
    let mut noise = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut smaller = 0;
    for round in 0..3000 {
        let below = |noise: &mut Xoshiro256PlusPlus, end: u64| noise.next_u64() % end;
        let count = 1 + below(&mut noise, 24);
        let (mut cycle, mut interval, mut right) = (0, 40, true);
        let steps: Vec<ScheduledStep> = (0..count)
            .map(|_| {
                // Few different intervals and adds, so that there are many possible entries.
                interval = (interval + below(&mut noise, 3)).saturating_sub(1).max(8);
                right ^= below(&mut noise, 12) == 0;
                cycle += interval;
                ScheduledStep { cycle, right }
            })
            .collect();
        let entries = |form, format| {
            let table = stored_steps(&steps, form, format, PULSE).expect("there is time for each pulse");
            assert_eq!((table.error.max_cycles, table.error.steps), (0, count), "{round}");
            table.entries.len()
        };
        // A change of direction is an additional entry. The initial direction is left.
        let directions = std::iter::once(false).chain(steps.iter().map(|step| step.right));
        let changes = directions.zip(&steps).filter(|(before, step)| step.right != *before).count();
        let min = fewest(&steps) + changes;
        let none = Tolerance { interval_part: NonZeroU32::new(2), ..Tolerance::of(Cycles(0)) };
        assert_eq!(entries(Form::Exact, EntryFormat::TICKS), min, "{round}: {steps:?}");
        assert_eq!(entries(Form::Compressed(none), EntryFormat::TICKS), min, "{round}: {steps:?}");
        let with_fractions = entries(Form::Exact, EntryFormat::Q16);
        assert!(with_fractions <= min, "{round}: {with_fractions} {min} {steps:?}");
        smaller += usize::from(with_fractions < min);
    }
    assert!(smaller > 300, "{smaller}");
}
