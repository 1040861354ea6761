//! A compressed table has the fewest entries that its format allows (DESIGN B8): as few as an exhaustive search finds.

use proptest::prelude::*;
use std::{collections::BTreeSet, num::NonZeroU32};
use stepscope_motion::{
    ScheduledStep,
    step_tables::{EntryFormat, Side, Tolerance, compressed, compressed_quickly},
};
use stepscope_peripheral::{
    segment::{PulseTimes, Segment},
    units::Cycles,
};

const PULSE: PulseTimes = PulseTimes { width: Cycles(1), setup: Cycles(0), hold: Cycles(0) };
/// Narrow numbers, so that each limit matters.
const NARROW: EntryFormat = EntryFormat::new("narrow", 0, [8, 8, 8]).expect("valid widths");
const HALVES: EntryFormat = EntryFormat::new("halves", 1, [8, 8, 8]).expect("valid widths");

/// The window of each step in units, and its direction.
fn windows(steps: &[ScheduledStep], tolerance: Tolerance, format: EntryFormat) -> Vec<(i64, i64, bool)> {
    let cycle = |index: usize| steps[index].cycle as i64;
    (0..steps.len())
        .map(|index| {
            let before = if index == 0 { cycle(0) } else { cycle(index) - cycle(index - 1) };
            let after = if index + 1 < steps.len() { cycle(index + 1) - cycle(index) } else { i64::MAX };
            let early = tolerance.side == Side::Early;
            let shorter = if early { before } else { before.min(after) };
            let part = tolerance.interval_part.map_or(i64::MAX, |part| shorter / i64::from(part.get()));
            let off = part.min(tolerance.cycles.0 as i64);
            let unit = 1 << format.fraction_bits();
            let low = (cycle(index) - off).max(0) * unit;
            let high = (cycle(index) + if early { 0 } else { off }) * unit + unit - 1;
            (low, high, steps[index].right)
        })
        .collect()
}

/// The fewest entries with steps: tries every interval and add from every time that a step can have.
fn fewest(windows: &[(i64, i64, bool)], format: EntryFormat) -> u64 {
    let (min, max) = (2 << format.fraction_bits(), format.max_interval() as i64);
    let mut reached: Vec<BTreeSet<i64>> = vec![BTreeSet::new(); windows.len() + 1];
    reached[0].insert(0);
    for entries in 0.. {
        if !reached[windows.len()].is_empty() {
            return entries;
        }
        for (step, times) in reached.clone().iter().enumerate() {
            let Some(&(low, high, direction)) = windows.get(step) else { continue };
            for &from in times {
                // Intervals to the first window, and adds to the second.
                for interval in min.max(low - from)..=max.min(high - from) {
                    let adds = windows.get(step + 1).map_or(0..=0, |&(low, high, _)| {
                        (low - from - 2 * interval).max(format.min_add())
                            ..=(high - from - 2 * interval).min(format.max_add())
                    });
                    // Without a second window the entry has one step.
                    for add in adds.chain([0]) {
                        let (mut time, mut next) = (from, interval);
                        for (n, &(low, high, right)) in (step + 1..).zip(&windows[step..]) {
                            time += next;
                            let passes = (min..=max).contains(&next) && (low..=high).contains(&time);
                            if !passes || right != direction {
                                break;
                            }
                            reached[n].insert(time);
                            next += add;
                        }
                    }
                }
            }
        }
    }
    unreachable!("each step can be an entry")
}

fn tolerance() -> impl Strategy<Value = Tolerance> {
    let side = prop_oneof![Just(Side::Both), Just(Side::Early)];
    let cycles = prop_oneof![30 => 0..4_u64, 5 => 4..12_u64, 1 => 30..45_u64];
    (cycles, prop::option::of(1..5_u32), side).prop_map(|(cycles, part, side)| Tolerance {
        cycles: Cycles(cycles),
        interval_part: part.and_then(NonZeroU32::new),
        side,
    })
}

/// Steps with small changes of intervals, and sometimes large ones.
fn steps() -> impl Strategy<Value = Vec<ScheduledStep>> {
    let gap = prop_oneof![12 => -2..3_i64, 1 => -20..21_i64];
    (2..40_i64, prop::collection::vec((gap, prop::bool::weighted(0.05)), 1..13)).prop_map(
        |(first, changes)| {
            let (mut interval, mut cycle, mut right) = (first, 0, true);
            changes
                .into_iter()
                .map(|(change, reverses)| {
                    interval = (interval + change).clamp(2, 110);
                    cycle += interval as u64;
                    right ^= reverses;
                    ScheduledStep { cycle, right }
                })
                .collect()
        },
    )
}

fn entries_of_steps(segments: &[Segment]) -> u64 {
    segments.iter().filter(|segment| matches!(segment, Segment::Steps { .. })).count() as u64
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_compressed_table_has_the_fewest_entries(
        steps in steps(), tolerance in tolerance(),
        format in prop::sample::select(vec![EntryFormat::TICKS, NARROW, HALVES]),
    ) {
        let made = compressed(steps.iter().copied(), tolerance, format, PULSE).expect("there is time for each pulse");
        prop_assert_eq!(made.error.steps, steps.len() as u64);
        let found = entries_of_steps(&made.list.segments);
        let min = fewest(&windows(&steps, tolerance, format), format);
        let surplus = made.surplus.expect("the windows are narrow");
        prop_assert!(found >= min && found <= min + surplus, "{} {} {}", found, min, surplus);
        prop_assert!(surplus == 0 || format != EntryFormat::TICKS);
        let quick = compressed_quickly(steps.iter().copied(), tolerance, format, PULSE);
        let quick = quick.expect("there is time for each pulse");
        prop_assert!(found <= entries_of_steps(&quick.list.segments) + surplus);
    }
}

#[test]
fn a_list_with_too_much_work_is_compressed_quickly() {
    // Wide windows and a reversal after every third step: many short entries, each with thousands of start times.
    let steps: Vec<ScheduledStep> = (0..30_000_u64)
        .map(|index| ScheduledStep { cycle: 1000 + 300 * index, right: index / 3 % 2 == 0 })
        .collect();
    let tolerance = Tolerance { cycles: Cycles(1600), interval_part: NonZeroU32::new(1), side: Side::Both };
    let found = compressed(steps.iter().copied(), tolerance, EntryFormat::TICKS, PULSE).expect("it fits");
    let quick =
        compressed_quickly(steps.iter().copied(), tolerance, EntryFormat::TICKS, PULSE).expect("it fits");
    assert!(found.surplus.is_none_or(|surplus| surplus > 0), "{:?}", found.surplus);
    assert!(found.list.segments.len() <= quick.list.segments.len());
}
