//! The controller's side of the framed protocol (DESIGN A6): which frame does what, in which order
//! it is judged, and what is answered.

use crate::device::{Faults, machine::Machine};
use crate::{
    config::Config,
    protocol::{FrameOutcome, Kind, Reason, Reply},
    signal::{Event, Positions, Sink},
    units::Instant,
    wire::{
        frame::{Completed, Deframed, Deframer, Frame, Ticks},
        packet::ALL,
    },
};

/// What a controller of the framed protocol remembers.
#[derive(Clone, Debug)]
pub(super) struct Controller {
    address: u8,
    channels: u8,
    deframer: Deframer,
    expected_seq: u8,
    /// Whether a TICKS was taken since reset or RESYNC: then the one before the expected is a repeat.
    taken: bool,
}

impl Controller {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            // A framed line's configuration always has one.
            address: config.address.unwrap_or(0),
            channels: config.channels,
            deframer: Deframer::default(),
            expected_seq: 0,
            taken: false,
        }
    }

    /// Sequence number that the next TICKS must have.
    pub(super) const fn expected_seq(&self) -> u8 {
        self.expected_seq
    }

    /// A byte delivered in cycle `now`.
    #[inline(always)]
    pub(super) fn byte(&mut self, now: Instant, byte: u8, machine: &mut Machine, sink: &mut impl Sink) {
        let completed = self.deframer.take(byte);
        if completed != Completed::Nothing {
            self.complete(now, completed, machine, sink);
        }
    }

    /// What a byte completed in cycle `now`.
    #[inline(never)]
    fn complete(&mut self, now: Instant, completed: Completed, machine: &mut Machine, sink: &mut impl Sink) {
        let mut answered = false;
        let outcome = match self.deframer.deframed(completed) {
            None => return,
            Some(Deframed::Short) => {
                machine.fault(Faults::SHORT_PACKET);
                FrameOutcome::Short
            }
            Some(Deframed::BadCrc { found, expected }) => {
                machine.fault(Faults::CRC);
                FrameOutcome::BadCrc { found, expected }
            }
            Some(Deframed::Overlong) => {
                machine.fault(Faults::OVERLONG);
                FrameOutcome::Overlong
            }
            Some(Deframed::Frame(frame)) if frame.address != self.address && frame.address != ALL => {
                FrameOutcome::OtherAddress
            }
            Some(Deframed::Frame(frame)) => {
                answered = frame.address != ALL;
                let Self { channels, expected_seq, taken, .. } = self;
                Execution { now, channels: *channels, expected_seq, taken, machine }.frame(frame)
            }
        };
        sink.event(now, Event::Frame(outcome));
        if let Some(answer) = outcome.answer().filter(|_| answered) {
            let status = machine.status(now, self.expected_seq);
            let reply = Reply { address: self.address, answer, status };
            let positions = if answer == Ok(Kind::Positions) { self.positions(machine) } else { None };
            let (start, end) = machine.transceiver.reply(now, &reply.emit(positions.as_ref()));
            sink.event(now, Event::Reply { start, end, reply, positions });
        }
    }

    /// The position counters as they stand in this cycle: the sequencer's part of it is over.
    fn positions(&self, machine: &Machine) -> Option<Positions> {
        Positions::new(machine.sequencer.positions().get(..self.channels.into())?)
    }
}

/// The execution of one frame.
struct Execution<'a> {
    now: Instant,
    channels: u8,
    expected_seq: &'a mut u8,
    taken: &'a mut bool,
    machine: &'a mut Machine,
}

impl Execution<'_> {
    fn frame(&mut self, frame: Frame<'_>) -> FrameOutcome {
        let Some(kind) = Kind::parse(frame.kind) else { return FrameOutcome::Refused(Reason::UnknownKind) };
        if kind == Kind::Ticks {
            return self.ticks(frame.body);
        }
        if !frame.body.is_empty() {
            return FrameOutcome::Refused(Reason::BadBody);
        }
        match kind {
            Kind::Enable => self.machine.enable(self.now),
            Kind::Disable if !self.machine.disable(self.now) => return FrameOutcome::Refused(Reason::Busy),
            Kind::Stop => self.machine.stop(self.now),
            Kind::Resync => {
                (*self.expected_seq, *self.taken) = (0, false);
                self.machine.clear_faults(Faults::ALL);
            }
            Kind::Ticks | Kind::Disable | Kind::Status | Kind::Positions => {}
        }
        FrameOutcome::Taken(kind)
    }

    fn ticks(&mut self, body: &[u8]) -> FrameOutcome {
        let Some(ticks) = Ticks::parse(body, self.channels) else {
            return FrameOutcome::Refused(Reason::BadBody);
        };
        if *self.taken && ticks.seq == self.expected_seq.wrapping_sub(1) {
            return FrameOutcome::Repeated;
        }
        if ticks.seq != *self.expected_seq {
            self.machine.fault(Faults::BAD_SEQ);
            return FrameOutcome::Refused(Reason::BadSeq);
        }
        if let Err(reason) = self.machine.admit(self.now, ticks.orders(), ticks.count()) {
            return FrameOutcome::Refused(reason);
        }
        for tick in ticks.iter() {
            self.machine.sequencer.push(self.now, tick);
        }
        (*self.expected_seq, *self.taken) = (self.expected_seq.wrapping_add(1), true);
        FrameOutcome::Queued(ticks.count() as u8)
    }
}
