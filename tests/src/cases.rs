//! Random configurations and line activity for the property tests, as proptest strategies that shrink.
//!
//! Random bytes at random times would rarely reach the limit of a rule. A case is therefore a list of
//! *pieces* (a packet, a truncated packet, a frame, a damaged frame, noise) and *faults* (a forced level). Each is placed
//! at a limit of the contract: exactly 45 bit times after the last byte, a commit within a cycle of a
//! tick's end, a byte in progress when a reply begins, a glitch on a sample point, a boot that ends when a packet is
//! committed. A drawn case has plain values, and the cycles are computed from the configuration afterwards, so each piece
//! shrinks separately.

mod faults;
mod frames;
mod host;
mod lines;
mod segments;
mod sends;
mod setup;

#[cfg(test)]
mod tests;

use proptest::prelude::*;
use proptest::sample::Index;

use crate::oracle::{Config, Input, bit_time};
use faults::{LineFault, force, line_fault};
use sends::{Line, Pause, Piece, pause, piece, split};
use setup::raw_line;

pub use crate::oracle::frame;
pub use lines::{framed_lines, framed_lines_of_one_address};
pub use segments::{SegmentCase, segment_lists};
pub use setup::{Mode, configs, every_mode};

/// Maximum cycles of a run with raw packets.
const LONGEST_RUN: u64 = 30_000;

/// A configuration with raw packets and line activity for it, at most 30 000 cycles long.
pub fn cases(modes: impl Strategy<Value = Mode>) -> impl Strategy<Value = (Config, Input)> {
    (configs(modes), activity()).prop_map(|(config, activity)| {
        let mut line = vec![config];
        let input = activity.on(&mut line);
        (line.remove(0), input)
    })
}

/// One to four controllers with raw addressed packets on one line, and line activity for them, at most 30 000 cycles
/// long. `clock_hz`, `baud` and `channels` are common, and addresses differ; a few controllers are refused.
pub fn raw_lines<M>(modes: M) -> impl Strategy<Value = (Vec<Config>, Input)>
where
    M: Strategy<Value = Mode> + 'static,
{
    (raw_line(modes), activity()).prop_map(|(mut line, activity)| {
        let input = activity.on(&mut line);
        (line, input)
    })
}

/// Activity on a line of raw packets, before its cycles are computed from the configurations.
#[derive(Debug)]
struct Activity {
    /// Each piece, with the controller of its packet.
    pieces: Vec<(Pause, Piece, Split, Index)>,
    in_a_hurry: bool,
    faults: Vec<LineFault>,
    /// The first controller's boot ends in the cycle of a packet, or one cycle before or after it.
    boot_at_commit: Option<(Index, i64)>,
    end: End,
}

/// Where a piece is split, and the pause between the parts.
type Split = Option<(Index, Pause)>;

fn activity() -> impl Strategy<Value = Activity> {
    let pieces = prop::collection::vec((pause(), piece(), split(), any::<Index>()), 0..18);
    let faults = prop_oneof![
        3 => Just(Vec::new()),
        2 => prop::collection::vec(line_fault(), 1..6),
    ];
    let boot_at_commit = prop::option::weighted(0.2, (any::<Index>(), -1..=1_i64));
    (pieces, any::<bool>(), faults, boot_at_commit, end()).prop_map(
        |(pieces, in_a_hurry, faults, boot_at_commit, end)| Activity {
            pieces,
            in_a_hurry,
            faults,
            boot_at_commit,
            end,
        },
    )
}

impl Activity {
    /// Computes the cycles on a line of at least one controller.
    fn on(self, configs: &mut [Config]) -> Input {
        let first = configs[0].clone();
        let mut line = Line::new(&first, self.in_a_hurry);
        for (pause, piece, split, which) in &self.pieces {
            let which = which.index(configs.len());
            let bytes = piece.bytes(&configs[which]);
            let orders_tick = which == 0 && piece.orders_tick();
            match split {
                Some((at, second_pause)) if bytes.len() > 1 => {
                    let (first, second) = bytes.split_at(1 + at.index(bytes.len() - 1));
                    line.send(*pause, first, false);
                    line.send(*second_pause, second, orders_tick);
                }
                _ => line.send(*pause, &bytes, orders_tick),
            }
        }
        let (sends, commits, byte_starts, quiet_from) =
            (line.sends, line.deliveries, line.byte_starts, line.free_from);
        if let Some((which, offset)) = self.boot_at_commit
            && !commits.is_empty()
        {
            configs[0].boot = which.get(&commits).saturating_add_signed(offset);
        }
        let forced = force(&first, &self.faults, &byte_starts);
        let delivery = |which: Index| if commits.is_empty() { 0 } else { *which.get(&commits) };
        let cycles = match self.end {
            End::After(cycles) => quiet_from + cycles,
            End::PartWay(permille) => 1 + quiet_from * permille / 1_000,
            End::AfterTicks(which, ticks, offset) => {
                let tick = first.slots * first.step_period;
                (delivery(which) + 1 + ticks * tick).saturating_add_signed(offset)
            }
            End::Gap(which, offset) => {
                (delivery(which) + 45 * bit_time(&first)).saturating_add_signed(offset)
            }
        };
        Input { sends, forced, cycles: cycles.clamp(1, LONGEST_RUN) }
    }
}

#[derive(Debug, Clone, Copy)]
enum End {
    /// Cycles after the line has become idle.
    After(u64),
    /// During the line's activity, in per mille of it.
    PartWay(u64),
    /// A number of ticks after a send's last delivery: if they start there, in the cycle of a tick's end or
    /// next to it.
    AfterTicks(Index, u64, i64),
    /// 45 bit times and some cycles after a send's last delivery.
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
