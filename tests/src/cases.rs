//! Random configurations and line activity for the property tests, as proptest strategies that shrink.
//!
//! Plain random bytes at random times would seldom meet a rule's edge. So a case is drawn as a list of
//! *pieces* (a packet, a packet cut short, noise) and *strikes* (a forced level), each placed by a rule
//! that aims at an edge of the contract: exactly 45 bit times after the last byte, a commit within a cycle
//! of a tick's end, a glitch on a sample point, a boot that ends as a packet is committed. What was drawn
//! is plain values; [`cases`] then works out the cycles from the configuration, so that every piece shrinks
//! on its own.

mod sends;
mod setup;
mod strikes;

#[cfg(test)]
mod tests;

use proptest::prelude::*;
use proptest::sample::Index;

use crate::oracle::{Config, Input, bit_time};
use sends::{Line, pause, piece, split};
use strikes::{force, strike};

pub use setup::{Mode, configs, every_mode};

/// No run is longer than this, cycles.
const LONGEST_RUN: u64 = 30_000;

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
                        line.send(*pause, first, false);
                        line.send(*second_pause, second, piece.orders_tick());
                    }
                    _ => line.send(*pause, &bytes, piece.orders_tick()),
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
            let delivery = |which: Index| if commits.is_empty() { 0 } else { *which.get(&commits) };
            let cycles = match end {
                End::After(cycles) => quiet_from + cycles,
                End::PartWay(permille) => 1 + quiet_from * permille / 1_000,
                End::AfterTicks(which, ticks, offset) => {
                    let tick = config.slots * config.step_period;
                    (delivery(which) + 1 + ticks * tick).saturating_add_signed(offset)
                }
                End::Gap(which, offset) => {
                    (delivery(which) + 45 * bit_time(&config)).saturating_add_signed(offset)
                }
            };
            (config, Input { sends, forced, cycles: cycles.clamp(1, LONGEST_RUN) })
        },
    )
}

#[derive(Debug, Clone, Copy)]
enum End {
    /// Cycles after the line has gone quiet.
    After(u64),
    /// In the midst of the line's activity, per mille of it.
    PartWay(u64),
    /// Some ticks after a send's last delivery: where they run from it, in the cycle of a tick's end or
    /// beside it.
    AfterTicks(Index, u64, i64),
    /// 45 bit times after a send's last delivery, and some cycles.
    Gap(Index, i64),
}

fn end() -> impl Strategy<Value = End> {
    prop_oneof![
        5 => (0..4_000_u64).prop_map(End::After),
        1 => (0..1_000_u64).prop_map(End::PartWay),
        2 => (any::<Index>(), 0..4_u64, -1..=2_i64)
            .prop_map(|(which, ticks, offset)| End::AfterTicks(which, ticks, offset)),
        1 => (any::<Index>(), 0..=3_i64).prop_map(|(which, offset)| End::Gap(which, offset)),
    ]
}
