//! Scenarios of segments: lists of some hundred steps, and the motions of the small scenarios.

use super::small;
use proptest::prelude::*;
use stepscope_core::{
    peripheral::config::Bus,
    scenario::{
        ChannelSegments, Direction, DwellSegment, MotionEngine, Scenario, Segment, SegmentLists, Source,
        StepSegment,
    },
};

/// Lists, and motions with an exact list; nearly all are valid.
pub fn segmented() -> impl Strategy<Value = Scenario> {
    let motion = small().prop_filter_map("is a motion", |mut scenario| match &mut scenario.source {
        Source::Motion(motion) => {
            motion.engine = MotionEngine::Segments;
            (scenario.bus.pulse_width_cycles, scenario.bus.dir_setup_cycles) = (1, 0);
            Some(scenario)
        }
        _ => None,
    });
    prop_oneof![3 => lists(), 1 => motion]
}

fn lists() -> impl Strategy<Value = Scenario> {
    let bus = (1..=16_u8, 1..=6_u32, 0..=4_u32, 0..=4_u32).prop_map(|(channels, width, setup, hold)| Bus {
        channels,
        pulse_width_cycles: width,
        dir_setup_cycles: setup,
        dir_hold_cycles: hold,
        ..Bus::default()
    });
    (bus, prop::option::weighted(0.3, 1..5_000_u64)).prop_flat_map(|(bus, run_cycles)| {
        let around = bus.dir_hold_cycles + bus.dir_setup_cycles;
        let least = u64::from(bus.pulse_width_cycles + around.max(1)) << 16;
        let most = usize::from(bus.channels);
        prop::collection::vec(list(least), 0..=most).prop_map(move |channels| Scenario {
            bus: bus.clone(),
            run_cycles,
            source: Source::Segments(SegmentLists { channels }),
            ..Scenario::default()
        })
    })
}

fn list(least: u64) -> impl Strategy<Value = ChannelSegments> {
    let add = prop_oneof![Just(0), -0x4_0000..0x4_0000_i64];
    let steps =
        (1..=9_u32, 0..0x20_0000_u64, add, any::<bool>()).prop_map(move |(count, spare, add_q16, right)| {
            // A shrinking interval is still long enough at its end.
            let room = if add_q16 < 0 { u64::from(count - 1) * add_q16.unsigned_abs() } else { 0 };
            let (interval_q16, direction) = (least + spare + room, Direction::of_dir(right));
            Segment::Steps(StepSegment { count, interval_q16, add_q16, direction })
        });
    let dwell = (0..0x100_0000_u64).prop_map(|length_q16| Segment::Dwell(DwellSegment { length_q16 }));
    let segments = prop::collection::vec(prop_oneof![4 => steps, 1 => dwell], 0..8);
    (1..100_u64, segments).prop_map(|(start_cycle, segments)| ChannelSegments { start_cycle, segments })
}
