//! The falls of the pulses that are high: they come in the order of the rises, because all pulses
//! have the same width, and each channel has at most one.

use crate::{signal::MAX_CHANNELS, units::Instant};

/// Channels whose pulses fall in one cycle.
#[derive(Clone, Copy, Debug)]
struct Fall {
    cycle: Instant,
    steps: u16,
}

#[derive(Clone, Debug)]
pub(super) struct FallingEdges {
    /// A ring: channels fall together or in cycles of their own, so there are never more than 16.
    ring: [Fall; MAX_CHANNELS],
    first: usize,
    count: usize,
    /// The first one's cycle; [`Instant::NEVER`] where there is none.
    cycle: Instant,
}

impl Default for FallingEdges {
    fn default() -> Self {
        let none = Fall { cycle: Instant::NEVER, steps: 0 };
        Self { ring: [none; MAX_CHANNELS], first: 0, count: 0, cycle: Instant::NEVER }
    }
}

impl FallingEdges {
    /// The next fall; [`Instant::NEVER`] where there is none.
    pub(super) const fn cycle(&self) -> Instant {
        self.cycle
    }

    /// The pulses of `steps` fall in `cycle`, later than all others.
    pub(super) const fn push(&mut self, cycle: Instant, steps: u16) {
        debug_assert!(self.count < MAX_CHANNELS, "a pulse begins before the channel's last one fell");
        if self.count == 0 {
            self.cycle = cycle;
        }
        self.ring[(self.first + self.count) % MAX_CHANNELS] = Fall { cycle, steps };
        self.count += 1;
    }

    /// Takes out the next fall: its channels.
    pub(super) const fn pop(&mut self) -> u16 {
        let steps = self.ring[self.first].steps;
        self.first = (self.first + 1) % MAX_CHANNELS;
        self.count = self.count.saturating_sub(1);
        self.cycle = if self.count == 0 { Instant::NEVER } else { self.ring[self.first].cycle };
        steps
    }
}
