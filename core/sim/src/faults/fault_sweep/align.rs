//! Aligns the commanded and the executed ticks: which are missing, duplicated or not commanded, and which have other steps.
//!
//! Where the lists differ, the smallest number of ticks is skipped after which [`SAME`] ticks agree again.

use alloc::vec::Vec;
use stepscope_peripheral::{signal::MAX_CHANNELS, wire::packet::ChannelCommand};

/// Equal ticks after which two lists count as aligned again.
const SAME: usize = 3;
/// Maximum number of ticks to skip.
const MAX_SKIPPED: usize = 64;

/// Ticks of one byte per channel.
type Ticks<'a, 't> = &'t [&'a [u8]];

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Alignment {
    /// Executed with other steps than commanded.
    pub(super) wrong: u64,
    /// Executed twice, or not commanded.
    pub(super) duplicated: u64,
    /// Commanded but not executed.
    pub(super) missing: u64,
    pub(super) wrong_steps: u64,
    pub(super) missing_steps: u64,
}

impl Alignment {
    /// Compares lists of bytes, `channels` (above 0) per tick. Ignores an incomplete tick at an end.
    pub(super) fn of(commanded: &[u8], executed: &[u8], channels: usize) -> Self {
        let [commanded, executed] =
            [commanded, executed].map(|bytes| bytes.chunks_exact(channels).collect::<Vec<_>>());
        let (mut commanded, mut executed) = (&commanded[..], &executed[..]);
        let mut found = Self::default();
        while !(commanded.is_empty() && executed.is_empty()) {
            let same = commanded.iter().zip(executed).take_while(|(one, other)| one == other).count();
            (commanded, executed) = (rest(commanded, same), rest(executed, same));
            let (missing, duplicated) = difference(commanded, executed);
            found.count(part(commanded, missing), part(executed, duplicated));
            (commanded, executed) = (rest(commanded, missing), rest(executed, duplicated));
        }
        found
    }

    fn count(&mut self, commanded: Ticks<'_, '_>, executed: Ticks<'_, '_>) {
        let both = commanded.len().min(executed.len());
        self.wrong += both as u64;
        self.missing += (commanded.len() - both) as u64;
        self.duplicated += (executed.len() - both) as u64;
        self.missing_steps += step_count(rest(commanded, both));
        self.wrong_steps += step_count(rest(executed, both));
        let pairs = commanded.iter().zip(executed).flat_map(|(one, other)| one.iter().zip(*other));
        self.wrong_steps += pairs.map(|(&one, &other)| steps(one).abs_diff(steps(other))).sum::<u64>();
    }
}

/// The smallest numbers of ticks to skip in both lists before they agree. Not both 0 if the first ticks differ.
fn difference(commanded: Ticks<'_, '_>, executed: Ticks<'_, '_>) -> (usize, usize) {
    let (max_missing, max_duplicated) = (commanded.len(), executed.len());
    let agree = |missing: usize, duplicated: usize| {
        let next = rest(commanded, missing).iter().take(SAME);
        next.eq(rest(executed, duplicated).iter().take(SAME))
    };
    let splits = |sum: usize| (0..=sum).map(move |missing| (missing, sum - missing));
    (0..=MAX_SKIPPED)
        .flat_map(splits)
        .find(|&(missing, duplicated)| {
            missing <= max_missing && duplicated <= max_duplicated && agree(missing, duplicated)
        })
        .unwrap_or((max_missing.min(MAX_SKIPPED), max_duplicated.min(MAX_SKIPPED)))
}

/// Distance of the positions from the sums of the ticks, in steps over all channels.
pub(super) fn distance(commanded: &[u8], channels: usize, positions: &[i32]) -> u64 {
    let mut expected = [0_i64; MAX_CHANNELS];
    for tick in commanded.chunks(channels) {
        expected.iter_mut().zip(tick).for_each(|(sum, &byte)| *sum += steps(byte));
    }
    expected.iter().zip(positions).map(|(one, &other)| one.abs_diff(other.into())).sum()
}

fn step_count(ticks: Ticks<'_, '_>) -> u64 {
    ticks.iter().copied().flatten().map(|&byte| steps(byte).unsigned_abs()).sum()
}

fn steps(byte: u8) -> i64 {
    let ChannelCommand { right, steps } = ChannelCommand::parse(byte);
    if right { steps.into() } else { -i64::from(steps) }
}

fn part<'a, 't>(ticks: Ticks<'a, 't>, len: usize) -> Ticks<'a, 't> {
    ticks.get(..len).unwrap_or(ticks)
}

fn rest<'a, 't>(ticks: Ticks<'a, 't>, from: usize) -> Ticks<'a, 't> {
    ticks.get(from..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commanded and executed ticks of one channel; wrong, duplicated, missing, wrong steps, missing steps.
    #[test]
    fn the_smallest_difference_is_found() {
        type Row<'a> = (&'a [u8], &'a [u8], [u64; 5]);
        let rows: &[Row<'_>] = &[
            (&[], &[], [0; 5]),
            (&[1, 2, 3, 4, 5], &[1, 2, 3, 4, 5], [0; 5]),
            (&[1, 2, 3, 4, 5], &[1, 2, 4, 5], [0, 0, 1, 0, 3]),
            (&[1, 2, 3, 4, 5], &[1, 2, 2, 3, 4, 5], [0, 1, 0, 2, 0]),
            (&[1, 2, 3, 4, 5], &[1, 2, 0x83, 4, 5], [1, 0, 0, 6, 0]),
            (&[1, 2, 3, 4, 5], &[1, 2], [0, 0, 3, 0, 12]),
            (&[1, 2], &[1, 2, 0x81], [0, 1, 0, 1, 0]),
            (&[], &[9, 9], [0, 2, 0, 18, 0]),
            (&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[2, 3, 4, 0x85, 6, 7, 8, 9, 9], [1, 1, 1, 19, 1]),
        ];
        for (commanded, executed, expected) in rows {
            let found = Alignment::of(commanded, executed, 1);
            let found =
                [found.wrong, found.duplicated, found.missing, found.wrong_steps, found.missing_steps];
            assert_eq!(found, *expected, "{commanded:?} {executed:?}");
        }
    }

    #[test]
    fn lists_that_never_agree_are_compared_to_their_ends() {
        let commanded = [1; 1000];
        let found = Alignment::of(&commanded, &[2; 700], 2);
        assert_eq!((found.wrong, found.duplicated, found.missing), (350, 0, 150));
    }

    #[test]
    fn an_incomplete_tick_is_ignored() {
        for (commanded, executed) in [(&[1, 2, 3][..], &[1, 2][..]), (&[1, 2], &[1, 2, 3]), (&[1], &[])] {
            assert_eq!(
                Alignment::of(commanded, executed, 2),
                Alignment::default(),
                "{commanded:?} {executed:?}"
            );
        }
    }

    #[test]
    fn the_distance_counts_every_channel() {
        let mut positions = [0; MAX_CHANNELS];
        positions[..2].copy_from_slice(&[3, -4]);
        assert_eq!(distance(&[0x81, 2, 0x82, 2], 2, &positions), 0);
        assert_eq!(distance(&[0x81, 2, 0x02, 2], 2, &positions), 4);
    }
}
