//! Compressed tables beside those that Klipper's way of compression would make (DESIGN B8): its window, its widths, and one
//! entry after another, each as long as there is one, and of those the one that ends last.
//!
//! The way is written here from its description alone: a step comes up to 25 us early, though not by more than half the interval
//! before it, and never late; an entry is interval (32 bits), count (16) and add (16, signed) in whole cycles. Its own
//! program examines only some of the adds; its known counts are listed.

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

/// Entries of the greedy way.
fn greedy(steps: &[ScheduledStep]) -> u64 {
    let cycle = |index: usize| steps[index].cycle as i64;
    let (mut entries, mut start, mut last) = (0, 0, 0);
    while start < steps.len() {
        let way = steps[start].right;
        // Each add that is left with its least and greatest interval, of entries of `count` steps.
        let mut left: Vec<(i64, i64, i64)> = vec![];
        let (mut count, mut end) = (0_i64, (0, i64::MIN));
        for index in (start..steps.len()).take(65_535).take_while(|index| steps[*index].right == way) {
            let before = if index == start { last } else { cycle(index - 1) };
            let early = (EARLY as i64).min((cycle(index) - before) / 2);
            let (low, high) = (cycle(index) - early - last, cycle(index) - last);
            count += 1;
            let bend = count * (count - 1) / 2;
            if count == 1 {
                left.push((0, low, high));
            } else {
                if let [(_, first, most)] = left[..]
                    && count == 2
                {
                    let adds = (low - 2 * most).max(-32_768)..=(high - 2 * first).min(32_767);
                    left = adds.map(|add| (add, first, most)).collect();
                }
                for (add, least, most) in &mut left {
                    *least = (*least).max(-(bend * *add - low).div_euclid(count));
                    *most = (*most).min((high - bend * *add).div_euclid(count));
                }
                left.retain(|(add, least, most)| least <= most && least + (count - 1) * add > 0);
            }
            let ends = left.iter().map(|(add, _, most)| count * most + bend * add).max();
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
    plan_axis(&axis, "x").expect("it can be planned").due_steps(CLOCK_HZ).collect()
}

fn trapezoid(steps: f64) -> Move {
    Move::Trapezoid(Trapezoid {
        distance: Distance::Steps(steps),
        start_speed: Speed::StepsPerSecond(250.0),
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

/// Entries of steps: ours in its window, ours in one of the same width around the due time, and those of the greedy way.
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
fn no_move_takes_more_entries_than_klippers_way() {
    let jerk = JerkLimited { distance: Distance::Steps(3200.0), ..JerkLimited::default() };
    let segments = SineSegments { amplitude: Distance::Steps(1000.0), periods: 2, ..SineSegments::default() };
    // Steps, move, counts, and what Klipper's program makes of it.
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
        let most = klippers.unwrap_or(greedy).min(greedy);
        assert!(early <= most && both <= most, "{given:?}: {found:?}");
    }
}

/// 312 turns: the list is cut into sections, each cut of which may cost an entry.
#[test]
#[ignore = "it takes half a minute"]
fn two_million_steps_take_no_more_either() {
    let steps = due(sine(156));
    assert_eq!(steps.len(), 1_996_800);
    let made = compressed(steps.iter().copied(), KLIPPERS, EntryFormat::TICKS, PULSE);
    let made = made.expect("there is time for each pulse");
    assert_eq!((steps_of(&made.list.segments), made.surplus), (18_097, Some(15)));
    assert_eq!(greedy(&steps), 19_968);
}
