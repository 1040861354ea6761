//! The segment engine compared with a plain implementation of DESIGN A8, which lists and sorts all edges of all channels. All
//! speeds and slices of the engine are compared with each other (DESIGN A2), too.

use proptest::prelude::*;
use std::{collections::BTreeMap, sync::Arc};
use stepscope_core::peripheral::{
    device::{Faults, SegmentEngine},
    segment::{CheckedSegments, PulseTimes, Segment, SegmentList},
    signal::{Levels, Record, Sink},
    units::{Cycles, Instant},
};

/// Bits of the signals that an engine never changes.
const STILL: u64 = Levels::EN | Levels::RX | Levels::TX;

/// Trace and positions by A8, step by step.
fn model(pulse: PulseTimes, lists: &[SegmentList]) -> (Vec<Record>, [i32; 16]) {
    // The bits that change in a cycle; no bit changes twice in a cycle.
    let mut changes: BTreeMap<u64, u64> = BTreeMap::new();
    let mut positions = [0; 16];
    for (channel, list) in lists.iter().enumerate() {
        let mut change = |cycle: u64, bit: usize| *changes.entry(cycle).or_default() ^= 1 << (bit + channel);
        let mut next = list.start.0 << 16;
        let mut level = false;
        let mut last_fall = None;
        for segment in &list.segments {
            match *segment {
                Segment::Dwell(dwell) => next += dwell,
                Segment::Steps { count, mut interval, add, right } => {
                    if right != level {
                        let held = last_fall.map_or(0, |fall: u64| fall + pulse.hold.0);
                        change((next >> 16).max(held), 16);
                        level = right;
                    }
                    for _ in 0..count {
                        next += interval;
                        let fall = (next >> 16) + pulse.width.0;
                        change(next >> 16, 0);
                        change(fall, 0);
                        last_fall = Some(fall);
                        positions[channel] += if right { 1 } else { -1 };
                        interval = interval.wrapping_add_signed(add);
                    }
                }
            }
        }
    }
    let mut levels = STILL;
    let first = Record { cycle: Instant::RESET, levels: Levels::RESET };
    let rest = changes.into_iter().map(|(cycle, bits)| {
        levels ^= bits;
        Record { cycle: Instant(cycle), levels: Levels(levels) }
    });
    (std::iter::once(first).chain(rest).collect(), positions)
}

/// Lists of some hundred steps, most of them valid: intervals from the minimum on, whole cycles and
/// fractions, growing and shrinking.
fn lists() -> impl Strategy<Value = (PulseTimes, Vec<SegmentList>)> {
    let cycles = |range| Strategy::prop_map(range, Cycles);
    let pulse = (cycles(1..=6_u64), cycles(0..=4_u64), cycles(0..=4_u64))
        .prop_map(|(width, setup, hold)| PulseTimes { width, setup, hold });
    pulse.prop_flat_map(|pulse| {
        let least = pulse.min_interval().0 << 16;
        let fraction = prop_oneof![Just(0_u64), 0..0x1_0000_u64];
        let spare = (prop_oneof![2 => Just(0), 2 => 0..3_u64, 1 => 0..400_u64], fraction.clone());
        let steps = (1..=12_u32, spare, prop_oneof![Just(0), -0x4000..0x4000_i64, -0x4_0000..0x4_0000_i64]);
        let steps = (steps, any::<bool>()).prop_map(move |((count, (whole, fraction), add), right)| {
            // A shrinking interval ends at the minimum.
            let room = if add < 0 { u64::from(count - 1) * add.unsigned_abs() } else { 0 };
            Segment::Steps { count, interval: least + (whole << 16) + fraction + room, add, right }
        });
        let dwell =
            (0..200_u64, fraction).prop_map(|(whole, fraction)| Segment::Dwell((whole << 16) + fraction));
        let segments = prop::collection::vec(prop_oneof![3 => steps, 1 => dwell], 0..12);
        let list = (1..60_u64, segments)
            .prop_map(|(start, segments)| SegmentList { start: Instant(start), segments });
        (Just(pulse), prop::collection::vec(list, 0..=16))
    })
}

/// A sink that requests a pause after a number of records.
struct Slice<'a>(&'a mut Vec<Record>, usize);

impl Sink for Slice<'_> {
    fn record(&mut self, record: Record) {
        self.0.push(record);
    }

    fn is_paused(&self) -> bool {
        self.0.len() >= self.1
    }
}

proptest! {
    #[test]
    fn slices_and_speeds_do_not_change_the_edges(
        (pulse, lists) in lists(),
        slice in 1..20_usize,
        hurry in 0..=100_u64,
        until in 1..3000_u64,
    ) {
        let (expected, positions) = model(pulse, &lists);
        let lists = Arc::new(CheckedSegments::new(pulse, lists, 9).expect("they keep the rules"));
        let end = expected.last().map_or(0, |record| record.cycle.0);
        prop_assert_eq!(lists.end().0, end);
        prop_assert!(lists.max_records() >= expected.len() as u64);
        let done = |engine: &SegmentEngine| {
            (engine.is_idle(), engine.cycles_until_event(), engine.now().0, engine.positions()) == (true, None, end + 1, positions)
        };

        let (mut fast, mut engine) = (Vec::new(), SegmentEngine::new(Arc::clone(&lists)));
        engine.run(Instant::NEVER, &mut fast);
        prop_assert_eq!(&fast, &expected);
        prop_assert!(done(&engine), "{:?}", engine);

        let (mut clocked, mut engine) = (Vec::new(), SegmentEngine::new(Arc::clone(&lists)));
        let mut levels = Levels(0);
        while !engine.is_idle() {
            levels = engine.clock(&mut clocked);
        }
        prop_assert_eq!(&clocked, &expected);
        prop_assert_eq!(Some(levels), expected.last().map(|record| record.levels));
        prop_assert!(done(&engine), "{:?}", engine);

        let (mut sliced, mut engine) = (Vec::new(), SegmentEngine::new(Arc::clone(&lists)));
        while !engine.is_idle() {
            let pause = sliced.len() + slice;
            engine.run(Instant::NEVER, &mut Slice(&mut sliced, pause));
        }
        prop_assert_eq!(&sliced, &expected);
        prop_assert!(done(&engine), "{:?}", engine);

        let (mut skipped, mut engine) = (Vec::new(), SegmentEngine::new(Arc::clone(&lists)));
        while let Some(quiet) = engine.cycles_until_event() {
            engine.advance(Cycles(quiet.0 * hurry / 100));
            engine.clock(&mut skipped);
        }
        prop_assert_eq!(&skipped, &expected);
        prop_assert!(done(&engine), "{:?}", engine);

        let (mut cut, mut engine) = (Vec::new(), SegmentEngine::new(Arc::clone(&lists)));
        engine.run(Instant::RESET, &mut cut);
        prop_assert_eq!((engine.now(), cut.len()), (Instant::RESET, 0), "until reset nothing is run");
        engine.run(Instant(until), &mut cut);
        prop_assert_eq!(engine.now(), Instant(until));
        prop_assert!(cut.iter().eq(expected.iter().filter(|record| record.cycle.0 < until)));
        let cut_short = steps_before(&expected, until);
        prop_assert_eq!(engine.positions(), cut_short, "positions count the edges so far");
        engine.run(Instant::NEVER, &mut cut);
        prop_assert_eq!(&cut, &expected);
    }
}

proptest! {
    /// PLANT F7: an overload at any time of a pulse, a reversal or a list.
    #[test]
    fn an_overload_lowers_all_signals_but_dir_and_ends_the_steps(
        (pulse, lists) in lists(),
        place in any::<prop::sample::Index>(),
        late in 0..=2_u64,
    ) {
        let (expected, positions) = model(pulse, &lists);
        let lists = Arc::new(CheckedSegments::new(pulse, lists, 9).expect("they keep the rules"));
        let at = place.get(&expected).cycle.0 + late;
        let (mut found, mut engine) = (Vec::new(), SegmentEngine::new(Arc::clone(&lists)));
        engine.run(Instant(at), &mut found);
        engine.stop_on_overload();
        engine.stop_on_overload();
        if at == 0 {
            engine.run(Instant::NEVER, &mut found);
            prop_assert_eq!((found, engine.positions()), (expected, positions), "before cycle 0 nothing");
            prop_assert_eq!(engine.faults(), Faults::default());
            return Ok(());
        }
        let mut left: Vec<Record> = expected.iter().copied().filter(|record| record.cycle.0 < at).collect();
        let levels = left.last().map_or(0, |record| record.levels.0) & !(Levels::EN | 0xffff);
        left.push(Record { cycle: Instant(at), levels: Levels(levels) });
        let cut_short = steps_before(&expected, at);
        for clocked in [false, true] {
            let (mut engine, mut found) = (engine.clone(), found.clone());
            prop_assert_eq!((engine.faults(), engine.positions()), (Faults::OVERLOAD, cut_short));
            if clocked {
                prop_assert_eq!(engine.clock(&mut found), Levels(levels));
            }
            engine.stop_on_overload();
            engine.run(Instant::NEVER, &mut found);
            prop_assert_eq!(&found, &left);
            prop_assert_eq!((engine.is_idle(), engine.now(), engine.positions()), (true, Instant(at + 1), cut_short));
            prop_assert_eq!(engine.faults(), Faults::OVERLOAD);
        }
    }
}

#[test]
fn positions_count_into_a_segment_beyond_31_bits_of_steps() {
    let pulse = PulseTimes { width: Cycles(1), setup: Cycles(0), hold: Cycles(0) };
    let steps =
        |count, right| Segment::Steps { count, interval: pulse.min_interval().0 << 16, add: 0, right };
    let list = SegmentList { start: Instant(1), segments: vec![steps(u32::MAX, true), steps(5, false)] };
    let mut engine =
        SegmentEngine::new(Arc::new(CheckedSegments::new(pulse, vec![list], 1).expect("it fits")));
    engine.run(Instant(1 + 3 * pulse.min_interval().0 + 1), &mut Vec::new());
    assert_eq!(engine.positions()[0], 3);
}

/// Positions by the edges before a cycle (DESIGN A3).
fn steps_before(trace: &[Record], cycle: u64) -> [i32; 16] {
    std::array::from_fn(|channel| {
        let steps = stepscope_core::peripheral::trace::steps(trace, channel as u8);
        steps.iter().rev().find(|step| step.cycle < cycle).map_or(0, |step| step.position)
    })
}
