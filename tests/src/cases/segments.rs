//! Random lists for the segment engine (A8): intervals at and near the minimum, ramps, reversals, dwells, and numbers that
//! exceed u64.

use proptest::prelude::*;

use super::{Mode, configs};
use crate::oracle::segments::Segment;
use crate::oracle::{Config, refused};

/// Input of the segment engine.
#[derive(Debug, Clone)]
pub struct SegmentCase {
    /// A configuration that the tick path would accept, too.
    pub config: Config,
    /// Start cycle and segments of each channel.
    pub lists: Vec<(u64, Vec<Segment>)>,
    /// The run is the cycles `0..cycles`.
    pub cycles: u64,
}

/// A list per channel, up to 10 segments of up to 200 steps, at most 20 000 cycles in total; about one case in three
/// breaks a rule of A8.
pub fn segment_lists(modes: impl Strategy<Value = Mode>) -> impl Strategy<Value = SegmentCase> {
    let configs =
        configs(modes).prop_filter("a configuration that is not refused", |config| !refused(config));
    let start = prop_oneof![40 => Just(1_u64), 40 => 1..300_u64, 1 => Just(0), 1 => edge(1 << 48)];
    let list = (start, prop::collection::vec(piece(), 0..10), prop::option::weighted(0.06, rule_breaker()));
    let lists = prop::collection::vec(list, 16);
    let cycles = prop_oneof![1 => 1..500_u64, 3 => 500..20_000_u64];
    (configs, lists, cycles).prop_map(|(config, lists, cycles)| {
        let list = |(start, pieces, last): &(u64, Vec<Piece>, Option<Piece>)| {
            (*start, pieces.iter().chain(last).map(|piece| piece.segment(&config)).collect())
        };
        let lists = lists[..config.channels].iter().map(list).collect();
        SegmentCase { config, lists, cycles }
    })
}

/// A segment relative to the minimum interval.
#[derive(Debug, Clone)]
enum Piece {
    /// From one interval to another in a number of steps, both relative to the minimum, in 1/65536 cycle.
    Ramp {
        steps: u32,
        above: [u64; 2],
        dir: bool,
        /// Added to `add`, so that a step may be too far below the minimum.
        add_to_add: i64,
    },
    /// As given.
    Plain(Segment),
}

fn piece() -> impl Strategy<Value = Piece> {
    let above = prop_oneof![
        2 => Just(0_u64),
        2 => 0..4_u64,
        2 => 0..65_537_u64,
        4 => 0..4_000_000_u64,
    ];
    let above = (above.clone(), above, any::<bool>())
        .prop_map(|(first, last, even)| if even { [first, first] } else { [first, last] });
    let steps = prop_oneof![3 => Just(1_u32), 3 => 2..=5_u32, 2 => 2..=30_u32, 1 => 2..=200_u32];
    let add_to_add = prop_oneof![60 => Just(0_i64), 1 => Just(-1), 1 => Just(1)];
    let dwell =
        prop_oneof![2 => Just(0_u64), 2 => 0..65_537_u64, 3 => 0..500_000_u64, 2 => 0..20_000_000_u64];
    prop_oneof![
        4 => (steps, above, any::<bool>(), add_to_add)
            .prop_map(|(steps, above, dir, add_to_add)| Piece::Ramp { steps, above, dir, add_to_add }),
        2 => dwell.prop_map(|dwell| Piece::Plain(Segment::Dwell(dwell))),
    ]
}

/// Numbers at the limits of the rules; some of them are accepted.
fn rule_breaker() -> impl Strategy<Value = Piece> {
    let interval = prop_oneof![edge(u64::MAX), edge(1 << 63), any::<u64>(), 0..1_000_000_u64];
    let add = prop_oneof![
        3 => any::<i64>(),
        1 => Just(i64::MAX),
        1 => Just(i64::MIN),
        2 => -100_000..100_000_i64,
    ];
    let steps = prop_oneof![2 => Just(0_u32), 4 => Just(1), 4 => 2..=4_u32, 1 => 2..=200_u32];
    prop_oneof![
        4 => (steps, interval, add, any::<bool>())
            .prop_map(|(steps, interval, add, dir)| Segment::Steps { steps, interval, add, dir }),
        1 => edge(u64::MAX).prop_map(Segment::Dwell),
    ]
    .prop_map(Piece::Plain)
}

/// Near a number, or below it by the length of a list.
fn edge(number: u64) -> impl Strategy<Value = u64> {
    let below = prop_oneof![0..3_u64, 65_534..65_538_u64, 0..100_000_000_u64];
    prop_oneof![
        3 => below.prop_map(move |below| number - below),
        1 => (0..3_u64).prop_map(move |above| number.saturating_add(above)),
    ]
}

impl Piece {
    fn segment(&self, config: &Config) -> Segment {
        let (steps, [first, last], dir, add_to_add) = match self {
            Piece::Plain(segment) => return segment.clone(),
            Piece::Ramp { steps, above, dir, add_to_add } => (*steps, *above, *dir, *add_to_add),
        };
        let least = (config.pulse_width + (config.dir_hold + config.dir_setup).max(1)) << 16;
        // Rounded toward zero, so that no interval of the ramp is below the minimum.
        let add = (last as i64 - first as i64) / i64::from(steps - 1).max(1);
        Segment::Steps { steps, interval: least + first, add: add + add_to_add, dir }
    }
}
