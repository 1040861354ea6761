//! The motion peripheral, to the clock cycle (DESIGN A2 to A7).
//!
//! A synchronous machine: [`Device::clock`] advances it one cycle. Because that is slow,
//! [`Device::cycles_until_event`] tells for how many cycles nothing can change while the line keeps its level,
//! and [`Device::advance`] passes them; [`Device::run`] does both as fast as it can, and
//! [`Device::run_bytes`] passes whole bytes. All give the same trace.
//!
//! # The order within one cycle
//! 1. EN, TX and DE change, and the line's level is heard (high while DE is);
//! 2. the sequencer: STEP edges, a tick ends, a tick starts (from commits of earlier cycles);
//! 3. the gap timer;
//! 4. the byte delivered in this cycle and what it completes;
//! 5. the record, if a signal changed;
//! 6. what firmware reads and writes ([`Device::read`], [`Device::write`]).
//!
//! So a place freed by a tick that starts in cycle p is free for the packet that ends in p, and a
//! byte delivered in the very cycle of a gap begins a new packet. This is the one place where the order is written down;
//! `tests` has a case for each two of these that can fall into one cycle, which another order would fail.
//!
//! ```
//! use stepscope_peripheral::{
//!     config::{Bus, Config, SerialLine},
//!     device::Device,
//!     trace::Digest,
//!     units::Instant,
//! };
//!
//! let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
//! // The same 3000 cycles with the line idle, one by one and at once.
//! let (mut slow, mut slow_digest) = (Device::new(&config), Digest::default());
//! (0..3000).for_each(|_| drop(slow.clock(true, &mut slow_digest)));
//! let (mut fast, mut fast_digest) = (Device::new(&config), Digest::default());
//! fast.run(true, Instant(3000), &mut fast_digest);
//! assert_eq!(slow_digest.value(), fast_digest.value());
//! ```

mod controller;
mod fast;
mod faults;
mod latches;
mod machine;
mod model_bus;
mod plan;
mod registers;
mod segments;
mod self_test;
mod sequencer;
mod transceiver;

#[cfg(test)]
mod tests;

pub use faults::Faults;
pub use model_bus::ModelBus;
pub use segments::SegmentEngine;
pub use self_test::SelfTest;

use crate::{
    config::{Config, Protocol},
    protocol::{Reason, Status},
    signal::{Event, Levels, MAX_CHANNELS, PacketOutcome, Record, Sink},
    units::Instant,
    wire::{
        packet::{Tick, Unpacked, Unpacker},
        uart::{Receiver, RxEvent},
    },
};
use controller::Controller;
use latches::Latches;
use machine::Machine;

/// The peripheral.
///
/// ```
/// use stepscope_peripheral::{
///     config::{Bus, Config, SerialLine},
///     device::Device,
///     signal::{Levels, Record},
/// };
///
/// let bus = Bus { channels: 2, slots: 4, ..Bus::default() };
/// let config = Config::new(16_000_000, &bus, &SerialLine::default()).expect("the defaults hold");
/// let mut device = Device::new(&config);
/// let mut trace: Vec<Record> = Vec::new();
/// assert_eq!(device.clock(true, &mut trace), Levels::RESET);
/// ```
#[derive(Clone, Debug)]
pub struct Device {
    /// The cycle that the next call of `clock` is, and the one that was run last.
    now: Instant,
    last: Instant,
    /// Next cycle in which something other than line, receiver and sequencer falls due: reset, the cycle after what firmware or a
    /// plant did, a gap on a raw line, a signal of the transceiver on a framed one. (On a raw line the transceiver moves EN alone,
    /// and that in the cycle after firmware's order.) Only a cycle that is clocked by itself moves it on, and the
    /// look at a stop bit in [`Self::run_bytes`].
    ///
    /// Invariant: no cycle is run past it.
    other: Instant,
    /// The line as others drive it, and as the controller hears it.
    line: bool,
    rx: bool,
    /// Levels in the last record.
    levels: Levels,
    receiver: Receiver,
    framing: Framing,
    machine: Machine,
    latches: Latches,
}

/// How bytes are joined to commands.
#[derive(Clone, Debug)]
enum Framing {
    Raw(Unpacker),
    Framed(Controller),
}

impl Device {
    /// A peripheral before cycle 0.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        Self {
            now: Instant::RESET,
            last: Instant::RESET,
            other: Instant::RESET,
            line: true,
            rx: true,
            levels: Levels(0),
            receiver: Receiver::new(config.bit()),
            framing: match config.protocol {
                Protocol::Raw => Framing::Raw(Unpacker::new(config.channels, config.address, config.bit())),
                Protocol::Framed => Framing::Framed(Controller::new(config)),
            },
            machine: Machine::new(config),
            latches: Latches::new(config),
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
        self.machine.sequencer.positions()
    }

    /// Ticks that have ended.
    #[must_use]
    pub const fn ticks_done(&self) -> u32 {
        self.machine.sequencer.ticks_done()
    }

    /// Faults so far.
    #[must_use]
    pub const fn faults(&self) -> Faults {
        self.machine.faults()
    }

    /// Advances one cycle with the line at `line`, as others drive it, and gives the levels of all
    /// signals in it. Cycle 0 is reset: the line is high in it, whatever is given.
    pub fn clock(&mut self, line: bool, sink: &mut impl Sink) -> Levels {
        let now = self.now;
        debug_assert!(now <= self.other, "{:?} was left out", self.other);
        // In reset the line is high, whatever is given, and a low in the next cycle is an edge.
        self.line = line || now == Instant::RESET;
        self.machine.transceiver.clock(now);
        let deaf = now == Instant::RESET || self.machine.transceiver.levels() & Levels::DE != 0;
        let rx = line || deaf;
        let before = core::mem::replace(&mut self.rx, rx);
        self.machine.sequencer.clock(now, sink);
        if let Framing::Raw(unpacker) = &mut self.framing
            && now == unpacker.deadline()
        {
            let short = unpacker.gap();
            sink.event(now, Event::Gap { short });
            if short {
                self.machine.fault(Faults::SHORT_PACKET);
            }
        }
        match self.receiver.clock(now, before, rx) {
            Some(RxEvent::Byte(byte)) => self.byte_alone(byte, sink),
            Some(RxEvent::FramingError) => {
                self.machine.fault(Faults::FRAMING);
                let drops = if let Framing::Raw(unpacker) = &mut self.framing {
                    unpacker.framing_error(now);
                    true
                } else {
                    false
                };
                sink.event(now, Event::FramingError { seen: self.receiver.seen(), drops });
            }
            None => {}
        }
        (self.now, self.last) = (now.next(), now);
        self.other = self.deadline_of_others();
        let levels = Levels(self.base() | u64::from(self.machine.sequencer.lines()));
        if levels != self.levels {
            self.levels = levels;
            sink.record(Record { cycle: now, levels });
        }
        levels
    }

    /// [`Self::other`] after a cycle.
    #[inline(always)]
    fn deadline_of_others(&self) -> Instant {
        match &self.framing {
            Framing::Raw(unpacker) => unpacker.deadline(),
            Framing::Framed(_) => self.machine.transceiver.deadline(),
        }
    }

    /// [`Self::byte`] apart from [`Self::clock`], which then needs no memory of its own in wasm: making room for it takes as long as
    /// a cycle in which nothing happens.
    #[inline(never)]
    fn byte_alone(&mut self, byte: u8, sink: &mut impl Sink) {
        self.byte(byte, sink);
    }

    #[inline(always)]
    fn byte(&mut self, byte: u8, sink: &mut impl Sink) {
        sink.event(self.now, Event::Byte { seen: self.receiver.seen(), byte });
        let unpacked = match &mut self.framing {
            Framing::Raw(unpacker) => unpacker.byte(self.now, byte),
            Framing::Framed(controller) => return controller.byte(self.now, byte, &mut self.machine, sink),
        };
        if let Some(unpacked) = unpacked {
            let outcome = match unpacked {
                Unpacked::OtherAddress => PacketOutcome::OtherAddress,
                Unpacked::Own(tick) => self.commit(tick),
            };
            sink.event(self.now, Event::Packet(outcome));
        }
    }

    /// Judges a packet for this controller (A5).
    fn commit(&mut self, tick: Tick) -> PacketOutcome {
        match self.machine.admit(self.now, &tick, 1) {
            Ok(()) => {
                self.machine.sequencer.push(self.now, tick);
                PacketOutcome::Queued
            }
            Err(Reason::Stopped) => PacketOutcome::Stopped,
            Err(Reason::TooManySteps) => PacketOutcome::TooManySteps,
            Err(Reason::QueueFull) => PacketOutcome::QueueFull,
            Err(_) => PacketOutcome::Booting,
        }
    }

    /// What the controller would tell of itself in the cycle that was run last (A6); `None` on a raw
    /// line.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        match &self.framing {
            Framing::Framed(controller) => {
                Some(self.machine.status(self.before(), controller.expected_seq()))
            }
            Framing::Raw(_) => None,
        }
    }

    /// The cycle before [`Self::now`]; before reset, reset.
    const fn before(&self) -> Instant {
        Instant(self.now.0.saturating_sub(1))
    }

    /// Signals that do not come from the sequencer.
    const fn base(&self) -> u64 {
        self.machine.transceiver.levels() | if self.rx { Levels::RX } else { 0 }
    }

    /// Whether it ever drives the line.
    #[must_use]
    pub const fn answers(&self) -> bool {
        matches!(self.framing, Framing::Framed(_))
    }

    /// What this controller does to the line in cycle [`Self::now`]: its TX where it drives, `None`
    /// where it does not. Its transceiver enters that cycle, as it does first when the cycle is run.
    #[must_use]
    pub fn driven(&mut self) -> Option<bool> {
        self.machine.transceiver.clock(self.now);
        let levels = Levels(self.machine.transceiver.levels());
        levels.has(Levels::DE).then(|| levels.has(Levels::TX))
    }

    /// A cycle after [`Self::now`] up to which this controller does not change what it does to the
    /// line, while others keep the line at `line`; [`Instant::NEVER`] if it will not. Its transceiver enters cycle
    /// [`Self::now`], too.
    #[must_use]
    pub fn next_driven(&mut self, line: bool) -> Instant {
        if !self.answers() {
            return Instant::NEVER;
        }
        let drives = self.driven().is_some();
        let heard = self.receiver.deadline(self.before(), line || drives);
        // What it may hear then can be answered no sooner than after the turnaround.
        let transceiver = &self.machine.transceiver;
        let answer = if heard == Instant::NEVER { heard } else { heard + transceiver.turnaround() };
        transceiver.deadline().min(answer)
    }
}
