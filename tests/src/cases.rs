//! Random configurations and line activity for the property tests, as proptest strategies that shrink.
//!
//! Plain random bytes at random times would seldom meet a rule's edge. So a case is drawn as a list of *pieces* (a
//! packet, a packet cut short, noise) and *strikes* (a forced level), each placed by a rule that aims at an edge of the
//! contract: exactly 45 bit times after the last byte, a commit within a cycle of a tick's end, a glitch on a sample
//! point, a boot that ends as a packet is committed. What was drawn is plain values; [`cases`] then works out the cycles
//! from the configuration, so that every piece shrinks on its own.

use proptest::prelude::*;
use proptest::sample::Index;

use crate::oracle::{Config, Input, bit_time, byte_start, pulse_room, stop_sample};

#[cfg(test)]
mod tests;

/// No run is longer than this, cycles.
const LONGEST_RUN: u64 = 30_000;

/// How the DIR lines run and how the channels' pulses stand to each other (A7).
#[derive(Debug, Clone, Copy)]
pub struct Mode {
    /// One DIR line for all channels, or one a channel.
    pub common_dir: bool,
    /// Staggered, or simultaneous.
    pub staggered: bool,
}

/// All four modes.
pub fn every_mode() -> impl Strategy<Value = Mode> {
    any::<[bool; 2]>().prop_map(|[common_dir, staggered]| Mode { common_dir, staggered })
}

/// Configurations of which about one in eight just misses a rule of A4 or A7 and is refused.
pub fn configs(modes: impl Strategy<Value = Mode>) -> impl Strategy<Value = Config> {
    (link(), drive(), bus(), modes).prop_map(|(link, drive, bus, mode)| {
        let mut config = Config {
            clock_hz: link.clock_hz,
            baud: link.baud,
            receiver_baud: link.receiver_baud,
            channels: bus.channels,
            slots: bus.slots,
            step_period: 0,
            pulse_width: drive.pulse_width,
            dir_setup: drive.dir_setup,
            dir_hold: drive.dir_hold,
            settle: 0,
            queue_depth: bus.queue_depth,
            boot: bus.boot,
            spread: bus.spread,
            common_dir: mode.common_dir,
            staggered: mode.staggered,
            address: bus.address,
        };
        let room = pulse_room(&config);
        let shortest_period = match (config.common_dir, config.staggered) {
            (false, false) => room,
            (true, false) => 2 * room,
            (_, true) => room * config.channels as u64,
        };
        config.step_period = match drive.period {
            Period::Shortest(spare) => shortest_period.saturating_add_signed(spare),
            Period::TickInPackets(permille) => {
                let packet_length = config.channels as u64 + u64::from(config.address.is_some());
                let tick = byte_start(&config, 0, packet_length) * permille / 1_000;
                shortest_period.max(tick / config.slots)
            }
        };
        let shortest_settle = if config.common_dir && config.staggered { room } else { 1 };
        config.settle = shortest_settle.saturating_add_signed(drive.settle_to_spare);
        config
    })
}

/// A configuration and something to do with it, at most 30 000 cycles long.
pub fn cases(modes: impl Strategy<Value = Mode>) -> impl Strategy<Value = (Config, Input)> {
    let pieces = prop::collection::vec((pause(), piece(), split()), 0..18);
    let strikes = prop_oneof![
        3 => Just(Vec::new()),
        2 => prop::collection::vec(strike(), 1..6),
    ];
    let boot_at_commit = prop::option::weighted(0.2, (any::<Index>(), -1..=1_i64));
    (configs(modes), pieces, any::<bool>(), strikes, boot_at_commit, end()).prop_map(
        |(mut config, pieces, in_a_hurry, strikes, boot_at_commit, end)| {
            let mut line = Line::new(&config, in_a_hurry);
            for (pause, piece, split) in &pieces {
                let bytes = piece.bytes(&config);
                match split {
                    Some((at, second_pause)) if bytes.len() > 1 => {
                        let (first, second) = bytes.split_at(1 + at.index(bytes.len() - 1));
                        line.send(*pause, first);
                        line.send(*second_pause, second);
                    }
                    _ => line.send(*pause, &bytes),
                }
            }
            let (sends, commits, byte_starts, quiet_from) =
                (line.sends, line.deliveries, line.byte_starts, line.free_from);
            if let Some((which, offset)) = boot_at_commit
                && !commits.is_empty()
            {
                config.boot = which.get(&commits).saturating_add_signed(offset);
            }
            let forced = force(&config, &strikes, &byte_starts);
            let cycles = match end {
                End::After(cycles) => quiet_from + cycles,
                End::PartWay(permille) => 1 + quiet_from * permille / 1_000,
            };
            (config, Input { sends, forced, cycles: cycles.min(LONGEST_RUN) })
        },
    )
}

#[derive(Debug, Clone)]
struct Link {
    clock_hz: u64,
    baud: u64,
    receiver_baud: u64,
}

/// Bit times of 11 to 40 cycles, seldom dividing the clock, now and then just short of A4's least; the receiver up to
/// 8 % off.
fn link() -> impl Strategy<Value = Link> {
    let clock_hz = prop_oneof![1_000..10_000_u64, 10_000..1_000_000_u64];
    let bit_hundredths = prop_oneof![1 => 1_030..1_100_u64, 12 => 1_100..1_600_u64, 12 => 1_600..4_000_u64];
    let receiver_permille = prop_oneof![4 => Just(1_000_u64), 3 => 960..1_040_u64, 2 => 920..1_080_u64];
    (clock_hz, bit_hundredths, receiver_permille).prop_map(|(clock_hz, hundredths, permille)| {
        let baud = clock_hz * 100 / hundredths;
        Link { clock_hz, baud, receiver_baud: baud * permille / 1_000 }
    })
}

#[derive(Debug, Clone)]
struct Drive {
    pulse_width: u64,
    dir_setup: u64,
    dir_hold: u64,
    period: Period,
    /// Cycles beyond the shortest settling time that A7 takes.
    settle_to_spare: i64,
}

#[derive(Debug, Clone, Copy)]
enum Period {
    /// Cycles beyond the shortest slot that A7 takes; below 0 it is refused.
    Shortest(i64),
    /// A tick lasts this many per mille of what a packet takes on the line: over 1000, queues fill.
    TickInPackets(u64),
}

fn drive() -> impl Strategy<Value = Drive> {
    let period = prop_oneof![
        5 => Just(Period::Shortest(0)),
        4 => (0..=20_i64).prop_map(Period::Shortest),
        2 => (0..=200_i64).prop_map(Period::Shortest),
        8 => (500..5_000_u64).prop_map(Period::TickInPackets),
        1 => Just(Period::Shortest(-1)),
    ];
    let settle_to_spare = prop_oneof![10 => 0..=20_i64, 4 => 0..=200_i64, 1 => Just(-1)];
    (1..=6_u64, 0..=5_u64, 0..=5_u64, period, settle_to_spare).prop_map(
        |(pulse_width, dir_setup, dir_hold, period, settle_to_spare)| Drive {
            pulse_width,
            dir_setup,
            dir_hold,
            period,
            settle_to_spare,
        },
    )
}

#[derive(Debug, Clone)]
struct Bus {
    channels: usize,
    slots: u64,
    queue_depth: usize,
    boot: u64,
    spread: bool,
    address: Option<u8>,
}

fn bus() -> impl Strategy<Value = Bus> {
    let channels = prop_oneof![3 => 1..=3_usize, 2 => 1..=16_usize];
    let boot = prop_oneof![2 => Just(0_u64), 1 => 0..2_000_u64];
    let address = prop::option::of(0..=254_u8);
    let queue_depth = prop_oneof![3 => Just(1_usize), 2 => Just(2), 1 => 3..=4_usize];
    (channels, 1..=20_u64, queue_depth, boot, any::<bool>(), address).prop_map(
        |(channels, slots, queue_depth, boot, spread, address)| Bus {
            channels,
            slots,
            queue_depth,
            boot,
            spread,
            address,
        },
    )
}

/// What a send follows the one before by.
#[derive(Debug, Clone, Copy)]
enum Pause {
    /// Cycles after the last stop bit's end.
    Idle(u64),
    /// A5's gap: the first byte starts 45 bit times and this many cycles after the last one did.
    Gap(i64),
    /// The last byte is delivered a whole number of ticks and this many cycles after the anchor (the last delivery that
    /// was not placed so): where ticks run without a pause from there, within a cycle or two of a tick's end.
    TickEnd(i64),
}

fn pause() -> impl Strategy<Value = Pause> {
    prop_oneof![
        4 => (0..4_u64).prop_map(Pause::Idle),
        2 => (0..300_u64).prop_map(Pause::Idle),
        2 => (300..4_000_u64).prop_map(Pause::Idle),
        2 => (-2..=3_i64).prop_map(Pause::Gap),
        3 => (-2..=2_i64).prop_map(Pause::TickEnd),
    ]
}

/// Some pieces are sent in two parts: where they are cut, and the pause between.
fn split() -> impl Strategy<Value = Option<(Index, Pause)>> {
    prop::option::weighted(0.15, (any::<Index>(), pause()))
}

#[derive(Debug, Clone)]
enum Piece {
    Packet {
        to: To,
        orders: Vec<(bool, Count)>,
        /// One order is beyond the slots.
        too_many: Option<(Index, u64)>,
        /// Bytes missing at the end; 0 for a whole packet.
        missing: usize,
    },
    Noise(Vec<u8>),
}

/// Whom an addressed packet is for; means nothing where packets carry no address.
#[derive(Debug, Clone, Copy)]
enum To {
    Own,
    All,
    /// The own address plus this, so never the own one.
    Foreign(u8),
}

#[derive(Debug, Clone, Copy)]
enum Count {
    /// Modulo slots + 1.
    Any(u64),
    AllSlots,
}

fn piece() -> impl Strategy<Value = Piece> {
    let to = prop_oneof![6 => Just(To::Own), 1 => Just(To::All), 2 => (1..=255_u8).prop_map(To::Foreign)];
    let count = prop_oneof![
        2 => Just(Count::Any(0)),
        1 => Just(Count::Any(1)),
        4 => (0..128_u64).prop_map(Count::Any),
        2 => Just(Count::AllSlots),
    ];
    let orders = prop::collection::vec((any::<bool>(), count), 16);
    let too_many = prop::option::weighted(0.06, (any::<Index>(), 1..128_u64));
    let missing = prop_oneof![15 => Just(0_usize), 1 => 1..4_usize];
    prop_oneof![
        14 => (to, orders, too_many, missing)
            .prop_map(|(to, orders, too_many, missing)| Piece::Packet { to, orders, too_many, missing }),
        1 => prop::collection::vec(any::<u8>(), 1..20).prop_map(Piece::Noise),
    ]
}

impl Piece {
    fn bytes(&self, config: &Config) -> Vec<u8> {
        let (to, orders, too_many, missing) = match self {
            Piece::Noise(bytes) => return bytes.clone(),
            Piece::Packet { to, orders, too_many, missing } => (to, orders, too_many, missing),
        };
        let mut counts: Vec<u64> = orders[..config.channels]
            .iter()
            .map(|(_, count)| match count {
                Count::Any(count) => count % (config.slots + 1),
                Count::AllSlots => config.slots,
            })
            .collect();
        if let Some((which, excess)) = too_many {
            counts[which.index(config.channels)] = (config.slots + excess).min(127);
        }
        let mut bytes = Vec::new();
        if let Some(own) = config.address {
            bytes.push(match to {
                To::Own => own,
                To::All => 255,
                To::Foreign(offset) => own.wrapping_add(*offset),
            });
        }
        for (count, (right, _)) in counts.iter().zip(orders) {
            bytes.push(u8::from(*right) << 7 | *count as u8);
        }
        // At least one byte is sent.
        bytes.truncate(bytes.len().saturating_sub(*missing).max(1));
        bytes
    }
}

/// The host's schedule as it grows.
struct Line<'a> {
    config: &'a Config,
    sends: Vec<(u64, Vec<u8>)>,
    /// Where each send's last byte is delivered, as long as nothing disturbs the line.
    deliveries: Vec<u64>,
    byte_starts: Vec<u64>,
    /// The end of the last stop bit: no send may start before.
    free_from: u64,
    /// See [`Pause::TickEnd`].
    anchor: Option<u64>,
    /// No idle pause is longer than a few cycles: the queue fills.
    in_a_hurry: bool,
}

impl<'a> Line<'a> {
    fn new(config: &'a Config, in_a_hurry: bool) -> Self {
        Line {
            config,
            in_a_hurry,
            sends: Vec::new(),
            deliveries: Vec::new(),
            byte_starts: Vec::new(),
            free_from: 1,
            anchor: None,
        }
    }

    fn send(&mut self, pause: Pause, bytes: &[u8]) {
        let config = self.config;
        let last = bytes.len() as u64 - 1;
        let to_delivery = stop_sample(config, byte_start(config, 0, last));
        let wished = match (pause, self.byte_starts.last(), self.anchor) {
            (Pause::Idle(cycles), ..) if self.in_a_hurry => self.free_from + cycles % 4,
            (Pause::Idle(cycles), ..) => self.free_from + cycles,
            (Pause::Gap(offset), Some(last_start), _) => {
                (last_start + 45 * bit_time(config)).saturating_add_signed(offset)
            }
            (Pause::TickEnd(offset), _, Some(anchor)) => {
                let tick = (config.slots * config.step_period).max(1);
                let ticks = (self.free_from + to_delivery).saturating_sub(anchor).div_ceil(tick);
                (anchor + ticks * tick).saturating_add_signed(offset).saturating_sub(to_delivery)
            }
            _ => self.free_from,
        };
        let start = wished.max(self.free_from);
        let delivery = start + to_delivery;
        if !matches!(pause, Pause::TickEnd(_)) || self.anchor.is_none() {
            self.anchor = Some(delivery);
        }
        self.sends.push((start, bytes.to_vec()));
        self.deliveries.push(delivery);
        self.byte_starts.extend((0..=last).map(|j| byte_start(config, start, j)));
        self.free_from = byte_start(config, start, last) + byte_start(config, 0, 1);
    }
}

/// One forced level.
#[derive(Debug, Clone)]
struct Strike {
    place: Place,
    length: Length,
    level: bool,
}

#[derive(Debug, Clone, Copy)]
enum Place {
    /// Cycles after the start of a byte.
    InByte(Index, u64),
    /// A byte's sample `0..=9` (0 looks at the start bit, 9 at the stop bit), give or take a cycle.
    AtSample(Index, u64, i64),
    /// Cycles from the end of the forced level before, or from cycle 1.
    AfterLast(i64),
    Anywhere(u64),
}

#[derive(Debug, Clone, Copy)]
enum Length {
    Cycles(u64),
    /// Half a bit time, give or take: as long as a glitch can be.
    HalfBit(i64),
    Bits(u64),
}

fn strike() -> impl Strategy<Value = Strike> {
    let place = prop_oneof![
        2 => (any::<Index>(), 0..440_u64).prop_map(|(byte, cycles)| Place::InByte(byte, cycles)),
        3 => (any::<Index>(), 0..=9_u64, -1..=1_i64)
            .prop_map(|(byte, sample, offset)| Place::AtSample(byte, sample, offset)),
        3 => (-8..=8_i64).prop_map(Place::AfterLast),
        2 => (1..LONGEST_RUN).prop_map(Place::Anywhere),
    ];
    let length = prop_oneof![
        4 => (1..=2_u64).prop_map(Length::Cycles),
        2 => (1..=60_u64).prop_map(Length::Cycles),
        2 => (-2..=2_i64).prop_map(Length::HalfBit),
        1 => (8..=60_u64).prop_map(Length::Bits),
    ];
    let level = prop_oneof![3 => Just(false), 2 => Just(true)];
    (place, length, level).prop_map(|(place, length, level)| Strike { place, length, level })
}

/// The strikes' cycles: A4's (cycle, length, level).
fn force(config: &Config, strikes: &[Strike], byte_starts: &[u64]) -> Vec<(u64, u64, bool)> {
    let bit_time = bit_time(config);
    let byte = |which: Index| if byte_starts.is_empty() { 1 } else { *which.get(byte_starts) };
    let mut forced: Vec<(u64, u64, bool)> = Vec::new();
    for strike in strikes {
        let cycle = match strike.place {
            Place::InByte(which, cycles) => byte(which) + cycles,
            Place::AtSample(which, sample, offset) => {
                (byte(which) + bit_time / 2 + sample * bit_time).saturating_add_signed(offset)
            }
            Place::AfterLast(offset) => {
                let end = forced.last().map_or(1, |(cycle, length, _)| cycle + length);
                end.saturating_add_signed(offset)
            }
            Place::Anywhere(cycle) => cycle,
        };
        let length = match strike.length {
            Length::Cycles(cycles) => cycles,
            Length::HalfBit(offset) => (bit_time / 2).saturating_add_signed(offset),
            Length::Bits(bits) => bits * bit_time,
        };
        forced.push((cycle.max(1), length.max(1), strike.level));
    }
    forced
}

#[derive(Debug, Clone, Copy)]
enum End {
    /// Cycles after the line has gone quiet.
    After(u64),
    /// In the midst of the line's activity, per mille of it.
    PartWay(u64),
}

fn end() -> impl Strategy<Value = End> {
    prop_oneof![
        5 => (0..4_000_u64).prop_map(End::After),
        1 => (0..1_000_u64).prop_map(End::PartWay),
    ]
}
