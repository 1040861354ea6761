//! Properties of every form of a motion's step table (DESIGN B8), run by the segment engine (A8).

use crate::moves::{CLOCK_HZ, plan, sane_move};
use proptest::prelude::*;
use std::{num::NonZeroU32, sync::Arc};
use stepscope_core::{
    motion::{
        Cause, ScheduledStep, ValueError,
        mechanics::{Acceleration, Distance, Speed},
        moves::{Constant, Cosine, Dwell, Move, SineSegments, Staircase, Trapezoid, TrapezoidMethod},
        step_tables::{
            EntryFormat, Form, MAX_TOLERANCE, Side, Stored, TimingError, Tolerance, compressed,
            compressed_quickly, stored,
        },
    },
    peripheral::{
        device::SegmentEngine,
        segment::{CheckedSegments, PulseTimes, Segment, SegmentList},
        signal::Record,
        trace::steps,
        units::{Cycles, Instant},
    },
};

const PULSE: PulseTimes = PulseTimes { width: Cycles(1), setup: Cycles(1), hold: Cycles(0) };

fn steps_s(speed: f64) -> Speed {
    Speed::StepsPerSecond(speed)
}

fn trapezoid(steps: f64, start: f64, top: f64, acceleration: f64, method: TrapezoidMethod) -> Move {
    Move::Trapezoid(Trapezoid {
        distance: Distance::Steps(steps),
        start_speed: Some(steps_s(start)),
        max_speed: steps_s(top),
        max_acceleration: Acceleration::StepsPerSecond2(acceleration),
        method,
        timer_hz: 1_000_000,
        ..Trapezoid::default()
    })
}

fn kept(moves: Vec<Move>, form: Form, format: EntryFormat) -> Stored {
    let form = if let Form::Compressed(tolerance) = form { Form::Quick(tolerance) } else { form };
    stored(&plan(moves), form, format, PULSE, CLOCK_HZ).unwrap_or_else(|cause| panic!("{cause}"))
}

/// Cycles and directions of the steps that the segment engine makes of a list, from its start.
fn run(list: &SegmentList) -> Vec<(u64, bool)> {
    let checked = CheckedSegments::new(PULSE, vec![list.clone()], 1);
    let checked = checked.unwrap_or_else(|refused| panic!("{refused:?}"));
    let mut trace: Vec<Record> = Vec::new();
    SegmentEngine::new(Arc::new(checked)).run(Instant::NEVER, &mut trace);
    let mut position = 0;
    let made = steps(&trace, 0);
    made.iter()
        .map(|step| {
            let right = step.position > position;
            position = step.position;
            (step.cycle - list.start.0, right)
        })
        .collect()
}

fn format() -> impl Strategy<Value = EntryFormat> {
    prop::sample::select(EntryFormat::ALL.to_vec())
}

fn tolerance() -> impl Strategy<Value = Tolerance> {
    let cycles = prop_oneof![0..4_u64, 0..40_u64, 0..500_u64, 0..=MAX_TOLERANCE.0];
    let side = prop_oneof![Just(Side::Both), Just(Side::Early)];
    (cycles, prop::option::of(2..9_u32), side).prop_map(|(cycles, part, side)| Tolerance {
        cycles: Cycles(cycles),
        interval_part: part.and_then(NonZeroU32::new),
        side,
    })
}

#[test]
fn a_table_counts_the_bytes_of_its_commands_on_the_line() {
    let constant = Move::Constant(Constant { distance: Distance::Steps(100.0), speed: steps_s(800.0) });
    let table = kept(vec![constant], Form::Exact, EntryFormat::TICKS);
    let entries: Vec<_> =
        table.entries.iter().map(|entry| (entry.interval, entry.count, entry.add)).collect();
    assert_eq!(entries, [(0, 0, 1), (10_000, 2, 10_000), (20_000, 98, 0)]);
    // A block of 5 bytes: the direction; and twice a number, the object and three arguments.
    assert_eq!(table.wire_bytes(), Some(5 + 3 + (2 + 2 + 1 + 2) + (2 + 3 + 2 + 1)));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn compressed_steps_stay_within_the_tolerance(
        moves in prop::collection::vec(sane_move(), 1..4), tolerance in tolerance(), format in format(),
    ) {
        let plan = plan(moves);
        let due: Vec<ScheduledStep> = plan.due_steps(CLOCK_HZ).collect();
        // The search for the fewest entries takes longer with wider windows.
        let narrow = tolerance.cycles.0 << format.fraction_bits() < 40;
        let form = if narrow { Form::Compressed(tolerance) } else { Form::Quick(tolerance) };
        let made = stored(&plan, form, format, PULSE, CLOCK_HZ);
        let made = made.unwrap_or_else(|cause| panic!("{cause}"));
        let found = run(&made.list);
        prop_assert_eq!(found.len(), due.len());
        let mut greatest = 0;
        for (index, (&(cycle, right), due_step)) in found.iter().zip(&due).enumerate() {
            prop_assert_eq!(right, due_step.right, "step {}", index);
            let before = index.checked_sub(1).map_or(0, |before| due[before].cycle);
            let after = due.get(index + 1).map_or(u64::MAX, |after| after.cycle - due_step.cycle);
            let shorter = due_step.cycle - before;
            let shorter = if tolerance.side == Side::Both { after.min(shorter) } else { shorter };
            let part = tolerance.interval_part.map_or(u64::MAX, |part| shorter / u64::from(part.get()));
            let off = cycle.abs_diff(due_step.cycle);
            prop_assert!(off <= tolerance.cycles.0.min(part), "step {} is off by {}", index, off);
            prop_assert!(tolerance.side == Side::Both || cycle <= due_step.cycle, "step {} is late", index);
            greatest = greatest.max(off);
        }
        prop_assert_eq!(made.error.max_cycles, greatest);
        prop_assert_eq!(Some(made.error), TimingError::of(&made.list, due));
        // Encoded in the format, an entry has the same times.
        prop_assert_eq!(walked(&made), found);
    }

    #[test]
    fn every_form_has_every_step_and_its_timing_error(
        moves in prop::collection::vec(sane_move(), 1..3), format in format(),
    ) {
        let plan = plan(moves);
        for form in [Form::Exact, Form::Document] {
            match stored(&plan, form, format, PULSE, CLOCK_HZ) {
                Ok(made) => {
                    let found = run(&made.list);
                    prop_assert_eq!(found.len() as u64, plan.step_count());
                    let off = found.iter().zip(plan.due_steps(CLOCK_HZ));
                    let off = off.map(|(made, due)| made.0.abs_diff(due.cycle)).max();
                    prop_assert_eq!(made.error.max_cycles, off.unwrap_or(0));
                    prop_assert!(form != Form::Exact || made.error.max_cycles == 0);
                    prop_assert_eq!(walked(&made), found);
                }
                // Only moves without a table of their own are refused.
                Err(cause) => {
                    let refused = form == Form::Document && matches!(cause, Cause::Value(ValueError::Conflict { .. }));
                    prop_assert!(refused, "{}", cause);
                }
            }
        }
    }

    #[test]
    fn no_list_of_due_steps_causes_a_panic(
        gaps in prop::collection::vec((prop_oneof![0..9_u64, 0..1000_u64, any::<u64>().prop_map(|x| x >> 18)], any::<bool>()), 0..60),
        tolerance in tolerance(), format in format(),
    ) {
        let mut cycle = 0_u64;
        let due: Vec<ScheduledStep> = gaps.iter().map(|&(gap, right)| {
            cycle = cycle.saturating_add(gap);
            ScheduledStep { cycle, right }
        }).collect();
        let quick = compressed_quickly(due.iter().copied(), tolerance, format, PULSE);
        match compressed(due.iter().copied(), tolerance, format, PULSE) {
            Ok(made) => {
                let made_quickly = quick.map_or(usize::MAX, |quick| quick.list.segments.len());
                prop_assert!(made.surplus != Some(0) || made.list.segments.len() <= made_quickly);
                let found = TimingError::of(&made.list, due);
                prop_assert_eq!(Some(made.error), found);
                prop_assert!(made.error.max_cycles <= tolerance.cycles.0);
                prop_assert!(CheckedSegments::new(PULSE, vec![made.list], 1).is_ok());
            }
            Err(cause) => {
                let refused = matches!(cause, Cause::StepTooSoon { .. } | Cause::Value(ValueError::TooMuch { .. }));
                prop_assert!(refused, "{}", cause);
            }
        }
    }
}

/// The steps of a table's entries, walked as the comment of its source code describes.
fn walked(table: &Stored) -> Vec<(u64, bool)> {
    let (mut time, mut right, mut made) = (0_u64, false, Vec::new());
    for entry in &table.entries {
        let mut interval = entry.interval;
        if entry.count == 0 {
            time += interval;
            right = entry.add == 1;
        }
        for _ in 0..entry.count {
            time += interval;
            interval = interval.wrapping_add_signed(entry.add);
            made.push((time >> table.format.fraction_bits(), right));
        }
    }
    made
}

/// 10^6 steps at 200 000 steps/s and 200 000 steps/s^2, which Klipper's step compression reduces to about 1289 entries.
#[test]
fn a_long_trapezoid_takes_fewer_entries_than_klippers_compression() {
    let ramp = vec![trapezoid(1e6, 1.0, 200_000.0, 200_000.0, TrapezoidMethod::Exact)];
    let micros_25 = Cycles(400);
    let half = NonZeroU32::new(2);
    let rows = [
        (EntryFormat::Q16, None, 60),
        (EntryFormat::Q8, None, 160),
        (EntryFormat::TICKS, None, 260),
        // Klipper also limits the error of a step to half an interval.
        (EntryFormat::Q16, half, 80),
        (EntryFormat::TICKS, half, 800),
    ];
    for (format, interval_part, most) in rows {
        let tolerance = Tolerance { interval_part, ..Tolerance::of(micros_25) };
        let made = kept(ramp.clone(), Form::Compressed(tolerance), format);
        assert_eq!(made.error.steps, 1_000_000);
        assert!(made.entries.len() <= most, "{}: {}", format.name, made.entries.len());
        assert!(made.error.max_cycles <= 400 && made.error.rms() < made.error.max_cycles as f64);
    }
}

/// Due where s = k - 1/2 at 7/3 of a 1000th of the clock: no error accumulates over 10^8 steps.
#[test]
fn a_hundred_million_steps_do_not_drift() {
    let count = 100_000_000_u64;
    let due = |k: u64| (k * 2 - 1) * 1000 * 3 / (7 * 2);
    let steps = (1..=count).map(|k| ScheduledStep { cycle: due(k), right: true });
    let made = compressed(steps, Tolerance::of(Cycles(16)), EntryFormat::Q16, PULSE);
    let made = made.unwrap_or_else(|cause| panic!("{cause}"));
    assert!(made.error.max_cycles <= 16 && made.error.steps == count);
    // The last step's time in closed form: the sum over the entries.
    let (mut time, mut all) = (0_u128, 0);
    for segment in &made.list.segments {
        let Segment::Steps { count, interval, add, .. } = *segment else { panic!("it never rests") };
        let n = i128::from(count);
        time = time.wrapping_add_signed(n * i128::from(interval) + n * (n - 1) / 2 * i128::from(add));
        all += u64::from(count);
    }
    assert_eq!(all, count);
    assert!((time >> 16).abs_diff(u128::from(due(count))) <= 16);
    assert!(made.list.segments.len() <= 200, "{}", made.list.segments.len());
}

#[test]
fn tables_of_papers_have_their_sizes_and_errors() {
    let constant = Move::Constant(Constant { distance: Distance::Steps(500.0), speed: steps_s(3000.0) });
    let staircase = Move::Staircase(Staircase {
        distance: Distance::Steps(17_233.0),
        level: 3,
        top_speed: steps_s(5000.0),
        ..Staircase::default()
    });
    let sine =
        Move::SineSegments(SineSegments { amplitude: Distance::Steps(1000.0), ..SineSegments::default() });
    let q16 = EntryFormat::Q16;
    // Move, format, entries, the paper's bytes, maximum error.
    let rows = [
        // 250 to 1200 steps/s at 9000 steps/s^2: 76 rows in whole ticks of a timer whose clock divides the clock.
        (trapezoid(300.0, 250.0, 1200.0, 9000.0, TrapezoidMethod::Table), q16, 0),
        (trapezoid(300.0, 250.0, 1200.0, 9000.0, TrapezoidMethod::Table), EntryFormat::TICKS, 0),
        (staircase.clone(), q16, 1),
        (sine.clone(), q16, 1),
        (constant, q16, 1),
    ];
    for (given, format, greatest) in rows {
        let made = kept(vec![given.clone()], Form::Document, format);
        assert!(made.error.max_cycles <= greatest, "{given:?}: {:?}", made.error);
        assert!(made.document_bytes.is_some_and(|bytes| bytes <= made.bytes()), "{given:?}");
    }
    // 16 MHz divided by a whole rate is rarely an integer: the error grows by half a cycle per step.
    let coarse = kept(vec![staircase], Form::Document, EntryFormat::TICKS);
    assert!(coarse.error.max_cycles > 100, "{:?}", coarse.error);
    // Six segments of six bytes.
    assert_eq!(kept(vec![sine], Form::Document, q16).document_bytes, Some(36));
}

#[test]
fn steps_without_a_table_or_an_end_are_rejected() {
    let refused =
        |given: Move, form| stored(&plan(vec![given]), form, EntryFormat::TICKS, PULSE, CLOCK_HZ).err();
    let curve = Move::Cosine(Cosine {
        distance: Distance::Steps(100.0),
        duration_s: 1.0,
        ramp_s: 0.5,
        ..Cosine::default()
    });
    assert!(matches!(refused(curve, Form::Document), Some(Cause::Value(ValueError::Conflict { .. }))));
    let quick = Move::Constant(Constant { distance: Distance::Steps(9.0), speed: steps_s(9e6) });
    for form in [Form::Exact, Form::Compressed(Tolerance::of(Cycles(5)))] {
        let cause = Cause::StepTooSoon { step: 1, interval: 1, pulse: PULSE };
        assert_eq!(refused(quick.clone(), form), Some(cause));
    }
    let interval = 1 << 16;
    let cause = Cause::SegmentInterval { step: 1, interval, pulse: PULSE };
    assert_eq!(refused(quick, Form::Document), Some(cause));
    let many = Move::Constant(Constant { distance: Distance::Steps(5e6), speed: steps_s(1e5) });
    let cause = Cause::Value(ValueError::TooMuch { given: 5e6, max: 4e6, of: "steps of a table" });
    assert_eq!(refused(many, Form::Exact), Some(cause));
    let rest = Move::Dwell(Dwell { duration_s: 1.0 });
    let wide = Tolerance::of(Cycles(MAX_TOLERANCE.0 + 1));
    let cause =
        ValueError::TooMuch { given: 16_777_217.0, max: 16_777_216.0, of: "cycles of tolerance" }.into();
    assert_eq!(refused(rest.clone(), Form::Compressed(wide)), Some(cause));
    let nothing = kept(vec![rest], Form::Compressed(Tolerance::of(MAX_TOLERANCE)), EntryFormat::Q8);
    assert_eq!((nothing.entries.len(), nothing.error.rms()), (0, 0.0));
}
