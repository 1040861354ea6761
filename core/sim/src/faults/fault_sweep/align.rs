//! Aligns the commanded and the executed ticks: which were executed, which were not, and which are additional.
//!
//! Where the lists differ, the smallest change that explains it counts: ticks missing, ticks added, or
//! ticks with other steps, until [`SAME`] of them agree again.

use stepscope_peripheral::{signal::MAX_CHANNELS, wire::packet::ChannelCommand};

/// Equal ticks after which two lists agree again.
const SAME: usize = 3;
/// Maximum ticks to search for that.
const FAR: usize = 64;

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
            let (left, put) = difference(commanded, executed, channels);
            found.take(part(commanded, left * channels), part(executed, put * channels), channels);
            (commanded, executed) = (rest(commanded, left * channels), rest(executed, put * channels));
        }
        found
    }

    fn take(&mut self, commanded: &[u8], executed: &[u8], channels: usize) {
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

/// The smallest number of ticks of both lists after which they agree.
fn difference(commanded: &[u8], executed: &[u8], channels: usize) -> (usize, usize) {
    let (max_left, max_put) = (commanded.len() / channels, executed.len() / channels);
    let agree = |left: usize, put: usize| {
        let one = rest(commanded, left * channels).chunks(channels).take(SAME);
        one.eq(rest(executed, put * channels).chunks(channels).take(SAME))
    };
    let splits = |sum: usize| (0..=sum).map(move |left| (left, sum - left));
    (0..=FAR)
        .flat_map(splits)
        .find(|&(left, put)| left <= max_left && put <= max_put && agree(left, put))
        .unwrap_or((max_left.min(FAR), max_put.min(FAR)))
}

/// Distance of positions from the sums of the ticks, in steps of all channels.
pub(super) fn distance(commanded: &[u8], channels: usize, positions: &[i32; MAX_CHANNELS]) -> u64 {
    let mut expected = [0_i64; MAX_CHANNELS];
    for tick in commanded.chunks(channels) {
        expected.iter_mut().zip(tick).for_each(|(sum, &byte)| *sum += steps(byte));
    }
    expected.iter().zip(positions).map(|(one, &other)| one.abs_diff(other.into())).sum()
}

fn steps(byte: u8) -> i64 {
    let order = ChannelCommand::parse(byte);
    if order.right { order.steps.into() } else { -i64::from(order.steps) }
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

    /// Ordered and executed ticks of one channel; wrong, extra, missing, wrong steps, missing steps.
    #[test]
    fn the_least_that_explains_the_difference_is_found() {
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
    fn lists_that_never_agree_come_to_an_end() {
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
