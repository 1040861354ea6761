//! Runs a move as three segments: a ramp up, a plateau and a ramp down.
//!
//! `cargo run -p stepscope-core --example segment_list`

use std::sync::Arc;
use stepscope_core::peripheral::{
    device::SegmentEngine,
    segment::{CheckedSegments, PulseTimes, Refused, Segment, SegmentList},
    signal::Record,
    trace::steps,
    units::{Cycles, Instant},
};

/// Cycles in units of 1/65536, as in segments.
const fn cycles(whole: i64) -> i64 {
    whole << 16
}

fn main() -> Result<(), Vec<Refused>> {
    // Each step comes `interval` after the one before; `add` changes the next interval.
    let steps_of = |count, interval: i64, add| Segment::Steps {
        count,
        interval: interval.unsigned_abs(),
        add,
        right: true,
    };
    let segments = vec![
        steps_of(100, cycles(8000), cycles(-60)),
        steps_of(500, cycles(2000), 0),
        steps_of(100, cycles(2060), cycles(60)),
    ];
    let list = SegmentList { start: Instant(1), segments };

    // All rules are checked before the run: pulses do not overlap, and times fit in 64 bits.
    let pulse = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) };
    let lists = CheckedSegments::new(pulse, vec![list], 1)?;

    let mut engine = SegmentEngine::new(Arc::new(lists));
    let mut trace: Vec<Record> = Vec::new();
    engine.run(Instant::NEVER, &mut trace);

    assert_eq!(engine.positions()[0], 700);
    let steps = steps(&trace, 0);
    let interval = |index: usize| steps[index].cycle - steps[index - 1].cycle;
    assert_eq!([interval(1), interval(99), interval(300), interval(699)], [7940, 2060, 2000, 8000]);
    println!("700 steps in {} cycles, {} records", engine.now().0, trace.len());
    Ok(())
}
