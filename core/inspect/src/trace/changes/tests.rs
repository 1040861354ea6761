//! Every result compared with that of a plain loop over all records, or all cycles.

use super::*;
use proptest::{collection::vec, prelude::*};
use stepscope_peripheral::{signal::Levels, units::Instant};

/// A few signals over a trace of up to some thousand records, in intervals in which only some of them change.
fn traces() -> impl Strategy<Value = Vec<Record>> {
    let interval = (1_u64..=9, 0_u64..16, 1_usize..600, any::<u64>());
    (0_u64..16, vec(interval, 0..8)).prop_map(|(reset, intervals)| {
        let mut trace = Vec::from([record(0, reset)]);
        for (pause, mask, count, seed) in intervals {
            let mut seed = seed | 1;
            for _ in 0..count {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let last = trace[trace.len() - 1];
                let cycle = last.cycle.0 + 1 + (seed >> 40) % pause;
                trace.push(record(cycle, last.levels.0 ^ (seed >> 33) & mask));
            }
        }
        trace
    })
}

fn record(cycle: u64, levels: u64) -> Record {
    Record { cycle: Instant(cycle), levels: Levels(levels) }
}

/// The pyramid as it grows in slices.
fn changes(trace: &[Record], slice: usize) -> Changes {
    let mut changes = Changes::default();
    for end in (0..trace.len()).step_by(slice).chain([trace.len()]) {
        changes.extend(&trace[..end]);
    }
    changes
}

/// Columns from all records one by one.
fn columns(trace: &[Record], start: u64, end: u64, count: usize) -> Columns {
    let span = u128::from(end.saturating_sub(start).max(1));
    let bound = |i: usize| start.saturating_add((span * i as u128 / count.max(1) as u128) as u64);
    let mut result = Columns { high: vec![0; count], low: vec![0; count], last: vec![0; count] };
    let mut next = trace.partition_point(|r| r.cycle.0 <= start);
    let mut levels = next.checked_sub(1).and_then(|i| trace.get(i)).map_or(0, |r| r.levels.0);
    for i in 0..count {
        let (first, after) = (bound(i), bound(i + 1).max(bound(i).saturating_add(1)));
        // Columns narrower than a cycle share it.
        let (mut high, mut low) = (levels, !levels);
        while let Some(record) = trace.get(next).filter(|r| r.cycle.0 < after) {
            if record.cycle.0 == first && high == levels && low == !levels {
                (high, low) = (0, 0);
            }
            levels = record.levels.0;
            high |= levels;
            low |= !levels;
            next += 1;
        }
        result.high[i] = high;
        result.low[i] = low;
        result.last[i] = levels;
    }
    result
}

proptest! {
    #[test]
    fn columns_equal_those_of_a_loop_over_all_records(
        trace in traces(), slice in 1_usize..3000, window in (0_u64..9000, 1_u64..9000),
        count in 1_usize..90, margin in 0_usize..40,
    ) {
        let changes = changes(&trace, slice);
        let (start, end) = (window.0, window.0 + window.1);
        let found = changes.columns(&trace, start, end, count, margin);
        let expected = columns(&trace, start, end, count);
        let middle = margin..margin + count;
        prop_assert_eq!(&found.high[middle.clone()], &expected.high[..]);
        prop_assert_eq!(&found.low[middle.clone()], &expected.low[..]);
        prop_assert_eq!(&found.last[middle], &expected.last[..]);
        // A margin column equals the only column of a view of the same cycles.
        for i in (0..margin).chain(margin + count..count + 2 * margin) {
            let bound = |i: usize| i128::from(start) + (i128::from(window.1) * (i as i128 - margin as i128)).div_euclid(count as i128);
            let (first, after) = (bound(i), bound(i + 1).max(bound(i) + 1));
            let one = if after <= 0 { Columns { high: Vec::from([0]), low: Vec::from([0]), last: Vec::from([0]) } }
                else { columns(&trace, first.max(0) as u64, after as u64, 1) };
            prop_assert_eq!((found.high[i], found.low[i], found.last[i]), (one.high[0], one.low[0], one.last[0]), "column {}", i);
        }
    }

    #[test]
    fn edges_equal_those_of_a_loop_over_all_records(trace in traces(), bit in 0_u8..5, at in 0_u64..12_000, slice in 1_usize..3000) {
        let changes = changes(&trace, slice);
        let mask = 1 << bit;
        for edge in [Edge::Any, Edge::Rise, Edge::Fall] {
            let is_edge = |&index: &usize| {
                let (before, now) = (trace[index - 1].levels.has(mask), trace[index].levels.has(mask));
                before != now && match edge { Edge::Any => true, Edge::Rise => now, Edge::Fall => before }
            };
            let next = (1..trace.len()).filter(is_edge).find(|&index| trace[index].cycle.0 > at);
            let previous = (1..trace.len()).rev().filter(is_edge).find(|&index| trace[index].cycle.0 < at);
            prop_assert_eq!(changes.next_edge(&trace, bit, at, edge), next);
            prop_assert_eq!(changes.previous_edge(&trace, bit, at, edge), previous);
        }
    }
}

#[test]
fn an_empty_trace_has_no_edges_and_low_columns() {
    let changes = changes(&[], 1);
    assert_eq!(changes.next_edge(&[], 0, 0, Edge::Any), None);
    assert_eq!(changes.previous_edge(&[], 0, 9, Edge::Any), None);
    assert_eq!(changes.columns(&[], 0, 8, 4, 0), columns(&[], 0, 8, 4));
}

#[test]
fn the_pyramid_is_small_compared_with_the_trace() {
    let trace: Vec<Record> = (0..1 << 17).map(|cycle| record(cycle, cycle & 1)).collect();
    let bytes = changes(&trace, 4096).bytes();
    assert!(bytes < trace.len() * 6 / 10, "{bytes} bytes for {} records", trace.len());
}

#[test]
fn the_first_rise_of_a_run_is_found() {
    use crate::trace::changes::{Changes, Edge};
    use crate::trace::stored_run::StoredRun;
    use stepscope_peripheral::trace::steps;
    use stepscope_sim::Experiment;

    let experiment = Experiment::from_json("{}").expect("the default motion");
    let mut recording = StoredRun::default();
    experiment.run(&mut recording);
    let mut changes = Changes::default();
    changes.extend(&recording.trace);
    let found = changes.next_edge(&recording.trace, 0, 0, Edge::Rise).expect("it steps");
    assert_eq!(recording.trace[found].cycle.0, steps(&recording.trace, 0)[0].cycle);
}

#[test]
fn the_columns_of_every_record_equal_those_of_every_cycle() {
    let trace: Vec<Record> =
        [(0, 0b10), (3, 0b11), (4, 0b01), (10, 0b00), (11, 0b01), (12, 0b11), (40, 0b10)]
            .map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) })
            .to_vec();
    let at = |cycle: u64| trace.iter().rev().find(|r| r.cycle.0 <= cycle).map_or(0, |r| r.levels.0);
    for (start, end) in [(0, 50), (1, 12), (3, 7), (9, 13), (0, 3), (38, 100), (10, 11)] {
        for count in 1..=60 {
            let found = columns(&trace, start, end, count);
            for i in 0..count {
                let bound = |i: usize| start + (end - start) * i as u64 / count as u64;
                let (first, after) = (bound(i), bound(i + 1).max(bound(i) + 1));
                let expected = (first..after).fold((0, 0), |(h, l), c| (h | at(c), l | !at(c)));
                assert_eq!((found.high[i], found.low[i]), expected, "{start}..{end} {i}/{count}");
                assert_eq!(found.last[i], at(after - 1));
            }
        }
    }
}

#[test]
fn columns_show_a_short_pulse() {
    // STEP0 is high in cycles 5 to 7; two columns of ten cycles each.
    let trace = [(0, 0), (5, 1), (8, 0)].map(|(cycle, levels)| record(cycle, levels));
    let columns = changes(&trace, 1).columns(&trace, 0, 20, 2, 0);
    assert_eq!((columns.high[0] & 1, columns.low[0] & 1), (1, 1)); // both within the first
    assert_eq!((columns.high[1] & 1, columns.last[1] & 1), (0, 0));
}
