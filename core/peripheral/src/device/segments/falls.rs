//! The falls of the pulses that are high: they come in the order of the rises, because all pulses
//! have the same width, and each channel has at most one. After an overload EN falls with all of them, alone.

use crate::{signal::MAX_CHANNELS, units::Instant};

/// Signals that fall in one cycle.
#[derive(Clone, Copy, Debug)]
struct Fall {
    cycle: Instant,
    signals: u64,
}

#[derive(Clone, Debug)]
pub(super) struct FallingEdges {
    /// A ring: channels fall together or in cycles of their own, so there are never more than 16.
    ///
    /// Invariant: where there is no fall, it is in [`Instant::NEVER`].
    ring: [Fall; MAX_CHANNELS],
    /// Falls that were taken out, and all.
    passed: usize,
    count: usize,
}

impl Default for FallingEdges {
    fn default() -> Self {
        let none = Fall { cycle: Instant::NEVER, signals: 0 };
        Self { ring: [none; MAX_CHANNELS], passed: 0, count: 0 }
    }
}

impl FallingEdges {
    /// The next fall; [`Instant::NEVER`] where there is none.
    #[inline(always)]
    pub(super) const fn cycle(&self) -> Instant {
        self.ring[self.passed % MAX_CHANNELS].cycle
    }

    /// `signals` of a trace's levels fall in `cycle`, later than all others.
    #[inline(always)]
    pub(super) const fn push(&mut self, cycle: Instant, signals: u64) {
        let place = &mut self.ring[self.count % MAX_CHANNELS];
        debug_assert!(place.cycle.0 == Instant::NEVER.0, "a pulse begins before the channel's last one fell");
        *place = Fall { cycle, signals };
        self.count = self.count.wrapping_add(1);
    }

    /// Takes out the next fall: its signals.
    #[inline(always)]
    pub(super) const fn pop(&mut self) -> u64 {
        let place = &mut self.ring[self.passed % MAX_CHANNELS];
        place.cycle = Instant::NEVER;
        self.passed = self.passed.wrapping_add(1);
        place.signals
    }
}
