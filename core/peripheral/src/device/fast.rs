//! The fast speed (DESIGN A2): for how many cycles nothing can change, and passing them.
//!
//! ```text
//! cycle    0 1 2 3 4 5 6 7 8 9 …     clock runs every cycle. run clocks those in which the line is heard, a gap
//! clock    * * * * * * * * * * *     falls due or a signal of the transceiver changes; between two of them the
//! run      * * o . . o . * . . o     sequencer goes from edge to edge (o), and nothing happens in the others (.)
//! ```
//!
//! Most bytes are heard as they are sent. Each of them is passed in one piece, with the STEP and DIR that change meanwhile
//! ([`Device::run_bytes`]), where nothing is forced on the line up to its end and no tick begins or ends beside it.
//!
//! All give the same trace, for every configuration and every line.

use crate::{
    device::Device,
    signal::{Levels, Sink},
    units::{Cycles, Instant},
    wire::{ByteAhead, Line, sender::BitStarts},
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
        // Twice where a line is low in reset: it falls after it.
        while self.now < until && line != self.line {
            self.clock(line, sink);
        }
        let mut input = self.input_deadline();
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

    /// Whether [`Self::run_bytes`] would pass a byte that comes next on the line: gives the look at its stop bit. `None` where that
    /// is not before `until`, where more than RX, STEP and DIR may change up to it, and where no byte may begin.
    #[must_use]
    #[inline(always)]
    pub fn whole_byte(&self, byte: &ByteAhead<'_>, until: Instant) -> Option<Instant> {
        let stop = self.receiver.stop_of(byte.start);
        let deaf = self.machine.transceiver.levels() & Levels::DE != 0;
        let whole = self.now <= byte.start
            && self.line
            && !deaf
            && self.receiver.is_armed()
            && stop < until.min(self.other);
        (whole && self.machine.sequencer.only_pulses(stop)).then_some(stop)
    }

    /// [`Self::run`] through the bytes of `line` that may be passed whole, each up to the look at its stop bit in one piece: whether
    /// there was any. Stops early where the sink asks for a pause. For lines on which nobody else drives before `until`, and whose
    /// bytes are heard as they are sent: [`Self::is_in_step`], which is not asked here, as it stays the same.
    pub fn run_bytes(&mut self, line: &mut Line, until: Instant, sink: &mut impl Sink) -> bool {
        debug_assert!(self.is_in_step(line.bit_starts()), "bytes are not heard as they are sent");
        let from = self.now;
        while let Some(byte) = line.byte_ahead()
            && let Some(stop) = self.whole_byte(&byte, until)
            && !sink.paused()
        {
            self.levels = self.machine.sequencer.run_beside(
                byte.start,
                byte.edges,
                byte.bit_starts,
                stop,
                self.base(),
                sink,
            );
            self.now = stop;
            if self.machine.sequencer.deadline() == stop {
                self.receiver.hear_data(&byte);
                self.clock(true, sink);
            } else {
                self.receiver.hear_byte(&byte);
                self.byte(byte.byte, sink);
                (self.now, self.last) = (stop.next(), stop);
                self.other = self.deadline_of_others();
            }
            line.pass_byte();
        }
        self.now > from
    }

    /// Whether bytes whose bits begin and end so are heard as they are sent: only they may be passed whole.
    #[must_use]
    pub fn is_in_step(&self, bit_starts: &BitStarts) -> bool {
        self.receiver.is_in_step(bit_starts)
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
