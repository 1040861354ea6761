//! The controllers of a run: those of a line with all that is on it, or those that run by themselves.

use crate::{alone::Alone, bus::Bus, ignored::Ignored};
#[cfg(feature = "plant")]
use stepscope_peripheral::units::Cycles;
use stepscope_peripheral::{signal::Sink, units::Instant};

/// Controllers under way.
#[derive(Clone, Debug)]
pub(crate) struct Controllers {
    pub(crate) bus: Bus,
    /// Runs in place of the net, which then stays before cycle 0.
    pub(crate) alone: Option<Alone>,
    /// First cycle that is not run; without it the run ends when nothing can change any more.
    pub(crate) end: Option<Instant>,
}

impl Controllers {
    /// The first cycle that nobody has run.
    pub(crate) fn reached(&self) -> Instant {
        self.alone.as_ref().map_or_else(|| self.bus.now(), Alone::now)
    }

    /// Whether all that was to be run is run.
    #[inline]
    pub(crate) fn are_done(&self) -> bool {
        match (&self.alone, self.end) {
            (Some(alone), Some(end)) => alone.now() >= end,
            (Some(alone), None) => alone.at_rest(),
            (None, Some(end)) => self.bus.has_reached(end),
            (None, None) => self.bus.is_over(),
        }
    }

    /// Goes on to cycle `end`, with a sink for each, until a sink asks for a pause; with [`Instant::NEVER`] until nothing
    /// can change any more.
    pub(crate) fn run_to(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        match (&mut self.alone, sinks.first_mut()) {
            (Some(alone), Some(sink)) => alone.run(end, sink),
            (Some(alone), None) => alone.run(end, &mut Ignored),
            (None, _) => self.bus.run(end, sinks),
        }
    }

    /// One cycle, with a sink for each.
    pub(crate) fn clock(&mut self, sinks: &mut [impl Sink]) {
        match (&mut self.alone, sinks.first_mut()) {
            (Some(alone), Some(sink)) => {
                alone.clock(sink);
            }
            (Some(alone), None) => {
                alone.clock(&mut Ignored);
            }
            (None, _) => self.bus.clock(sinks),
        }
    }
}

#[cfg(feature = "plant")]
impl Controllers {
    /// Where nothing can change any more, the cycle after the last change; the last edge was in `last`.
    pub(crate) fn rests_from(&self, last: Instant) -> Option<Instant> {
        match &self.alone {
            Some(alone) => alone.at_rest().then(|| alone.rests_from(last)),
            None => self.bus.is_over().then(|| self.bus.rests_from()),
        }
    }

    /// The plant of a controller reports an overload, last in the cycle that was run last. Returns whether it reacts.
    pub(crate) fn overload(&mut self, controller: usize, sink: &mut impl Sink) -> bool {
        match (&mut self.alone, self.bus.device_mut(controller)) {
            (Some(alone), _) => alone.overload(),
            (None, Some(device)) => {
                device.overload(sink);
                true
            }
            (None, None) => false,
        }
    }

    /// What a controller's self-test found.
    pub(crate) fn settles_in(&mut self, controller: usize, found: Option<Cycles>) {
        if let Some(device) = self.bus.device_mut(controller) {
            device.settles_in(found);
        }
    }
}
