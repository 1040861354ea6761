//! Runs from event to event (DESIGN A2), with the same trace as cycle by cycle.
//!
//! ```text
//! cycle    0 1 2 3 4 5 6 7 8 9 …
//! clock    * * * * * * * * * * *     every cycle
//! run      * * . . . . * . * . .     only cycles with a deadline or a change of the line
//! ```

use crate::device::{Device, Framing, executor::Executor};
use crate::signal::Sink;
use crate::units::{Cycles, Instant};

impl Device {
    /// The next cycle, from [`Self::now`] on, in which something can change while the line keeps its level.
    pub(super) fn deadline(&self) -> Instant {
        if self.now == Instant::RESET {
            return Instant::RESET;
        }
        let gap = match &self.framing {
            Framing::Raw(unpacker) => unpacker.deadline(),
            Framing::Framed(_) => Instant::NEVER,
        };
        let receiver = self.receiver.deadline(self.last_cycle(), self.rx);
        let Executor { sequencer, transceiver, .. } = &self.executor;
        sequencer.deadline().min(transceiver.deadline()).min(gap).min(receiver)
    }

    /// Number of cycles without change while the line keeps its level; `None` without a limit.
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        match self.deadline() {
            Instant::NEVER => None,
            deadline => Some(deadline - self.now),
        }
    }

    /// Skips cycles without change, at most [`Self::cycles_until_event`].
    pub fn advance(&mut self, cycles: Cycles) {
        let target = Instant(self.now.0.saturating_add(cycles.0));
        self.now = target.min(self.deadline());
    }

    /// Runs up to cycle `until` with the line at `line`; with [`Instant::NEVER`], until nothing can change any more
    /// ([`Self::last_active`] then returns the last change). Stops early when the sink pauses.
    pub fn run(&mut self, line: bool, until: Instant, sink: &mut impl Sink) {
        while self.now < until && !sink.is_paused() {
            if line == self.line {
                let next = self.deadline();
                if next >= until {
                    if until != Instant::NEVER {
                        self.now = until;
                    }
                    return;
                }
                self.now = next;
            }
            self.clock(line, sink);
        }
    }

    /// The last cycle in which something could change.
    pub const fn last_active(&self) -> Instant {
        self.last_active
    }

    /// Makes `now` the next cycle if nothing can change any more; else does nothing.
    pub fn finish(&mut self, now: Instant) {
        if self.is_idle() {
            self.now = now;
        }
    }

    /// Whether nothing can change any more while the line keeps its level.
    pub fn is_idle(&self) -> bool {
        self.deadline() == Instant::NEVER
    }
}
