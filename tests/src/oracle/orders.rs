//! A6: the effect of a valid frame, and its reply.

use super::frames::{Frame, frame};
use super::packets::too_many_steps;
use super::sequencer::Sequencer;
use super::{BAD_SEQ, Config, QUEUE_OVERFLOW, State, TOO_MANY_STEPS};

/// The kinds of frames that a host sends.
pub mod kinds {
    /// Body seq, count, then count*n commands: queues ticks.
    pub const TICKS: u8 = 0x01;
    /// EN = 1, leaves STOPPED.
    pub const ENABLE: u8 = 0x02;
    /// EN = 0 and STOPPED, if nothing moves.
    pub const DISABLE: u8 = 0x03;
    /// Replies only.
    pub const STATUS: u8 = 0x04;
    /// EN = 0 and STEP = 0 at once.
    pub const STOP: u8 = 0x05;
    /// Expected seq = 0, fault flags cleared.
    pub const RESYNC: u8 = 0x06;
    /// Only replies; the ACK has the position counters after the status.
    pub const POSITIONS: u8 = 0x07;
    /// Kind of a reply to a refused frame; an ACK has the frame's kind with bit 7 set.
    pub const NAK: u8 = 0xFF;
}

/// Reason of a refusal; the number is that in the reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reason {
    BadSeq = 1,
    QueueFull = 2,
    TooManySteps = 3,
    Busy = 4,
    Stopped = 5,
    BadBody = 6,
    UnknownKind = 7,
}

impl Reason {
    /// The fault set by a NAK with this reason, 0 for none: "The other NAKs set none".
    fn fault(self) -> u16 {
        match self {
            Reason::BadSeq => BAD_SEQ,
            Reason::QueueFull => QUEUE_OVERFLOW,
            Reason::TooManySteps => TOO_MANY_STEPS,
            Reason::Busy | Reason::Stopped | Reason::BadBody | Reason::UnknownKind => 0,
        }
    }
}

/// The state that commands change.
pub(super) struct Device {
    pub(super) sequencer: Sequencer,
    pub(super) faults: u16,
    pub(super) enabled: bool,
    pub(super) stopped: bool,
    pub(super) expected_seq: u8,
    /// "a TICKS was accepted since reset or RESYNC".
    ticks_accepted: bool,
}

impl Device {
    /// A3's reset state.
    pub(super) fn new() -> Self {
        Device {
            sequencer: Sequencer::default(),
            faults: 0,
            enabled: true,
            stopped: false,
            expected_seq: 0,
            ticks_accepted: false,
        }
    }

    /// "state = 3 STOPPED if stopped, else 0 BUSY if p < boot, else 2 MOVING if a tick runs (c0 <= p < e) or the queue
    /// is not empty, else 1 READY".
    pub(super) fn state(&self, config: &Config, p: u64) -> State {
        if self.stopped {
            State::Stopped
        } else if p < config.boot {
            State::Busy
        } else if self.sequencer.moving() {
            State::Moving
        } else {
            State::Ready
        }
    }

    /// Executes a valid frame whose 0x00 is delivered in cycle `p`; returns the reply's bytes on the wire, if there
    /// is one. `positions` are the counters in that cycle: "rises of STEP in cycles up to and including
    /// p count".
    pub(super) fn take(
        &mut self,
        config: &Config,
        good: &Frame,
        p: u64,
        positions: &[i32; 16],
    ) -> Option<Vec<u8>> {
        let own = config.address.unwrap_or(0);
        if good.address != own && good.address != 255 {
            return None;
        }
        let outcome = self.execute(config, good, p);
        // "taken in cycle p after the frame took effect". Reading: the flag that a NAK sets is such an effect, so the
        // status of the NAK includes it.
        if let Err(reason) = outcome {
            self.faults |= reason.fault();
        }
        if good.address == 255 {
            return None;
        }
        let status = self.status(config, p);
        Some(match outcome {
            // "after the 9 bytes of status 4*n bytes, the position counters (A3) of channels 0..n-1 in that order,
            // n = `channels`, each an i32, two's complement, little-endian".
            Ok(()) if good.kind == kinds::POSITIONS => {
                let mut body = status;
                for counter in &positions[..config.channels] {
                    body.extend(counter.to_le_bytes());
                }
                frame(own, kinds::POSITIONS | 0x80, &body)
            }
            Ok(()) => frame(own, good.kind | 0x80, &status),
            Err(reason) => {
                let mut body = vec![reason as u8];
                body.extend(status);
                frame(own, kinds::NAK, &body)
            }
        })
    }

    fn execute(&mut self, config: &Config, good: &Frame, p: u64) -> Result<(), Reason> {
        // Reading: an unknown kind is UNKNOWN_KIND with any body, and for a kind without a body the body is checked
        // first.
        match good.kind {
            kinds::TICKS => return self.queue_ticks(config, &good.body, p),
            kinds::ENABLE..=kinds::POSITIONS if !good.body.is_empty() => return Err(Reason::BadBody),
            kinds::ENABLE => {
                self.enabled = true;
                self.stopped = false;
            }
            kinds::DISABLE if self.sequencer.moving() => return Err(Reason::Busy),
            kinds::DISABLE => {
                self.enabled = false;
                self.stopped = true;
            }
            kinds::STATUS | kinds::POSITIONS => {}
            kinds::STOP => {
                self.enabled = false;
                self.stopped = true;
                self.sequencer.stop();
            }
            kinds::RESYNC => {
                self.expected_seq = 0;
                self.ticks_accepted = false;
                self.faults = 0;
            }
            _ => return Err(Reason::UnknownKind),
        }
        Ok(())
    }

    /// "TICKS, judged in this order".
    fn queue_ticks(&mut self, config: &Config, body: &[u8], p: u64) -> Result<(), Reason> {
        if body.len() < 2 {
            return Err(Reason::BadBody);
        }
        let (seq, count, orders) = (body[0], usize::from(body[1]), &body[2..]);
        if !(1..=32).contains(&count) || orders.len() != count * config.channels {
            return Err(Reason::BadBody);
        }
        if seq == self.expected_seq.wrapping_sub(1) && self.ticks_accepted {
            return Ok(());
        }
        if seq != self.expected_seq {
            return Err(Reason::BadSeq);
        }
        if self.stopped {
            return Err(Reason::Stopped);
        }
        if p < config.boot {
            return Err(Reason::Busy);
        }
        if too_many_steps(config, orders) {
            return Err(Reason::TooManySteps);
        }
        if count > self.sequencer.free(config) {
            return Err(Reason::QueueFull);
        }
        for tick in orders.chunks(config.channels) {
            self.sequencer.queue(tick);
        }
        self.expected_seq = self.expected_seq.wrapping_add(1);
        self.ticks_accepted = true;
        Ok(())
    }

    /// "state(1) free(1) expected_seq(1) faults(2, little-endian) ticks_done(4, little-endian, wrapping)".
    fn status(&self, config: &Config, p: u64) -> Vec<u8> {
        let mut status =
            vec![self.state(config, p) as u8, self.sequencer.free(config) as u8, self.expected_seq];
        status.extend(self.faults.to_le_bytes());
        status.extend(self.sequencer.ticks_done.to_le_bytes());
        status
    }
}
