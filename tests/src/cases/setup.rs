//! Random configurations at and near the limits of A4 and A7.

use std::ops::Range;

use proptest::prelude::*;

use crate::oracle::{Config, byte_start, pulse_room};

/// DIR lines, and the phasing of the pulses (A7).
#[derive(Debug, Clone, Copy)]
pub struct Mode {
    /// One DIR line for all channels, or one per channel.
    pub common_dir: bool,
    /// Staggered, or simultaneous.
    pub staggered: bool,
}

/// All four modes.
pub fn every_mode() -> impl Strategy<Value = Mode> {
    any::<[bool; 2]>().prop_map(|[common_dir, staggered]| Mode { common_dir, staggered })
}

/// Configurations of which about one in eight breaks a rule of A4 or A7 and is refused.
pub fn configs(modes: impl Strategy<Value = Mode>) -> impl Strategy<Value = Config> {
    (link(4_000), wide_receiver(), drive(500..5_000), bus(), modes)
        .prop_map(|(link, permille, drive, bus, mode)| assemble(&link, permille, &drive, &bus, mode))
}

/// One to four controllers with raw packets on one line, all addressed; a few are refused. They have the same number of
/// channels, for "packets for another address are consumed by length".
pub(super) fn raw_line<M>(modes: M) -> impl Strategy<Value = Vec<Config>>
where
    M: Strategy<Value = Mode> + 'static,
{
    let controller = (narrow_receiver(), drive(500..5_000), bus(), modes).boxed();
    (link(2_000), addresses(controller)).prop_map(|(link, mut controllers)| {
        let channels = controllers[0].1.2.channels;
        for (_, (_, _, bus, _)) in &mut controllers {
            bus.channels = channels;
        }
        together(&link, controllers.into_iter()).collect()
    })
}

/// One to four controllers of the framed protocol on one line, rarely refused; a single one may have no address.
///
/// Bits are 11 to 20 cycles, so that a conversation of many frames stays short.
pub(super) fn framed_line<M>(modes: M) -> impl Strategy<Value = Vec<Config>>
where
    M: Strategy<Value = Mode> + 'static,
{
    let controller = (narrow_receiver(), drive(2_000..40_000), bus(), modes).boxed();
    let queue_depth = prop_oneof![3 => 1..=3_usize, 3 => 4..=40_usize, 1 => Just(255_usize)];
    (link(2_000), addresses(controller), queue_depth, any::<bool>()).prop_map(
        |(link, mut controllers, queue_depth, nameless)| {
            for (_, (_, drive, bus, _)) in &mut controllers {
                drive.settle_to_spare = drive.settle_to_spare.max(0);
                if let Period::Shortest(spare) = &mut drive.period {
                    *spare = (*spare).max(0);
                }
                // Each has its own, but similar: deep enough for TICKS or not.
                bus.queue_depth = queue_depth.saturating_sub(bus.queue_depth - 1).max(1);
            }
            let mut line: Vec<Config> = together(&link, controllers.into_iter()).collect();
            for config in &mut line {
                config.framed = true;
            }
            if let [lone] = &mut line[..]
                && nameless
            {
                lone.address = None;
            }
            line
        },
    )
}

type Controller = (u64, Drive, Bus, Mode);

/// One to four controllers, one in half of the cases, with different addresses.
fn addresses(controller: BoxedStrategy<Controller>) -> impl Strategy<Value = Vec<(u8, Controller)>> {
    let several = |count| prop::collection::vec(controller.clone(), count);
    let controllers = prop_oneof![2 => several(1..=1), 1 => several(2..=2), 1 => several(3..=4)];
    let (first, stride) = (prop_oneof![Just(0_u8), 0..=254_u8], 1..=63_usize);
    (controllers, first, stride).prop_map(|(controllers, first, stride)| {
        let address = |k: usize| ((usize::from(first) + k * stride) % 255) as u8;
        controllers.into_iter().enumerate().map(|(k, controller)| (address(k), controller)).collect()
    })
}

fn together(link: &Link, line: impl Iterator<Item = (u8, Controller)>) -> impl Iterator<Item = Config> {
    line.map(|(address, (permille, drive, bus, mode))| Config {
        address: Some(address),
        ..assemble(link, permille, &drive, &bus, mode)
    })
}

fn assemble(link: &Link, receiver_permille: u64, drive: &Drive, bus: &Bus, mode: Mode) -> Config {
    let mut config = Config {
        clock_hz: link.clock_hz,
        baud: link.baud,
        receiver_baud: link.baud * receiver_permille / 1_000,
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
        framed: false,
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
}

#[derive(Debug, Clone)]
struct Link {
    clock_hz: u64,
    baud: u64,
}

/// Bit times of 11 cycles and more, rarely a divisor of the clock, sometimes just below A4's minimum.
fn link(longest_bit_hundredths: u64) -> impl Strategy<Value = Link> {
    let clock_hz = prop_oneof![1_000..10_000_u64, 10_000..1_000_000_u64];
    let bit_hundredths = prop_oneof![
        1 => 1_030..1_100_u64,
        12 => 1_100..1_600_u64,
        12 => 1_600..longest_bit_hundredths,
    ];
    (clock_hz, bit_hundredths)
        .prop_map(|(clock_hz, hundredths)| Link { clock_hz, baud: clock_hz * 100 / hundredths })
}

/// The receiver's rate in per mille of the sender's: up to 8 % off.
fn wide_receiver() -> impl Strategy<Value = u64> {
    prop_oneof![4 => Just(1_000_u64), 3 => 960..1_040_u64, 2 => 920..1_080_u64]
}

/// Like [`wide_receiver`], mostly near enough for long frames.
fn narrow_receiver() -> impl Strategy<Value = u64> {
    prop_oneof![4 => Just(1_000_u64), 2 => 985..1_015_u64, 1 => 960..1_040_u64]
}

#[derive(Debug, Clone)]
struct Drive {
    pulse_width: u64,
    dir_setup: u64,
    dir_hold: u64,
    period: Period,
    /// Cycles beyond the minimum settling time of A7.
    settle_to_spare: i64,
}

#[derive(Debug, Clone, Copy)]
enum Period {
    /// Cycles beyond the minimum slot of A7; below 0 it is refused.
    Shortest(i64),
    /// Duration of a tick, in per mille of a packet's time on the line: above 1000, queues fill.
    TickInPackets(u64),
}

fn drive(tick_in_packets_permille: Range<u64>) -> impl Strategy<Value = Drive> {
    let period = prop_oneof![
        5 => Just(Period::Shortest(0)),
        4 => (0..=20_i64).prop_map(Period::Shortest),
        2 => (0..=200_i64).prop_map(Period::Shortest),
        8 => tick_in_packets_permille.prop_map(Period::TickInPackets),
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
