//! Aligns the commanded and the executed ticks: which are missing, which are additional, and which have other steps.
//!
//! Where the lists differ, the smallest number of ticks is skipped after which [`SAME`] ticks agree again.

use stepscope_peripheral::{signal::MAX_CHANNELS, wire::packet::ChannelCommand};

/// Equal ticks after which two lists count as aligned again.
const SAME: usize = 3;
/// Maximum number of ticks to skip.
const MAX_SKIPPED: usize = 64;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Alignment {
    /// Executed with other steps than commanded.
    pub(super) wrong: u64,
    /// Executed but not commanded, or executed twice.
    pub(super) extra: u64,
    /// Commanded but not executed.
    pub(super) missing: u64,
    pub(super) wrong_steps: u64,
    pub(super) missing_steps: u64,
}

impl Alignment {
    pub(super) fn of(commanded: &[u8], executed: &[u8], channels: usize) -> Self {
        let mut found = Self::default();
        let (mut commanded, mut executed) = (commanded, executed);
        while !(commanded.is_empty() && executed.is_empty()) {
            let same = commanded
                .chunks(channels)
                .zip(executed.chunks(channels))
                .take_while(|(commanded, executed)| commanded == executed);
            let same = channels * same.count();
            (commanded, executed) = (rest(commanded, same), rest(executed, same));
            let (missing, added) = difference(commanded, executed, channels);
            let (missing, added) = (missing * channels, added * channels);
            found.count(part(commanded, missing), part(executed, added), channels);
            (commanded, executed) = (rest(commanded, missing), rest(executed, added));
        }
        found
    }

    fn count(&mut self, commanded: &[u8], executed: &[u8], channels: usize) {
        let both = commanded.len().min(executed.len());
        self.wrong += (both / channels) as u64;
        self.missing += ((commanded.len() - both) / channels) as u64;
        self.extra += ((executed.len() - both) / channels) as u64;
        self.missing_steps +=
            rest(commanded, both).iter().map(|&byte| steps(byte).unsigned_abs()).sum::<u64>();
        self.wrong_steps += rest(executed, both).iter().map(|&byte| steps(byte).unsigned_abs()).sum::<u64>();
        let pairs = commanded.iter().zip(executed);
        self.wrong_steps += pairs.map(|(&one, &other)| steps(one).abs_diff(steps(other))).sum::<u64>();
    }
}

/// The smallest numbers of ticks to skip in both lists before they agree.
fn difference(commanded: &[u8], executed: &[u8], channels: usize) -> (usize, usize) {
    let (max_missing, max_added) = (commanded.len() / channels, executed.len() / channels);
    let agree = |missing: usize, added: usize| {
        let one = rest(commanded, missing * channels).chunks(channels).take(SAME);
        one.eq(rest(executed, added * channels).chunks(channels).take(SAME))
    };
    let splits = |sum: usize| (0..=sum).map(move |missing| (missing, sum - missing));
    (0..=MAX_SKIPPED)
        .flat_map(splits)
        .find(|&(missing, added)| missing <= max_missing && added <= max_added && agree(missing, added))
        .unwrap_or((max_missing.min(MAX_SKIPPED), max_added.min(MAX_SKIPPED)))
}

/// Distance of the positions from the sums of the ticks, in steps over all channels.
pub(super) fn distance(commanded: &[u8], channels: usize, positions: &[i32]) -> u64 {
    let mut expected = [0_i64; MAX_CHANNELS];
    for tick in commanded.chunks(channels) {
        expected.iter_mut().zip(tick).for_each(|(sum, &byte)| *sum += steps(byte));
    }
    expected.iter().zip(positions).map(|(one, &other)| one.abs_diff(other.into())).sum()
}

fn steps(byte: u8) -> i64 {
    let ChannelCommand { right, steps } = ChannelCommand::parse(byte);
    if right { steps.into() } else { -i64::from(steps) }
}

fn part(ticks: &[u8], len: usize) -> &[u8] {
    ticks.get(..len).unwrap_or(ticks)
}

fn rest(ticks: &[u8], from: usize) -> &[u8] {
    ticks.get(from..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commanded and executed ticks of one channel; wrong, extra, missing, wrong steps, missing steps.
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
            let found = [found.wrong, found.extra, found.missing, found.wrong_steps, found.missing_steps];
            assert_eq!(found, *expected, "{commanded:?} {executed:?}");
        }
    }

    #[test]
    fn lists_that_never_agree_are_compared_to_their_ends() {
        let commanded = [1; 1000];
        let found = Alignment::of(&commanded, &[2; 700], 2);
        assert_eq!((found.wrong, found.extra, found.missing), (350, 0, 150));
    }

    #[test]
    fn the_distance_counts_every_channel() {
        let mut positions = [0; MAX_CHANNELS];
        positions[..2].copy_from_slice(&[3, -4]);
        assert_eq!(distance(&[0x81, 2, 0x82, 2], 2, &positions), 0);
        assert_eq!(distance(&[0x81, 2, 0x02, 2], 2, &positions), 4);
    }
}
