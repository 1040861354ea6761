//! The motion peripheral, to the clock cycle (DESIGN A2 to A7).
//!
//! A synchronous machine: [`Device::clock`] advances it one cycle. Because that is slow,
//! [`Device::quiet`] tells for how many cycles nothing can change while the line keeps its level,
//! and [`Device::skip`] passes them; [`Device::run`] does both as fast as it can. All three give
//! the same trace.
//!
//! # The order within one cycle
//! 1. the line's level is heard;
//! 2. the sequencer: STEP edges, a tick ends, a tick starts (from commits of earlier cycles);
//! 3. the gap timer;
//! 4. the byte delivered in this cycle and what it completes;
//! 5. the record, if a signal changed.
//!
//! So a place freed by a tick that starts in cycle p is free for the packet that ends in p, and a
//! byte delivered in the very cycle of a gap begins a new packet.

mod faults;
mod plan;
mod segments;
mod sequencer;

pub use faults::Faults;
pub use segments::SegmentEngine;

use crate::{
    scenario::Config,
    signal::{Event, Fate, Levels, MAX_CHANNELS, Record, Sink},
    units::{Cycles, Instant},
    wire::{
        Line,
        packet::{Order, Tick, Unpacked, Unpacker},
        uart::{Heard, Receiver},
    },
};
use sequencer::Sequencer;

/// The peripheral.
///
/// ```
/// use stepscope_core::{device::Device, scenario::{Bus, Config, Line}, signal::{Levels, Record}};
///
/// let bus = Bus { channels: 2, slots: 4, ..Bus::default() };
/// let config = Config::new(16_000_000, &bus, &Line::default()).expect("the defaults hold");
/// let mut device = Device::new(&config);
/// let mut trace: Vec<Record> = Vec::new();
/// assert_eq!(device.clock(true, &mut trace), Levels::RESET);
/// ```
#[derive(Clone, Debug)]
pub struct Device {
    slots: u8,
    boot: Instant,
    /// The cycle that the next call of `clock` is.
    now: Instant,
    rx: bool,
    /// Levels in the last record.
    levels: Levels,
    receiver: Receiver,
    unpacker: Unpacker,
    sequencer: Sequencer,
    faults: Faults,
}

impl Device {
    /// A peripheral before cycle 0.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        Self {
            slots: config.slots,
            boot: config.boot,
            now: Instant::RESET,
            rx: true,
            levels: Levels(0),
            receiver: Receiver::new(config.bit()),
            unpacker: Unpacker::new(config.channels, config.address, config.bit()),
            sequencer: Sequencer::new(config),
            faults: Faults::default(),
        }
    }

    /// The cycle that the next call of [`Self::clock`] is; as many have passed.
    #[must_use]
    pub const fn now(&self) -> Instant {
        self.now
    }

    /// Position counters: rising STEP edges, +1 where DIR is 1, -1 where it is 0.
    #[must_use]
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        self.sequencer.positions()
    }

    /// Ticks that have ended.
    #[must_use]
    pub const fn ticks_done(&self) -> u32 {
        self.sequencer.ticks_done()
    }

    /// Faults so far.
    #[must_use]
    pub const fn faults(&self) -> Faults {
        self.faults
    }

    /// Advances one cycle with the line at `line` and gives the levels of all signals in it. Cycle
    /// 0 is reset: the line is high in it, whatever is given.
    pub fn clock(&mut self, line: bool, sink: &mut impl Sink) -> Levels {
        let now = self.now;
        let before = core::mem::replace(&mut self.rx, line || now == Instant::RESET);
        self.sequencer.clock(now, sink);
        if now == self.unpacker.deadline() {
            let short = self.unpacker.gap();
            sink.event(now, Event::Gap { short });
            if short {
                self.faults.set(Faults::SHORT_PACKET);
            }
        }
        match self.receiver.clock(now, before, self.rx) {
            Some(Heard::Byte(byte)) => self.byte(byte, sink),
            Some(Heard::FramingError) => {
                self.faults.set(Faults::FRAMING);
                self.unpacker.framing_error(now);
                sink.event(now, Event::FramingError { seen: self.receiver.seen() });
            }
            None => {}
        }
        self.now = now.next();
        let levels = Levels(self.base() | u64::from(self.sequencer.lines()));
        if levels != self.levels {
            self.levels = levels;
            sink.record(Record { cycle: now, levels });
        }
        levels
    }

    fn byte(&mut self, byte: u8, sink: &mut impl Sink) {
        sink.event(self.now, Event::Byte { seen: self.receiver.seen(), byte });
        let fate = match self.unpacker.byte(self.now, byte) {
            None => return,
            Some(Unpacked::Foreign) => Fate::Foreign,
            Some(Unpacked::Own(tick)) => self.commit(tick),
        };
        sink.event(self.now, Event::Packet(fate));
    }

    /// Judges a packet for this controller (A5). The self-test comes first: a controller that is
    /// not up judges nothing.
    fn commit(&mut self, tick: Tick) -> Fate {
        if self.now < self.boot {
            Fate::Booting
        } else if tick.iter().any(|&byte| Order::parse(byte).steps > self.slots) {
            self.faults.set(Faults::TOO_MANY_STEPS);
            Fate::TooManySteps
        } else if self.sequencer.push(self.now, tick) {
            Fate::Queued
        } else {
            self.faults.set(Faults::QUEUE_OVERFLOW);
            Fate::QueueFull
        }
    }

    /// Signals that do not come from the sequencer.
    const fn base(&self) -> u64 {
        Levels::EN | Levels::TX | if self.rx { Levels::RX } else { 0 }
    }

    /// Next cycle, from [`Self::now`] on, in which something can change if the line stays at the
    /// level of the last cycle.
    fn deadline(&self) -> Instant {
        if self.now == Instant::RESET {
            self.now
        } else {
            self.sequencer.deadline().min(self.input_deadline())
        }
    }

    #[inline(always)]
    fn input_deadline(&self) -> Instant {
        let last = Instant(self.now.0.saturating_sub(1));
        self.receiver.deadline(last, self.rx).min(self.unpacker.deadline())
    }

    /// For how many cycles nothing can change while the line stays at the level of the last cycle;
    /// `None` if it is for ever.
    #[must_use]
    pub fn quiet(&self) -> Option<Cycles> {
        match self.deadline() {
            Instant::NEVER => None,
            deadline => Some(deadline - self.now),
        }
    }

    /// Passes cycles in which nothing changes: no more than [`Self::quiet`] says. What goes beyond
    /// is not skipped.
    pub fn skip(&mut self, cycles: Cycles) {
        let target = Instant(self.now.0.saturating_add(cycles.0));
        self.now = target.min(self.deadline());
    }

    /// Runs until cycle `until` is the next, as fast as the edges allow; with [`Instant::NEVER`],
    /// until nothing can change any more: then the last cycle run is the last in which something
    /// did. Stops early where the sink asks for a pause.
    pub fn run(&mut self, line: &mut Line, until: Instant, sink: &mut impl Sink) {
        if self.now == Instant::RESET && self.now < until {
            self.clock(line.level(), sink);
        }
        while self.now < until && !sink.paused() {
            let quiet = self.input_deadline().min(line.next_change()).min(until);
            if self.sequencer.deadline() < quiet {
                self.levels = self.sequencer.run(quiet, self.base(), sink);
                if self.sequencer.deadline() < quiet {
                    // Paused: nothing happens before the sequencer's next change.
                    self.now = self.sequencer.deadline();
                    return;
                }
            }
            if quiet == Instant::NEVER {
                self.now = self.now.max(self.sequencer.last_active().next());
                return;
            }
            self.now = quiet;
            if quiet < until {
                if line.next_change() == quiet {
                    line.change();
                }
                self.clock(line.level(), sink);
            }
        }
    }

    /// Whether nothing can change any more while the line stays as it is.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.deadline() == Instant::NEVER
    }
}
