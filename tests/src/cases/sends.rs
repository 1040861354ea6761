//! Sends of the host: complete and truncated packets and noise, with pauses near the gap and near
//! ends of ticks.

use proptest::prelude::*;
use proptest::sample::Index;

use crate::oracle::{Config, bit_time, byte_start, stop_sample};

/// The time of a send, relative to the previous one.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pause {
    /// Cycles after the end of the last stop bit.
    Idle(u64),
    /// A5's gap: the first byte starts 45 bit times and this many cycles after the start of the previous one.
    Gap(i64),
    /// The last byte is delivered this many cycles after a tick's end, as predicted by [`Line`].
    TickEnd(i64),
}

pub(super) fn pause() -> impl Strategy<Value = Pause> {
    prop_oneof![
        4 => (0..4_u64).prop_map(Pause::Idle),
        2 => (0..300_u64).prop_map(Pause::Idle),
        2 => (300..4_000_u64).prop_map(Pause::Idle),
        2 => (-2..=3_i64).prop_map(Pause::Gap),
        3 => (-2..=2_i64).prop_map(Pause::TickEnd),
    ]
}

/// Where some pieces are split, and the pause between the parts.
pub(super) fn split() -> impl Strategy<Value = Option<(Index, Pause)>> {
    prop::option::weighted(0.15, (any::<Index>(), pause()))
}

#[derive(Debug, Clone)]
pub(super) enum Piece {
    Packet {
        to: To,
        orders: Vec<(bool, Count)>,
        /// One command exceeds the slots.
        too_many: Option<(Index, u64)>,
        /// Missing bytes at the end; 0 for a complete packet.
        missing: usize,
    },
    Noise(Vec<u8>),
}

/// Receiver of an addressed packet; ignored if packets have no address.
#[derive(Debug, Clone, Copy)]
pub(super) enum To {
    Own,
    All,
    /// The controller's address plus this number, so never that address.
    OtherAddress(u8),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Count {
    /// Modulo slots + 1.
    Any(u64),
    AllSlots,
}

impl Count {
    pub(super) fn steps(self, config: &Config) -> u64 {
        match self {
            Count::Any(count) => count % (config.slots + 1),
            Count::AllSlots => config.slots,
        }
    }
}

pub(super) fn piece() -> impl Strategy<Value = Piece> {
    let to =
        prop_oneof![6 => Just(To::Own), 1 => Just(To::All), 2 => (1..=255_u8).prop_map(To::OtherAddress)];
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
    /// Whether the controller makes a tick of it, if the queue has space.
    pub(super) fn orders_tick(&self) -> bool {
        matches!(self, Piece::Packet { to: To::Own | To::All, too_many: None, missing: 0, .. })
    }

    pub(super) fn bytes(&self, config: &Config) -> Vec<u8> {
        let (to, orders, too_many, missing) = match self {
            Piece::Noise(bytes) => return bytes.clone(),
            Piece::Packet { to, orders, too_many, missing } => (to, orders, too_many, missing),
        };
        let mut counts: Vec<u64> =
            orders[..config.channels].iter().map(|(_, count)| count.steps(config)).collect();
        if let Some((which, excess)) = too_many {
            counts[which.index(config.channels)] = (config.slots + excess).min(127);
        }
        let mut bytes = Vec::new();
        if let Some(own) = config.address {
            bytes.push(match to {
                To::Own => own,
                To::All => 255,
                To::OtherAddress(offset) => own.wrapping_add(*offset),
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

/// Start and end of a tick.
struct Foreseen {
    start: u64,
    end: u64,
}

/// The host's schedule so far.
pub(super) struct Line<'a> {
    config: &'a Config,
    pub(super) sends: Vec<(u64, Vec<u8>)>,
    /// Where each send's last byte is delivered, without faults on the line.
    pub(super) deliveries: Vec<u64>,
    pub(super) byte_starts: Vec<u64>,
    /// The end of the last stop bit: the earliest start of a send.
    pub(super) free_from: u64,
    /// Ticks that start if there are no faults on the line, in the order of time.
    ticks: Vec<Foreseen>,
    /// Idle pauses are at most a few cycles, so the queue fills.
    in_a_hurry: bool,
}

impl<'a> Line<'a> {
    pub(super) fn new(config: &'a Config, in_a_hurry: bool) -> Self {
        Line {
            config,
            in_a_hurry,
            sends: Vec::new(),
            deliveries: Vec::new(),
            byte_starts: Vec::new(),
            free_from: 1,
            ticks: Vec::new(),
        }
    }

    pub(super) fn send(&mut self, pause: Pause, bytes: &[u8], orders_tick: bool) {
        let config = self.config;
        let last = bytes.len() as u64 - 1;
        let to_delivery = stop_sample(config, byte_start(config, 0, last));
        let soonest = self.free_from + to_delivery;
        let start = match pause {
            Pause::Idle(cycles) if self.in_a_hurry => self.free_from + cycles % 4,
            Pause::Idle(cycles) => self.free_from + cycles,
            Pause::Gap(offset) => self.byte_starts.last().map_or(self.free_from, |last_start| {
                (last_start + 45 * bit_time(config)).saturating_add_signed(offset)
            }),
            Pause::TickEnd(offset) => self
                .ticks
                .iter()
                .map(|tick| tick.end.saturating_add_signed(offset))
                .find(|delivery| *delivery >= soonest)
                .map_or(self.free_from, |delivery| delivery - to_delivery),
        };
        let start = start.max(self.free_from);
        let delivery = start + to_delivery;
        if orders_tick {
            self.foresee(delivery);
        }
        self.sends.push((start, bytes.to_vec()));
        self.deliveries.push(delivery);
        self.byte_starts.extend((0..=last).map(|j| byte_start(config, start, j)));
        self.free_from = byte_start(config, start, last) + byte_start(config, 0, 1);
    }
    /// Predicts the tick of a packet committed at `p`, unless it is too early or the queue is full.
    fn foresee(&mut self, p: u64) {
        let waiting = self.ticks.iter().filter(|tick| tick.start > p).count();
        if p >= self.config.boot && waiting < self.config.queue_depth {
            let start = self.ticks.last().map_or(0, |tick| tick.end).max(p + 1);
            self.ticks.push(Foreseen { start, end: start + self.config.slots * self.config.step_period });
        }
    }
}
