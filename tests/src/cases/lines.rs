//! Framed controllers on one line (A6, A9), and a host that exchanges frames with them.

use proptest::prelude::*;
use proptest::sample::Index;

use super::Mode;
use super::faults::{force, line_fault};
use super::frames::{overlong, ticks_and_positions, utterance};
use super::host::{Host, Pause, Turn, pause, step_rise};
use super::setup::framed_line;
use crate::oracle::{Config, Input};

/// Maximum cycles of a run of framed controllers.
pub(super) const LONGEST_CONVERSATION: u64 = 200_000;

/// One to four framed controllers on one line and a host, at most 200 000 cycles long and mostly
/// less than 60 000.
///
/// `clock_hz` and `baud` are common, and addresses differ; a single controller may have none. Valid and damaged frames of
/// all kinds mostly follow the previous reply. Some collide with it, or come at a tick's end or during a
/// boot. In some cases levels are forced on the line.
pub fn framed_lines<M>(modes: M) -> impl Strategy<Value = (Vec<Config>, Input)>
where
    M: Strategy<Value = Mode> + 'static,
{
    let turns = |calm| prop::collection::vec(turn(calm), 0..20);
    let said = prop_oneof![turns(true), turns(false)];
    let long = prop::option::weighted(0.06, (any::<Index>(), overlong()));
    let asked = prop::option::weighted(0.5, (any::<Index>(), ticks_and_positions(), step_rise()));
    let faults = prop_oneof![
        4 => Just(Vec::new()),
        1 => prop::collection::vec(line_fault(), 1..4),
    ];
    let boot_at = prop::option::weighted(0.2, (any::<Index>(), any::<Index>(), -1..=1_i64));
    (framed_line(modes), said, (long, asked), faults, boot_at, end()).prop_map(
        |(mut line, mut said, (long, asked), faults, boot_at, end)| {
            if let Some((at, [ticks, positions], rise)) = asked {
                let at = at.index(said.len() + 1);
                said.insert(at, (rise, positions, None));
                said.insert(at, (Pause::Polite(0), ticks, None));
            }
            if let Some((at, long)) = long {
                said.insert(at.index(said.len() + 1), (Pause::Polite(0), long, None));
            }
            if let Some((which, send, offset)) = boot_at {
                let deliveries = converse(&line, &said).deliveries;
                if !deliveries.is_empty() {
                    let which = which.index(line.len());
                    line[which].boot = send.get(&deliveries).saturating_add_signed(offset);
                }
            }
            let host = converse(&line, &said);
            let forced = force(&line[0], &faults, &host.byte_starts);
            let quiet_from = host.quiet_from();
            let (sends, deliveries) = (host.sends, host.deliveries);
            let cycles = match end {
                End::Quiet(cycles) => quiet_from + cycles,
                End::PartWay(permille) => 1 + quiet_from * permille / 1_000,
                End::After(which, cycles) if !deliveries.is_empty() => which.get(&deliveries) + cycles,
                End::After(_, cycles) => cycles,
            };
            (line, Input { sends, forced, cycles: cycles.clamp(1, LONGEST_CONVERSATION) })
        },
    )
}

/// Like [`framed_lines`], but all controllers have the first one's address, so several reply at once and receive each
/// other's replies as frames.
pub fn framed_lines_of_one_address<M>(modes: M) -> impl Strategy<Value = (Vec<Config>, Input)>
where
    M: Strategy<Value = Mode> + 'static,
{
    framed_lines(modes).prop_map(|(mut line, input)| {
        let address = line[0].address;
        for config in &mut line {
            config.address = address;
        }
        (line, input)
    })
}

fn turn(calm: bool) -> impl Strategy<Value = Turn> {
    let cut = prop::option::weighted(0.1, (any::<Index>(), pause(calm)));
    (pause(calm), utterance(calm), cut)
}

fn converse<'a>(line: &'a [Config], said: &[Turn]) -> Host<'a> {
    let mut host = Host::new(line);
    for turn in said {
        host.say(turn);
    }
    host
}

#[derive(Debug, Clone, Copy)]
enum End {
    /// Cycles after the last send and reply.
    Quiet(u64),
    /// During the activity, in per mille of it.
    PartWay(u64),
    /// Cycles after a send's last delivery, possibly before the end or the start of its reply.
    After(Index, u64),
}

fn end() -> impl Strategy<Value = End> {
    prop_oneof![
        6 => (0..6_000_u64).prop_map(End::Quiet),
        1 => (0..1_000_u64).prop_map(End::PartWay),
        1 => (any::<Index>(), 0..400_u64).prop_map(|(which, cycles)| End::After(which, cycles)),
    ]
}
