//! The sums of ticks' steps per channel, modulo 2^32 like position counters (DESIGN A3).

use alloc::sync::Arc;
use stepscope_peripheral::signal::MAX_CHANNELS;
use stepscope_peripheral::wire::packet::ChannelCommand;

/// The sums of the first ticks of a job, stored so that each tick is added once.
#[derive(Clone, Debug)]
pub(super) struct TickSums {
    commands: Arc<[u8]>,
    channels: u8,
    ticks: u32,
    sums: [i32; MAX_CHANNELS],
}

impl TickSums {
    pub(super) fn new(commands: Arc<[u8]>, channels: u8) -> Self {
        let channels = channels.clamp(1, MAX_CHANNELS as u8);
        Self { commands, channels, ticks: 0, sums: [0; MAX_CHANNELS] }
    }

    /// Steps per channel of the first `ticks` ticks, right positive, wrapping.
    pub(super) fn after(&mut self, ticks: u32) -> &[i32] {
        if ticks < self.ticks {
            (self.ticks, self.sums) = (0, [0; MAX_CHANNELS]);
        }
        let channels = usize::from(self.channels);
        let bytes = self.ticks as usize * channels..ticks as usize * channels;
        for tick in self.commands.get(bytes).unwrap_or_default().chunks(channels) {
            for (sum, byte) in self.sums.iter_mut().zip(tick) {
                let ChannelCommand { right, steps } = ChannelCommand::parse(*byte);
                let steps = i32::from(steps);
                *sum = sum.wrapping_add(if right { steps } else { -steps });
            }
        }
        self.ticks = ticks;
        self.sums.get(..channels).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_summed_over_the_requested_ticks() {
        let mut sums = TickSums::new([0x85, 0x02, 0x03, 0x81, 0xff, 0x7f].into(), 2);
        for (ticks, expected) in [(0, [0, 0]), (2, [2, -1]), (3, [129, -128]), (1, [5, -2])] {
            assert_eq!(sums.after(ticks), expected, "{ticks}");
        }
    }
}
