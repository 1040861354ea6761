//! A8: steps and DIR changes of segments, and refused lists. W = 2, D = H = 1: an interval has at least 4
//! cycles.

use super::*;
use crate::oracle::segments::{Refused, Rule, Segment, run_segments};
use Segment::Dwell;

const ONE: u64 = 1 << 16;

fn right(steps: u32, interval: u64, add: i64) -> Segment {
    Segment::Steps { steps, interval, add, dir: true }
}

fn left(steps: u32, interval: u64, add: i64) -> Segment {
    Segment::Steps { steps, interval, add, dir: false }
}

/// A list, and its changes of DIR.
type DirRow<'a> = (&'a [Segment], &'a [(u64, bool)]);

/// A list with its start, and the segment and the rule of its refusal.
type JudgedRow = (u64, Vec<Segment>, Option<(Option<usize>, Rule)>);

fn run_one(config: &Config, start: u64, list: &[Segment], cycles: u64) -> Run {
    run_segments(config, &[(start, list.to_vec())], cycles).expect("a list that is taken")
}

#[test]
fn each_step_follows_the_last_after_its_interval() {
    let (half, quarter) = (ONE / 2, ONE / 4);
    let rows: &[(u64, &[Segment], &[u64])] = &[
        (10, &[left(3, 10 * ONE, 0)], &[20, 30, 40]),
        (1, &[left(1, 4 * ONE, 0)], &[5]),
        // 11.25 21.5 31.75 42 52.25.
        (1, &[left(5, 10 * ONE + quarter, 0)], &[11, 21, 31, 42, 52]),
        // "then interval += add": 10, 9, 8 and 10, 12, 14.
        (1, &[left(3, 10 * ONE, -(ONE as i64))], &[11, 20, 28]),
        (1, &[left(3, 10 * ONE, 2 * ONE as i64)], &[11, 23, 37]),
        // 5, 5.5, 6: 6, 11.5, 17.5.
        (1, &[left(3, 5 * ONE, half as i64)], &[6, 11, 17]),
        // `next` keeps its fraction from segment to segment: 11.5, 22, 32.5, and over a dwell of 0.5.
        (1, &[left(1, 10 * ONE + half, 0), left(2, 10 * ONE + half, 0)], &[11, 22, 32]),
        (1, &[left(1, 10 * ONE + half, 0), Dwell(half), left(1, 10 * ONE, 0)], &[11, 22]),
        // A dwell at the start, in the middle, of 0, at the end, and alone.
        (1, &[Dwell(7 * ONE), left(1, 10 * ONE, 0)], &[18]),
        (1, &[left(1, 10 * ONE, 0), Dwell(0), left(1, 10 * ONE, 0), Dwell(ONE)], &[11, 21]),
        (1, &[Dwell(0)], &[]),
        (1, &[], &[]),
        // A queue of timer reloads, one per step.
        (1, &[left(1, 9 * ONE, 0), left(1, 8 * ONE, 0), left(1, 7 * ONE, 0)], &[10, 18, 25]),
    ];
    for (start, list, expected) in rows {
        let run = run_one(&base(), *start, list, 1_000);
        assert_eq!(steps(&run, 0), *expected, "{list:?}");
        let falls: Vec<u64> =
            edges(&run, 0).into_iter().filter(|(_, level)| !level).map(|(cycle, _)| cycle).collect();
        assert_eq!(falls, expected.iter().map(|rise| rise + 2).collect::<Vec<_>>(), "{list:?}");
        assert_eq!(run.positions[0], -(expected.len() as i32));
    }
}

#[test]
fn dir_changes_with_its_segment_after_the_hold_time() {
    let ten = 10 * ONE;
    let rows: &[DirRow] = &[
        // "0 at the start"; "before the first pulse at next >> 16".
        (&[left(1, ten, 0)], &[]),
        (&[right(1, ten, 0)], &[(1, true)]),
        (&[Dwell(5 * ONE + ONE / 2), right(1, ten, 0)], &[(6, true)]),
        // Rise 11, fall 13, H = 1: 14. A dwell of up to 3 cycles changes nothing.
        (&[left(1, ten, 0), right(1, ten, 0)], &[(14, true)]),
        (&[left(1, ten, 0), Dwell(3 * ONE), right(1, ten, 0)], &[(14, true)]),
        (&[left(1, ten, 0), Dwell(4 * ONE - 1), right(1, ten, 0)], &[(14, true)]),
        (&[left(1, ten, 0), Dwell(4 * ONE), right(1, ten, 0)], &[(15, true)]),
        (&[left(1, ten, 0), Dwell(100 * ONE), Dwell(ONE), right(1, ten, 0)], &[(112, true)]),
        // An equal DIR does not change, and a dwell has no direction.
        (&[right(1, ten, 0), Dwell(ten), right(1, ten, 0)], &[(1, true)]),
        (&[right(1, ten, 0), left(1, ten, 0), right(1, ten, 0)], &[(1, true), (14, false), (24, true)]),
        // The minimum interval leaves D = 1 cycle: rise 5, 9.
        (&[right(1, 4 * ONE, 0), left(1, 4 * ONE, 0)], &[(1, true), (8, false)]),
    ];
    for (list, expected) in rows {
        assert_eq!(edges(&run_one(&base(), 1, list, 1_000), bits::DIR), *expected, "{list:?}");
    }
    let run = run_one(&base(), 1, &[right(3, ten, 0), left(1, ten, 0)], 1_000);
    assert_eq!(run.positions[0], 2);
    // H = 0 and D = 0: DIR changes with the fall.
    let bare = Config { dir_setup: 0, dir_hold: 0, ..base() };
    let run = run_one(&bare, 1, &[right(1, 3 * ONE, 0), left(1, 3 * ONE, 0)], 1_000);
    assert_eq!((edges(&run, bits::DIR), steps(&run, 0)), (vec![(1, true), (6, false)], vec![4, 7]));
}

#[test]
fn every_channel_has_its_own_list_and_the_line_is_idle() {
    let config = Config { channels: 3, ..base() };
    let lists = [(1, vec![right(2, 10 * ONE, 0)]), (5, vec![left(1, 20 * ONE, 0)])];
    let run = run_segments(&config, &lists, 100).expect("both are taken");
    assert_eq!([0, 1, 2].map(|channel| steps(&run, channel)), [vec![11, 21], vec![25], vec![]]);
    assert_eq!(run.positions[..4], [2, -1, 0, 0]);
    assert!(run.trace.iter().all(|(_, levels)| levels >> 32 == 0b0111));
    assert_eq!(run.trace[..2], [(0, 0b0111 << 32), (1, 0b0111 << 32 | 1 << 16)]);
}

#[test]
fn a_run_that_ends_early_counts_the_risen_pulses() {
    for (cycles, position, trace) in [(0, 0, 0), (11, 0, 2), (12, 1, 3), (21, 1, 4), (22, 2, 5)] {
        let run = run_one(&base(), 1, &[right(2, 10 * ONE, 0)], cycles);
        assert_eq!((run.positions[0], run.trace.len()), (position, trace), "{cycles} cycles");
    }
}

#[test]
fn a_refused_list_names_the_first_invalid_segment() {
    use Rule::{IntervalLeavesU64, NextLeavesU64, NoSteps, ShortInterval, StartBeforeCycle1};
    let max = u64::MAX;
    let ten = 10 * ONE;
    let good = || left(2, ten, 0);
    let rows: Vec<JudgedRow> = vec![
        (0, vec![good()], Some((None, StartBeforeCycle1))),
        (1, vec![good(), left(0, ten, 0)], Some((Some(1), NoSteps))),
        (1, vec![left(0, 0, 0)], Some((Some(0), NoSteps))),
        // "under (W + max(H + D, 1)) << 16".
        (1, vec![left(1, 4 * ONE, 0)], None),
        (1, vec![Dwell(0), left(1, 4 * ONE - 1, 0)], Some((Some(1), ShortInterval))),
        (1, vec![left(1, 0, 0)], Some((Some(0), ShortInterval))),
        // "that a step uses": the second uses one less, a third would use two less.
        (1, vec![left(2, 4 * ONE + 1, -1)], None),
        (1, vec![left(3, 4 * ONE + 1, -1)], Some((Some(0), ShortInterval))),
        (1, vec![left(1, 4 * ONE, i64::MIN)], None),
        (1, vec![left(2, 4 * ONE, i64::MIN)], Some((Some(0), IntervalLeavesU64))),
        // The second interval is 2^63 - 1 longer, and a third would exceed u64.
        (1, vec![left(2, 4 * ONE, i64::MAX)], None),
        (1, vec![left(3, 4 * ONE, i64::MAX)], Some((Some(0), IntervalLeavesU64))),
        (1, vec![left(3, 1 << 62, 0)], None),
        (1, vec![left(4, 1 << 62, 0)], Some((Some(0), NextLeavesU64))),
        // `next` starts at 1 << 16 and may reach u64::MAX.
        (1, vec![left(1, max - ONE, 0)], None),
        (1, vec![left(1, max - ONE + 1, 0)], Some((Some(0), NextLeavesU64))),
        (1, vec![Dwell(max - ONE), Dwell(0)], None),
        (1, vec![Dwell(max - ONE), Dwell(1)], Some((Some(1), NextLeavesU64))),
        (1, vec![Dwell(max - ONE), good()], Some((Some(1), NextLeavesU64))),
        ((1 << 48) - 1, vec![Dwell(ONE - 1)], None),
        ((1 << 48) - 1, vec![Dwell(ONE)], Some((Some(0), NextLeavesU64))),
        (1 << 48, vec![], Some((None, NextLeavesU64))),
        (max, vec![good()], Some((None, NextLeavesU64))),
    ];
    for (start, list, expected) in rows {
        let refused = run_segments(&base(), &[(start, list.clone())], 100).err();
        let expected = expected.map(|(segment, rule)| Refused { channel: 0, segment, rule });
        assert_eq!(refused, expected, "{start} {list:?}");
    }
    // max(H + D, 1) where both are 0.
    let bare = Config { dir_setup: 0, dir_hold: 0, ..base() };
    assert!(run_segments(&bare, &[(1, vec![left(1, 3 * ONE, 0)])], 100).is_ok());
    assert!(run_segments(&bare, &[(1, vec![left(1, 3 * ONE - 1, 0)])], 100).is_err());
    // The channel is reported.
    let lists = [(1, vec![good()]), (1, vec![good(), left(0, ten, 0)])];
    let refused = run_segments(&Config { channels: 2, ..base() }, &lists, 100).err();
    assert_eq!(refused, Some(Refused { channel: 1, segment: Some(1), rule: NoSteps }));
}
