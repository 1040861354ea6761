//! Compares compressed tables with Klipper's step compression (DESIGN B8), which appends one longest entry after another, and
//! of equally long ones the one that ends last.
//!
//! It is implemented here from its description: a step is up to 25 us early, but not by more than half the interval before it,
//! and never late; an entry has interval (32 bits), count (16) and add (16, signed) in whole cycles. Klipper's program tries
//! only some of the adds; its known counts are listed.

use std::num::NonZeroU32;
use stepscope_motion::{
    ScheduledStep,
    mechanics::{Acceleration, Distance, Speed},
    moves::{Axis, JerkLimited, Move, Sine, SineSegments, Trapezoid},
    plan_axis,
    step_tables::{EntryFormat, Side, Tolerance, compressed},
};
use stepscope_peripheral::{
    segment::{PulseTimes, Segment},
    units::Cycles,
};

const CLOCK_HZ: u32 = 16_000_000;
/// 25 us.
const EARLY: u64 = 400;
const KLIPPERS: Tolerance =
    Tolerance { cycles: Cycles(EARLY), interval_part: NonZeroU32::new(2), side: Side::Early };
const PULSE: PulseTimes = PulseTimes { width: Cycles(16), setup: Cycles(0), hold: Cycles(0) };

/// Number of entries of greedy compression.
fn greedy(steps: &[ScheduledStep]) -> u64 {
    let cycle = |index: usize| steps[index].cycle as i64;
    let (mut entries, mut start, mut last) = (0, 0, 0);
    while start < steps.len() {
        let right = steps[start].right;
        // Possible adds of entries of `count` steps, each with its minimum and maximum interval.
        let mut candidates: Vec<(i64, i64, i64)> = vec![];
        let (mut count, mut end) = (0_i64, (0, i64::MIN));
        for index in (start..steps.len()).take(65_535).take_while(|index| steps[*index].right == right) {
            let before = if index == start { last } else { cycle(index - 1) };
            let early = (EARLY as i64).min((cycle(index) - before) / 2);
            let (low, high) = (cycle(index) - early - last, cycle(index) - last);
            count += 1;
            let bend = count * (count - 1) / 2;
            if count == 1 {
                candidates.push((0, low, high));
            } else {
                if let [(_, min, max)] = candidates[..]
                    && count == 2
                {
                    let adds = (low - 2 * max).max(-32_768)..=(high - 2 * min).min(32_767);
                    candidates = adds.map(|add| (add, min, max)).collect();
                }
                for (add, min, max) in &mut candidates {
                    *min = (*min).max(-(bend * *add - low).div_euclid(count));
                    *max = (*max).min((high - bend * *add).div_euclid(count));
                }
                candidates.retain(|(add, min, max)| min <= max && min + (count - 1) * add > 0);
            }
            let ends = candidates.iter().map(|(add, _, max)| count * max + bend * add).max();
            let Some(latest) = ends else { break };
            end = (count as usize, latest);
        }
        entries += 1;
        start += end.0;
        last += end.1;
    }
    entries
}

fn due(given: Move) -> Vec<ScheduledStep> {
    let axis = Axis { moves: vec![given], ..Axis::default() };
    plan_axis(&axis, "x").expect("a valid axis").due_steps(CLOCK_HZ).collect()
}

fn trapezoid(steps: f64) -> Move {
    Move::Trapezoid(Trapezoid {
        distance: Distance::Steps(steps),
        start_speed: Some(Speed::StepsPerSecond(250.0)),
        max_speed: Speed::StepsPerSecond(20_000.0),
        max_acceleration: Acceleration::StepsPerSecond2(9000.0),
        ..Trapezoid::default()
    })
}

fn sine(periods: u32) -> Move {
    Move::Sine(Sine { amplitude: Distance::Steps(3200.0), periods, ..Sine::default() })
}

fn steps_of(segments: &[Segment]) -> u64 {
    segments.iter().filter(|segment| matches!(segment, Segment::Steps { .. })).count() as u64
}

/// Numbers of entries: our compression in Klipper's window, in a window of the same width around the due time, and greedy
/// compression.
fn counts(given: Move) -> [u64; 3] {
    let steps = due(given);
    let ours = |tolerance| {
        let made = compressed(steps.iter().copied(), tolerance, EntryFormat::TICKS, PULSE);
        let made = made.expect("there is time for each pulse");
        assert_eq!((made.error.steps, made.surplus), (steps.len() as u64, Some(0)));
        steps_of(&made.list.segments)
    };
    [ours(KLIPPERS), ours(Tolerance::of(Cycles(EARLY / 2))), greedy(&steps)]
}

#[test]
fn no_move_needs_more_entries_than_with_klipper() {
    let jerk = JerkLimited { distance: Distance::Steps(3200.0), ..JerkLimited::default() };
    let segments = SineSegments { amplitude: Distance::Steps(1000.0), periods: 2, ..SineSegments::default() };
    // Steps, move, counts, and the count of Klipper's program.
    let rows = [
        (3200, Move::default(), [48, 48, 52], Some(52)),
        (2000, trapezoid(2000.0), [40, 40, 45], None),
        (100_000, trapezoid(100_000.0), [229, 229, 244], None),
        (8000, Move::SineSegments(segments), [61, 61, 65], Some(61)),
        (3200, Move::JerkLimited(jerk), [34, 34, 36], Some(36)),
        (25_600, sine(2), [231, 199, 256], None),
    ];
    for (steps, given, expected, klippers) in rows {
        assert_eq!(due(given.clone()).len(), steps);
        let found = counts(given.clone());
        assert_eq!(found, expected, "{given:?}");
        let [early, both, greedy] = found;
        let max = klippers.unwrap_or(greedy).min(greedy);
        assert!(early <= max && both <= max, "{given:?}: {found:?}");
    }
}

/// 312 changes of direction: the list is cut into sections, and each cut may cost an entry.
#[test]
#[ignore = "it takes half a minute"]
fn two_million_steps_need_no_more_entries_either() {
    let steps = due(sine(156));
    assert_eq!(steps.len(), 1_996_800);
    let made = compressed(steps.iter().copied(), KLIPPERS, EntryFormat::TICKS, PULSE);
    let made = made.expect("there is time for each pulse");
    assert_eq!((steps_of(&made.list.segments), made.surplus), (18_097, Some(15)));
    assert_eq!(greedy(&steps), 19_968);
}
