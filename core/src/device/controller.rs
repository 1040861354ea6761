//! The controller's side of the framed protocol (DESIGN A6): which frame does what, in which order
//! it is judged, and what is answered.

use super::{Faults, drive::Drive, sequencer::Sequencer};
use crate::{
    protocol::{FrameFate, Kind, Reason, Reply, State, Status},
    scenario::Config,
    signal::{Event, Sink},
    units::Instant,
    wire::{
        frame::{Deframed, Deframer, Frame, Ticks},
        packet::{ALL, Order},
    },
};

/// What a controller of the framed protocol remembers.
#[derive(Clone, Debug)]
pub(super) struct Controller {
    address: u8,
    channels: u8,
    slots: u8,
    boot: Instant,
    deframer: Deframer,
    pub(super) book: Book,
}

/// What frames change beside the signals and the queue.
#[derive(Clone, Copy, Debug)]
pub(super) struct Book {
    expected_seq: u8,
    /// Whether a TICKS was taken since reset or RESYNC: then the one before the expected is a repeat.
    taken: bool,
    stopped: bool,
}

/// The parts of the peripheral that a frame works on.
pub(super) struct Parts<'a> {
    pub(super) drive: &'a mut Drive,
    pub(super) sequencer: &'a mut Sequencer,
    pub(super) faults: &'a mut Faults,
}

impl Controller {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            address: config.address.unwrap_or(0),
            channels: config.channels,
            slots: config.slots,
            boot: config.boot,
            deframer: Deframer::default(),
            book: Book { expected_seq: 0, taken: false, stopped: false },
        }
    }

    /// A byte delivered in cycle `now`.
    pub(super) fn byte(&mut self, now: Instant, byte: u8, mut parts: Parts<'_>, sink: &mut impl Sink) {
        let Self { deframer, book, .. } = self;
        let mut answered = false;
        let fate = match deframer.byte(byte) {
            None => return,
            Some(Deframed::Short) => {
                parts.faults.set(Faults::SHORT_PACKET);
                FrameFate::Short
            }
            Some(Deframed::BadCheck { found, expected }) => {
                parts.faults.set(Faults::CRC);
                FrameFate::BadCheck { found, expected }
            }
            Some(Deframed::Overlong) => {
                parts.faults.set(Faults::OVERLONG);
                FrameFate::Overlong
            }
            Some(Deframed::Frame(frame)) if frame.address != self.address && frame.address != ALL => {
                FrameFate::Foreign
            }
            Some(Deframed::Frame(frame)) => {
                answered = frame.address != ALL;
                let judge = Judge { channels: self.channels, slots: self.slots, boot: self.boot, now };
                judge.frame(frame, book, &mut parts)
            }
        };
        sink.event(now, Event::Frame(fate));
        if let Some(answer) = fate.answer().filter(|_| answered) {
            let status = book.status(now, self.boot, parts.sequencer, *parts.faults);
            let reply = Reply { address: self.address, answer, status };
            let (start, end) = parts.drive.reply(now, &reply.emit());
            sink.event(now, Event::Reply { start, end, reply });
        }
    }

    /// What the controller would tell in cycle `now`.
    pub(super) fn status(&self, now: Instant, sequencer: &Sequencer, faults: Faults) -> Status {
        self.book.status(now, self.boot, sequencer, faults)
    }
}

impl Book {
    fn status(&self, now: Instant, boot: Instant, sequencer: &Sequencer, faults: Faults) -> Status {
        let state = if self.stopped {
            State::Stopped
        } else if now < boot {
            State::Busy
        } else if sequencer.is_moving() {
            State::Moving
        } else {
            State::Ready
        };
        Status {
            state,
            free: sequencer.free(),
            expected_seq: self.expected_seq,
            faults: faults.union(sequencer.faults()).bits(),
            ticks_done: sequencer.ticks_done(),
        }
    }

    /// Emergency stop in cycle `now`: drivers off, the queue empty, the tick that runs abandoned.
    pub(super) fn stop(&mut self, now: Instant, parts: &mut Parts<'_>) {
        parts.drive.enable(now, false);
        parts.sequencer.stop(now);
        self.stopped = true;
    }

    /// Drivers on, and out of STOPPED.
    pub(super) fn enable(&mut self, now: Instant, parts: &mut Parts<'_>) {
        parts.drive.enable(now, true);
        self.stopped = false;
    }

    /// Drivers off, if nothing moves: whether it was done.
    pub(super) fn disable(&mut self, now: Instant, parts: &mut Parts<'_>) -> bool {
        let idle = !parts.sequencer.is_moving();
        if idle {
            parts.drive.enable(now, false);
            self.stopped = true;
        }
        idle
    }
}

/// One frame's judgement.
struct Judge {
    channels: u8,
    slots: u8,
    boot: Instant,
    now: Instant,
}

impl Judge {
    fn frame(&self, frame: Frame<'_>, book: &mut Book, parts: &mut Parts<'_>) -> FrameFate {
        let Some(kind) = Kind::parse(frame.kind) else { return FrameFate::Refused(Reason::UnknownKind) };
        if kind == Kind::Ticks {
            return self.ticks(frame.body, book, parts);
        }
        if !frame.body.is_empty() {
            return FrameFate::Refused(Reason::BadBody);
        }
        match kind {
            Kind::Enable => book.enable(self.now, parts),
            Kind::Disable if !book.disable(self.now, parts) => return FrameFate::Refused(Reason::Busy),
            Kind::Stop => book.stop(self.now, parts),
            Kind::Resync => {
                (book.expected_seq, book.taken) = (0, false);
                *parts.faults = Faults::default();
                parts.sequencer.clear_faults();
            }
            Kind::Ticks | Kind::Disable | Kind::Status => {}
        }
        FrameFate::Taken(kind)
    }

    fn ticks(&self, body: &[u8], book: &mut Book, parts: &mut Parts<'_>) -> FrameFate {
        let Some(ticks) = Ticks::parse(body, self.channels) else {
            return FrameFate::Refused(Reason::BadBody);
        };
        if book.taken && ticks.seq == book.expected_seq.wrapping_sub(1) {
            return FrameFate::Repeated;
        }
        let refused = if ticks.seq != book.expected_seq {
            Some((Reason::BadSeq, Faults::BAD_SEQ))
        } else if book.stopped {
            Some((Reason::Stopped, Faults::default()))
        } else if self.now < self.boot {
            Some((Reason::Busy, Faults::default()))
        } else if ticks.orders().iter().any(|&byte| Order::parse(byte).steps > self.slots) {
            Some((Reason::TooManySteps, Faults::TOO_MANY_STEPS))
        } else if ticks.count() > usize::from(parts.sequencer.free()) {
            Some((Reason::QueueFull, Faults::QUEUE_OVERFLOW))
        } else {
            None
        };
        if let Some((reason, fault)) = refused {
            parts.faults.set(fault);
            return FrameFate::Refused(reason);
        }
        for tick in ticks.iter() {
            parts.sequencer.push(self.now, tick);
        }
        (book.expected_seq, book.taken) = (book.expected_seq.wrapping_add(1), true);
        FrameFate::Queued(ticks.count() as u8)
    }
}
