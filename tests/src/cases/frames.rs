//! Frames of a host: valid ones of every kind, and damaged ones.

use proptest::prelude::*;
use proptest::sample::Index;

use super::sends::Count;
use crate::oracle::{Config, LONGEST_FRAME, frame, kinds};

/// Bytes that are sent without a pause.
#[derive(Debug, Clone)]
pub(super) enum Utterance {
    Frame {
        to: To,
        order: ChannelCommand,
        damage: Damage,
    },
    /// Bytes that rarely form a frame.
    Noise(Vec<u8>),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum To {
    Controller(Index),
    All,
    /// The first controller's address plus this number: that of another controller, or of none.
    Beside(u8),
}

#[derive(Debug, Clone)]
pub(super) enum ChannelCommand {
    Ticks {
        seq: Seq,
        count: usize,
        /// The commands of all channels for each tick, repeated.
        orders: Vec<(bool, Count)>,
        /// The last tick has no counts.
        last_is_zero: bool,
        /// One command exceeds the slots.
        too_many: Option<(Index, u64)>,
    },
    /// A frame without a body.
    Plain(u8),
    /// Any kind, any body.
    Any(u8, Vec<u8>),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Seq {
    Expected,
    /// The sequence number before the expected one.
    Repeat,
    /// The expected sequence number plus this number.
    Off(u8),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Damage {
    None,
    FlippedBit(Index),
    Lost(Index),
    Doubled(Index),
    /// Truncated after this number of bytes.
    Cut(Index),
}

/// Unless `calm`, one frame in six is damaged, and there is noise.
pub(super) fn utterance(calm: bool) -> impl Strategy<Value = Utterance> {
    let to = prop_oneof![
        12 => any::<Index>().prop_map(To::Controller),
        3 => Just(To::All),
        1 => any::<u8>().prop_map(To::Beside),
    ];
    let damage = prop_oneof![
        if calm { 2_000 } else { 20 } => Just(Damage::None),
        1 => any::<Index>().prop_map(Damage::FlippedBit),
        1 => any::<Index>().prop_map(Damage::Lost),
        1 => any::<Index>().prop_map(Damage::Doubled),
        1 => any::<Index>().prop_map(Damage::Cut),
    ];
    // Frames also contain zeros.
    let byte = prop_oneof![2 => any::<u8>(), 1 => Just(0), 1 => 1..8_u8];
    prop_oneof![
        if calm { 2_000 } else { 14 } => (to, order(), damage).prop_map(|(to, order, damage)| Utterance::Frame { to, order, damage }),
        1 => prop::collection::vec(byte, 1..12).prop_map(Utterance::Noise),
    ]
}

fn order() -> impl Strategy<Value = ChannelCommand> {
    let seq = prop_oneof![
        14 => Just(Seq::Expected),
        2 => Just(Seq::Repeat),
        1 => (1..=254_u8).prop_map(Seq::Off),
    ];
    let tick_count = prop_oneof![6 => 1..=2_usize, 3 => 1..=6_usize, 1 => 30..=34_usize, 1 => Just(0)];
    let count = prop_oneof![
        2 => Just(Count::Any(0)),
        4 => (0..128_u64).prop_map(Count::Any),
        2 => Just(Count::AllSlots),
    ];
    let orders = prop::collection::vec((any::<bool>(), count), 1..24);
    let too_many = prop::option::weighted(0.06, (any::<Index>(), 1..128_u64));
    let ticks = (seq, tick_count, orders, any::<bool>(), too_many).prop_map(
        |(seq, count, orders, last_is_zero, too_many)| ChannelCommand::Ticks {
            seq,
            count,
            orders,
            last_is_zero,
            too_many,
        },
    );
    let plain = prop_oneof![
        5 => Just(kinds::ENABLE),
        1 => Just(kinds::DISABLE),
        3 => Just(kinds::STATUS),
        2 => Just(kinds::STOP),
        1 => Just(kinds::RESYNC),
        4 => Just(kinds::POSITIONS),
    ];
    let body = prop::collection::vec(prop_oneof![any::<u8>(), 0..3_u8], 0..6);
    prop_oneof![
        14 => ticks,
        6 => plain.prop_map(ChannelCommand::Plain),
        1 => (prop_oneof![0..9_u8, Just(kinds::POSITIONS), any::<u8>()], body).prop_map(|(kind, body)| ChannelCommand::Any(kind, body)),
    ]
}

/// Ticks for all without a reply, with a step in every slot; and POSITIONS, requested while they run.
pub(super) fn ticks_and_positions() -> impl Strategy<Value = [Utterance; 2]> {
    let orders = prop::collection::vec((any::<bool>(), Just(Count::AllSlots)), 1..24);
    (any::<Index>(), 1..=12_usize, orders).prop_map(|(which, count, orders)| {
        let ticks =
            ChannelCommand::Ticks { seq: Seq::Expected, count, orders, last_is_zero: false, too_many: None };
        let asked = ChannelCommand::Plain(kinds::POSITIONS);
        [(To::All, ticks), (To::Controller(which), asked)].map(|(to, order)| Utterance::Frame {
            to,
            order,
            damage: Damage::None,
        })
    })
}

/// A valid frame that decodes to about the maximum length, with a body of zeros, of other bytes, or of
/// both.
pub(super) fn overlong() -> impl Strategy<Value = Utterance> {
    let most = LONGEST_FRAME - 6;
    (most - 2..=most + 5, 0..3_usize, any::<Index>(), any::<Index>()).prop_map(
        |(length, zeros_every, to, bit)| {
            let byte = |i: usize| if zeros_every == 0 || i.is_multiple_of(zeros_every) { 0 } else { 9 };
            Utterance::Frame {
                to: To::Controller(to),
                order: ChannelCommand::Any(kinds::STATUS, (0..length).map(byte).collect()),
                // Half of them are invalid after all: a flipped bit anywhere moves zeros.
                damage: if bit.index(2) == 0 { Damage::None } else { Damage::FlippedBit(bit) },
            }
        },
    )
}

impl To {
    pub(super) fn address(self, line: &[Config]) -> u8 {
        let own = |k: usize| line[k].address.unwrap_or(0);
        match self {
            To::Controller(which) => own(which.index(line.len())),
            To::All => 255,
            To::Beside(offset) => own(0).wrapping_add(offset),
        }
    }
}

impl ChannelCommand {
    /// The frame's kind and body, for a controller that expects this sequence number.
    pub(super) fn kind_and_body(&self, config: &Config, expected_seq: u8) -> (u8, Vec<u8>) {
        let (seq, count, orders, last_is_zero, too_many) = match self {
            ChannelCommand::Plain(kind) => return (*kind, Vec::new()),
            ChannelCommand::Any(kind, body) => return (*kind, body.clone()),
            ChannelCommand::Ticks { seq, count, orders, last_is_zero, too_many } => {
                (*seq, *count, orders, *last_is_zero, *too_many)
            }
        };
        let seq = match seq {
            Seq::Expected => expected_seq,
            Seq::Repeat => expected_seq.wrapping_sub(1),
            Seq::Off(offset) => expected_seq.wrapping_add(offset),
        };
        let length = count * config.channels;
        let order = |(right, count): &(bool, Count)| u8::from(*right) << 7 | count.steps(config) as u8;
        let mut bytes: Vec<u8> = orders.iter().map(order).cycle().take(length).collect();
        if last_is_zero && length > 0 {
            for byte in &mut bytes[length - config.channels..] {
                *byte &= 0x80;
            }
        }
        if let Some((which, excess)) = too_many
            && length > 0
        {
            bytes[which.index(length)] = (config.slots + excess).min(127) as u8;
        }
        (kinds::TICKS, [&[seq, count as u8], &bytes[..]].concat())
    }
}

impl Damage {
    /// The bytes sent in place of the frame, at least one.
    pub(super) fn done_to(self, frame: &[u8]) -> Vec<u8> {
        let mut bytes = frame.to_vec();
        match self {
            Damage::None => {}
            Damage::FlippedBit(which) => {
                let bit = which.index(8 * bytes.len());
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
            Damage::Lost(which) => {
                bytes.remove(which.index(frame.len()));
            }
            Damage::Doubled(which) => {
                let at = which.index(frame.len());
                bytes.insert(at, frame[at]);
            }
            Damage::Cut(which) => bytes.truncate(1 + which.index(frame.len() - 1)),
        }
        bytes
    }
}

/// The contents of a valid frame.
pub(super) struct Good {
    pub(super) address: u8,
    pub(super) kind: u8,
    pub(super) body: Vec<u8>,
}

/// The bytes on the line, and their contents if they are a valid frame.
pub(super) fn said(
    utterance: &Utterance,
    line: &[Config],
    expected_seq: impl Fn(usize) -> u8,
) -> (Vec<u8>, Option<Good>) {
    let (to, order, damage) = match utterance {
        Utterance::Noise(bytes) => return (bytes.clone(), None),
        Utterance::Frame { to, order, damage } => (to, order, damage),
    };
    let address = to.address(line);
    let k = line.iter().position(|config| config.address.unwrap_or(0) == address).unwrap_or(0);
    let (kind, body) = order.kind_and_body(&line[k], expected_seq(k));
    let bytes = damage.done_to(&frame(address, kind, &body));
    let good = matches!(damage, Damage::None).then_some(Good { address, kind, body });
    (bytes, good)
}
