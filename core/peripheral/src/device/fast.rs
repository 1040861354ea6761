//! The fast speed (DESIGN A2): for how many cycles nothing can change, and passing them.
//!
//! ```text
//! cycle    0 1 2 3 4 5 6 7 8 9 …     clock runs every cycle. run clocks those in which the line is heard, a gap
//! clock    * * * * * * * * * * *     falls due or a signal of the transceiver changes; between two of them the
//! run      * * o . . o . * . . o     sequencer goes from edge to edge (o), and nothing happens in the others (.)
//! ```
//!
//! Of the cycles in which the line is heard most are edges within a byte, which change RX alone: these take a short cut
//! ([`Device::hear`]).
//!
//! All give the same trace, for every configuration and every line.

use crate::{
    device::Device,
    signal::{Levels, Record, Sink},
    units::{Cycles, Instant},
};

impl Device {
    /// Next cycle, from [`Self::now`] on, in which something can change if the line stays at the
    /// level of the last cycle.
    fn deadline(&self) -> Instant {
        self.machine.sequencer.deadline().min(self.input_deadline())
    }

    #[inline(always)]
    fn input_deadline(&self) -> Instant {
        self.receiver.deadline(self.before(), self.rx).min(self.other)
    }

    /// For how many cycles nothing can change while the line stays at the level of the last cycle;
    /// `None` if it is for ever.
    #[must_use]
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        match self.deadline() {
            Instant::NEVER => None,
            deadline => Some(deadline - self.now),
        }
    }

    /// Passes cycles in which nothing changes: no more than [`Self::cycles_until_event`] says. What goes beyond
    /// is not skipped.
    pub fn advance(&mut self, cycles: Cycles) {
        let target = Instant(self.now.0.saturating_add(cycles.0));
        self.now = target.min(self.deadline());
    }

    /// Runs until cycle `until` is the next, as fast as the edges allow, while the line stays at
    /// `line`; with [`Instant::NEVER`], until nothing can change any more ([`Self::last_active`] then
    /// tells when that was). Stops early where the sink asks for a pause.
    #[inline(always)]
    pub fn run(&mut self, line: bool, until: Instant, sink: &mut impl Sink) {
        let mut heard = None;
        if self.now < until && line != self.line {
            heard = self.hear(line, sink);
            if heard.is_none() {
                self.clock(line, sink);
                // A line that is low in reset falls after it.
                if self.now < until && line != self.line {
                    self.clock(line, sink);
                }
            }
        }
        let mut input = heard.unwrap_or_else(|| self.input_deadline());
        while self.now < until && !sink.paused() {
            let quiet = input.min(until);
            if self.machine.sequencer.deadline() < quiet {
                self.levels = self.machine.sequencer.run(quiet, self.base(), sink);
                if self.machine.sequencer.deadline() < quiet {
                    // Paused: nothing happens before the sequencer's next change.
                    self.now = self.machine.sequencer.deadline();
                    return;
                }
            }
            if quiet == Instant::NEVER {
                return;
            }
            self.now = quiet;
            if quiet < until {
                self.clock(line, sink);
                input = self.input_deadline();
            }
        }
    }

    /// [`Self::clock`] in a cycle in which the line changes, and nothing else falls due: most edges of a byte are such. Gives
    /// [`Self::input_deadline`] then; `None`, and nothing is done, where more falls due or the controller drives the line.
    #[inline(always)]
    fn hear(&mut self, line: bool, sink: &mut impl Sink) -> Option<Instant> {
        let now = self.now;
        let deaf = self.machine.transceiver.levels() & Levels::DE != 0;
        if now == self.other || now == self.machine.sequencer.deadline() || deaf {
            return None;
        }
        debug_assert!(self.rx != line, "the line has changed before {now:?}");
        let deadline = self.receiver.hear(now, self.rx, line)?;
        (self.line, self.rx) = (line, line);
        (self.now, self.last) = (now.next(), now);
        self.levels.0 ^= Levels::RX;
        sink.record(Record { cycle: now, levels: self.levels });
        Some(deadline.min(self.other))
    }

    /// The last cycle in which something happened, if every cycle that was clocked by itself had a
    /// reason.
    #[must_use]
    pub fn last_active(&self) -> Instant {
        self.last.max(self.machine.sequencer.last_active())
    }

    /// At rest: the cycle that the next call of [`Self::clock`] is becomes `now`. Otherwise nothing.
    pub fn finish(&mut self, now: Instant) {
        if self.at_rest() {
            self.now = now;
        }
    }

    /// Whether nothing can change any more while the line stays as it is.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.deadline() == Instant::NEVER
    }
}
