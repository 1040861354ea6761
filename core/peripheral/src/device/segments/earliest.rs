//! The earliest of 16 channels, found again in four comparisons after a change.
//!
//! ```text
//!        1          a tree of minima: entry i holds the lesser of 2i and 2i + 1, the leaves
//!      2   3        (channel c at 16 + c) hold cycle << 4 | channel; so the root has both the
//!     4 5 6 7       earliest cycle and, of channels of the same cycle, the first
//! ```

use crate::{signal::MAX_CHANNELS, units::Instant};

/// Bits of a key for its channel.
const CHANNEL_BITS: u32 = 4;
const ENTRIES: usize = 2 * MAX_CHANNELS;
/// Levels of the tree above its leaves.
const LEVELS: u32 = MAX_CHANNELS.ilog2();
const _: () = assert!(MAX_CHANNELS.is_power_of_two() && MAX_CHANNELS <= 1 << CHANNEL_BITS);

#[derive(Clone, Debug)]
pub(super) struct Earliest {
    keys: [u64; ENTRIES],
}

impl Earliest {
    /// [`Self::cycle`] where nothing is due: what [`Instant::NEVER`] leaves of itself in a key, after every cycle that may be due.
    pub(super) const NONE: Instant = Instant(Instant::NEVER.0 >> CHANNEL_BITS);

    /// Nothing is due.
    pub(super) fn new() -> Self {
        Self { keys: [u64::MAX; ENTRIES] }
    }

    /// Sets the cycle of a channel, [`Instant::NEVER`] or one before [`Self::NONE`].
    #[inline(always)]
    pub(super) fn set(&mut self, channel: usize, cycle: Instant) {
        debug_assert!(channel < MAX_CHANNELS, "channel {channel} has no leaf");
        debug_assert!(cycle == Instant::NEVER || cycle < Self::NONE, "{cycle:?} has no key");
        let mut index = MAX_CHANNELS + channel % MAX_CHANNELS;
        let mut least = cycle.0 << CHANNEL_BITS | channel as u64;
        self.keys[index] = least;
        for _ in 0..LEVELS {
            least = least.min(self.keys[index ^ 1]);
            index /= 2;
            self.keys[index] = least;
        }
    }

    /// The earliest cycle; [`Self::NONE`] where nothing is due.
    pub(super) const fn cycle(&self) -> Instant {
        Instant(self.keys[1] >> CHANNEL_BITS)
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
            let mut tree = Earliest::new();
            assert_eq!(tree.cycle(), Earliest::NONE);
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
                assert_eq!(tree.cycle(), earliest.min(Earliest::NONE));
                if earliest != Instant::NEVER {
                    assert_eq!(Some(tree.channel()), cycles.iter().position(|&cycle| cycle == earliest));
                }
            }
        }
    }
}
