//! The motion peripheral with clock-cycle accuracy (DESIGN A2 to A7).
//!
//! [`Device::clock`] runs one cycle; [`Device::run`] skips cycles without change. Both give the same trace.
//!
//! # Order within one cycle
//! 1. EN, TX and DE change; the receiver samples the line (high while DE is);
//! 2. the sequencer: STEP edges, a tick ends, a tick starts (from commits of earlier cycles);
//! 3. the gap timer;
//! 4. the byte delivered in this cycle and its effect;
//! 5. the record, if a signal changed;
//! 6. firmware reads and writes ([`Device::read`], [`Device::write`]).
//!
//! ```
//! use stepscope_peripheral::{config::{Bus, Config, SerialLine}, device::Device, trace::Digest, units::Instant};
//!
//! let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
//! // 3000 cycles with the line idle, one by one and at once.
//! let (mut slow, mut slow_digest) = (Device::new(&config), Digest::default());
//! (0..3000).for_each(|_| drop(slow.clock(true, &mut slow_digest)));
//! let (mut fast, mut fast_digest) = (Device::new(&config), Digest::default());
//! fast.run(true, Instant(3000), &mut fast_digest);
//! assert_eq!(slow_digest.value(), fast_digest.value());
//! ```

mod executor;
mod fast;
mod faults;
mod framed;
mod latches;
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
pub use self_test::{SelfTest, min_boot_time};

use crate::config::{Config, Protocol};
use crate::protocol::{Reason, Status};
use crate::signal::{Event, Levels, PacketOutcome, Record, Sink};
use crate::units::Instant;
use crate::wire::packet::{Tick, Unpacked, Unpacker};
use crate::wire::uart::{Receiver, RxEvent};
use executor::Executor;
use framed::FramedProtocol;
use latches::Latches;

/// The peripheral, driven by frames, raw packets or registers.
#[derive(Clone, Debug)]
pub struct Device {
    now: Instant,
    last_active: Instant,
    line: bool,
    /// The line as the receiver samples it: high while this controller drives it.
    rx: bool,
    levels: Levels,
    receiver: Receiver,
    framing: Framing,
    executor: Executor,
    latches: Latches,
}

#[derive(Clone, Debug)]
enum Framing {
    Raw(Unpacker),
    Framed(FramedProtocol),
}

impl Device {
    /// A peripheral before cycle 0.
    pub fn new(config: &Config) -> Self {
        Self {
            now: Instant::RESET,
            last_active: Instant::RESET,
            line: true,
            rx: true,
            levels: Levels(0),
            receiver: Receiver::new(config.bit()),
            framing: match config.protocol() {
                Protocol::Raw => Framing::Raw(Unpacker::new(config)),
                Protocol::Framed => Framing::Framed(FramedProtocol::new(config)),
            },
            executor: Executor::new(config),
            latches: Latches::new(config),
        }
    }

    /// The next cycle to run.
    pub const fn now(&self) -> Instant {
        self.now
    }

    /// Levels of all signals in the last cycle that was run; before cycle 0 all are low.
    pub const fn levels(&self) -> Levels {
        self.levels
    }

    /// Position counters of the channels in use: +1 per rising STEP edge with DIR 1, -1 with DIR 0.
    pub fn positions(&self) -> &[i32] {
        let channels = usize::from(self.latches.config.channels());
        self.executor.sequencer.positions().get(..channels).unwrap_or_default()
    }

    /// Ticks done, wrapping.
    pub const fn ticks_done(&self) -> u32 {
        self.executor.sequencer.ticks_done()
    }

    pub const fn faults(&self) -> Faults {
        self.executor.faults()
    }

    /// Runs one cycle with the line at `line`, as others drive it, and returns the levels of all signals in it.
    /// In cycle 0, reset, the line counts as high.
    pub fn clock(&mut self, line: bool, sink: &mut impl Sink) -> Levels {
        let now = self.now;
        debug_assert!(now <= self.deadline(), "{:?} was skipped", self.deadline());
        self.line = line || now == Instant::RESET;
        self.executor.transceiver.clock(now);
        self.rx = self.line || self.executor.transceiver.drives();
        self.executor.sequencer.clock(now, sink);
        if let Framing::Raw(unpacker) = &mut self.framing
            && now == unpacker.deadline()
        {
            let cuts_packet = unpacker.gap();
            sink.event(now, Event::Gap { cuts_packet });
            if cuts_packet {
                self.executor.fault(Faults::SHORT_PACKET);
            }
        }
        match self.receiver.clock(now, self.rx) {
            Some(RxEvent::Byte(byte)) => self.byte(byte, sink),
            Some(RxEvent::FramingError) => {
                self.executor.fault(Faults::FRAMING);
                let is_dropping = if let Framing::Raw(unpacker) = &mut self.framing {
                    unpacker.framing_error(now);
                    true
                } else {
                    false
                };
                sink.event(now, Event::FramingError { start: self.receiver.start(), is_dropping });
            }
            None => {}
        }
        (self.now, self.last_active) = (now.next(), now);
        let levels = self.current_levels();
        if levels != self.levels {
            self.levels = levels;
            sink.record(Record { cycle: now, levels });
        }
        levels
    }

    fn current_levels(&self) -> Levels {
        let rx = if self.rx { Levels::RX } else { 0 };
        Levels(self.executor.transceiver.levels() | rx | u64::from(self.executor.sequencer.lines()))
    }

    fn byte(&mut self, byte: u8, sink: &mut impl Sink) {
        let now = self.now;
        sink.event(now, Event::Byte { start: self.receiver.start(), byte });
        let outcome = match &mut self.framing {
            Framing::Framed(protocol) => return protocol.byte(now, byte, &mut self.executor, sink),
            Framing::Raw(unpacker) => match unpacker.byte(now, byte) {
                None => return,
                Some(Unpacked::OtherAddress) => PacketOutcome::OtherAddress,
                Some(Unpacked::Own(tick)) => self.commit(tick),
            },
        };
        sink.event(now, Event::Packet(outcome));
    }

    fn commit(&mut self, tick: Tick) -> PacketOutcome {
        match self.executor.admit(self.now, &tick, 1) {
            Ok(()) => {
                self.executor.sequencer.push(self.now, tick);
                PacketOutcome::Queued
            }
            Err(Reason::Stopped) => PacketOutcome::Stopped,
            Err(Reason::TooManySteps) => PacketOutcome::TooManySteps,
            Err(Reason::QueueFull) => PacketOutcome::QueueFull,
            Err(_) => PacketOutcome::Booting,
        }
    }

    /// The status that a reply in the last cycle would contain; `None` on a raw line.
    pub fn status(&self) -> Option<Status> {
        match &self.framing {
            Framing::Framed(protocol) => {
                Some(self.executor.status(self.last_cycle(), protocol.expected_seq()))
            }
            Framing::Raw(_) => None,
        }
    }

    const fn last_cycle(&self) -> Instant {
        Instant(self.now.0.saturating_sub(1))
    }

    const fn replies(&self) -> bool {
        matches!(self.framing, Framing::Framed(_))
    }

    /// TX in cycle [`Self::now`] if this controller drives the line in it, else `None`.
    pub fn driven(&self) -> Option<bool> {
        let (levels, _) = self.executor.transceiver.in_cycle(self.now);
        levels.has(Levels::DE).then(|| levels.has(Levels::TX))
    }

    /// A cycle up to which this controller drives the line as in [`Self::now`] while others keep it at `line`;
    /// [`Instant::NEVER`] if it never changes.
    pub fn next_driven(&self, line: bool) -> Instant {
        if !self.replies() {
            return Instant::NEVER;
        }
        let transceiver = &self.executor.transceiver;
        let (levels, next) = transceiver.in_cycle(self.now);
        let byte = self.receiver.deadline(self.last_cycle(), line || levels.has(Levels::DE));
        // A byte causes a reply after the turnaround at the earliest.
        let reply = if byte == Instant::NEVER { byte } else { byte + transceiver.turnaround() };
        next.min(reply)
    }
}
