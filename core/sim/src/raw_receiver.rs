//! A raw controller on its line: it never drives it, so it listens alone, whoever else does.

use stepscope_peripheral::{device::Device, signal::Sink, units::Instant, wire::Line};

/// A controller and its line, window by window.
#[derive(Clone, Debug)]
pub(super) struct RawReceiver {
    line: Line,
    device: Device,
    /// What the line stays the same for: from a cycle to the first one after it.
    ///
    /// Invariant: `start <= until`; both only rise.
    start: Instant,
    until: Instant,
    /// Whether bytes are heard as they are sent.
    in_step: bool,
}

impl RawReceiver {
    pub(super) fn new(line: Line, device: Device) -> Self {
        let in_step = device.is_in_step(line.bit_starts());
        Self { line, device, start: Instant::RESET, until: Instant::RESET, in_step }
    }

    pub(super) const fn line(&self) -> &Line {
        &self.line
    }

    pub(super) const fn line_mut(&mut self) -> &mut Line {
        &mut self.line
    }

    pub(super) const fn device(&self) -> &Device {
        &self.device
    }

    #[cfg(feature = "plant")]
    pub(super) const fn device_mut(&mut self) -> &mut Device {
        &mut self.device
    }

    /// Whether nothing can change any more.
    pub(super) fn is_over(&self) -> bool {
        self.line.is_over() && self.device.at_rest()
    }

    /// Whether it has run the cycles before `end`.
    pub(super) fn has_reached(&self, end: Instant) -> bool {
        self.start >= end
    }

    /// Runs to cycle `end`, or with [`Instant::NEVER`] until nothing can change any more, or until the
    /// sink asks for a pause: the inner loop of a long run.
    pub(super) fn run(&mut self, end: Instant, sink: &mut impl Sink) {
        let (mut start, mut until) = (self.start, self.until);
        let mut level = self.line.heard(true);
        while start < end {
            if self.in_step && self.device.run_bytes(&mut self.line, end, sink) {
                (start, until, level) = (self.device.now(), self.line.heard_until().min(end), true);
                continue;
            }
            if start == until {
                // Several where all rested meanwhile, and nobody heard them.
                while self.line.next_change() <= start {
                    self.line.change();
                    level = self.line.heard(true);
                }
                until = self.line.heard_until().min(end);
                debug_assert!(start < until, "the line changed before {start:?}");
            }
            self.device.run(level, until, sink);
            let rests = until == Instant::NEVER && self.device.at_rest();
            if self.device.now() < until && !rests {
                break;
            }
            start = until;
        }
        (self.start, self.until) = (start, until);
    }

    /// One cycle.
    pub(super) fn clock(&mut self, sink: &mut impl Sink) {
        while self.line.next_change() <= self.start {
            self.line.change();
        }
        self.device.clock(self.line.heard(true), sink);
        self.start = self.start.next();
        self.until = self.start;
    }

    /// The last cycle in which something happened.
    pub(super) fn last_active(&self) -> Instant {
        self.device.last_active()
    }

    /// At rest: cycle `now` is the first that has not been run.
    pub(super) fn finish(&mut self, now: Instant) {
        self.device.finish(now);
        (self.start, self.until) = (now, Instant::NEVER);
    }
}
