//! The controller's side of the framed protocol (DESIGN A6): the effect of each frame, and its reply.

use crate::device::{Faults, executor::Executor};
use crate::protocol::{FrameOutcome, Kind, Reason, Reply};
use crate::signal::{Event, Positions, Sink};
use crate::wire::frame::{Deframed, Deframer, Frame, Ticks};
use crate::wire::packet::ALL;
use crate::{config::Config, units::Instant};

#[derive(Clone, Debug)]
pub(super) struct FramedProtocol {
    address: u8,
    channels: u8,
    deframer: Deframer,
    expected_seq: u8,
    /// A TICKS frame was accepted since reset or RESYNC; a frame with its sequence number is a repetition.
    has_accepted: bool,
}

impl FramedProtocol {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            address: config.address().unwrap_or(0),
            channels: config.channels(),
            deframer: Deframer::default(),
            expected_seq: 0,
            has_accepted: false,
        }
    }

    pub(super) const fn expected_seq(&self) -> u8 {
        self.expected_seq
    }

    /// Takes a byte in cycle `now`, executes the frame that it completes, and schedules the reply.
    pub(super) fn byte(&mut self, now: Instant, byte: u8, executor: &mut Executor, sink: &mut impl Sink) {
        let Self { address, channels, deframer, expected_seq, has_accepted } = self;
        let (address, channels) = (*address, *channels);
        let mut is_own = false;
        let outcome = match deframer.byte(byte) {
            None => return,
            Some(Deframed::Short) => {
                executor.fault(Faults::SHORT_PACKET);
                FrameOutcome::Short
            }
            Some(Deframed::BadCrc { found, expected }) => {
                executor.fault(Faults::CRC);
                FrameOutcome::BadCrc { found, expected }
            }
            Some(Deframed::Overlong) => {
                executor.fault(Faults::OVERLONG);
                FrameOutcome::Overlong
            }
            Some(Deframed::Frame(frame)) if frame.address != address && frame.address != ALL => {
                FrameOutcome::OtherAddress
            }
            Some(Deframed::Frame(frame)) => {
                is_own = frame.address != ALL;
                Execution { now, channels, expected_seq, has_accepted, executor }.frame(frame)
            }
        };
        sink.event(now, Event::Frame(outcome));
        if let Some(result) = outcome.reply_result().filter(|_| is_own) {
            let reply = Reply { address, result, status: executor.status(now, *expected_seq) };
            // Positions at the end of this cycle: the sequencer runs before the byte.
            let positions = executor.sequencer.positions();
            let positions = positions.get(..usize::from(channels)).filter(|_| result == Ok(Kind::Positions));
            let positions = positions.and_then(Positions::new);
            let (start, end) = executor.transceiver.reply(now, &reply.emit(positions.as_ref()));
            sink.event(now, Event::Reply { start, end, reply, positions });
        }
    }
}

struct Execution<'a> {
    now: Instant,
    channels: u8,
    expected_seq: &'a mut u8,
    has_accepted: &'a mut bool,
    executor: &'a mut Executor,
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
            Kind::Enable => self.executor.enable(self.now),
            Kind::Disable if !self.executor.disable(self.now) => return FrameOutcome::Refused(Reason::Busy),
            Kind::Stop => self.executor.stop(self.now),
            Kind::Resync => {
                (*self.expected_seq, *self.has_accepted) = (0, false);
                self.executor.clear_faults(Faults::ALL);
            }
            Kind::Ticks | Kind::Disable | Kind::Status | Kind::Positions => {}
        }
        FrameOutcome::Executed(kind)
    }

    fn ticks(&mut self, body: &[u8]) -> FrameOutcome {
        let Some(ticks) = Ticks::parse(body, self.channels) else {
            return FrameOutcome::Refused(Reason::BadBody);
        };
        if *self.has_accepted && ticks.seq == self.expected_seq.wrapping_sub(1) {
            return FrameOutcome::Repeated;
        }
        if ticks.seq != *self.expected_seq {
            self.executor.fault(Faults::BAD_SEQ);
            return FrameOutcome::Refused(Reason::BadSeq);
        }
        if let Err(reason) = self.executor.admit(self.now, ticks.commands(), ticks.count()) {
            return FrameOutcome::Refused(reason);
        }
        for tick in ticks.iter() {
            self.executor.sequencer.push(self.now, tick);
        }
        (*self.expected_seq, *self.has_accepted) = (self.expected_seq.wrapping_add(1), true);
        FrameOutcome::Queued(ticks.count() as u8)
    }
}
