//! The earliest of up to 16 channels, found again in at most four comparisons after a change.
//!
//! ```text
//!        1          a tree of minima: entry i holds the lesser of 2i and 2i + 1, the leaves
//!      2   3        (channel c at size + c) hold cycle << 4 | channel; so the root has both the
//!     4 5 6 7       earliest cycle and, of channels of the same cycle, the first
//! ```

use crate::{signal::MAX_CHANNELS, units::Instant};

/// Bits of a key for its channel.
const CHANNEL_BITS: u32 = 4;
/// Key of a channel for which nothing is due. No cycle is after [`Earliest::LAST`], so no other key is as great.
const NEVER: u64 = u64::MAX;
const ENTRIES: usize = 2 * MAX_CHANNELS;
const _: () = assert!(MAX_CHANNELS.is_power_of_two() && MAX_CHANNELS <= 1 << CHANNEL_BITS);

#[derive(Clone, Debug)]
pub(super) struct Earliest {
    keys: [u64; ENTRIES],
    /// Leaves, a power of two; the first one's index.
    size: usize,
}

impl Earliest {
    /// The last cycle that has a key of its own.
    pub(super) const LAST: Instant = Instant((NEVER >> CHANNEL_BITS) - 1);

    /// `channels` channels, at most 16, for which nothing is due.
    pub(super) fn new(channels: usize) -> Self {
        Self { keys: [NEVER; ENTRIES], size: channels.clamp(1, MAX_CHANNELS).next_power_of_two() }
    }

    /// Sets the cycle of a channel, [`Instant::NEVER`] or one up to [`Self::LAST`].
    pub(super) fn set(&mut self, channel: usize, cycle: Instant) {
        debug_assert!(channel < self.size, "channel {channel} has no leaf");
        debug_assert!(cycle == Instant::NEVER || cycle <= Self::LAST, "{cycle:?} has no key");
        let mut index = (self.size + channel) % ENTRIES;
        let mut least =
            if cycle == Instant::NEVER { NEVER } else { cycle.0 << CHANNEL_BITS | channel as u64 };
        self.keys[index] = least;
        while index > 1 {
            least = least.min(self.keys[index ^ 1]);
            index /= 2;
            self.keys[index] = least;
        }
    }

    /// The earliest cycle; [`Instant::NEVER`] where nothing is due.
    pub(super) const fn cycle(&self) -> Instant {
        match self.keys[1] {
            NEVER => Instant::NEVER,
            key => Instant(key >> CHANNEL_BITS),
        }
    }

    /// The channel of the earliest cycle; of several the first.
    pub(super) const fn channel(&self) -> usize {
        self.keys[1] as usize % MAX_CHANNELS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_is_the_earliest_and_of_those_the_first() {
        for channels in 1..=MAX_CHANNELS {
            let mut tree = Earliest::new(channels);
            assert_eq!(tree.cycle(), Instant::NEVER);
            let mut cycles = [Instant::NEVER; MAX_CHANNELS];
            let mut random = 1_u64;
            for _ in 0..2000 {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let channel = (random >> 33) as usize % channels;
                cycles[channel] = match random >> 50 & 7 {
                    0 => Instant::NEVER,
                    1 => Instant(1 << 59),
                    small => Instant(small),
                };
                tree.set(channel, cycles[channel]);
                let earliest = cycles.iter().min().copied().unwrap();
                assert_eq!(tree.cycle(), earliest);
                if earliest != Instant::NEVER {
                    assert_eq!(Some(tree.channel()), cycles.iter().position(|&cycle| cycle == earliest));
                }
            }
        }
    }
}
