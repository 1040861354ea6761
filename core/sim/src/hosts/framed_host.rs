//! The host of a framed line (DESIGN A6, A9): one frame, its reply, the next. Its policy is in docs/decisions.md.
//!
//! ```text
//! each controller   opening: STATUS, POSITIONS ── filling: TICKS, TICKS, …
//!                     ── confirming: STATUS ── verifying: POSITIONS ── done
//! each exchange     send ── reply ── ten bit times ── the next
//!                     └── no reply in time: the same frame again, after a delimiter
//! ```
//!
//! [`Conversation`] implements the protocol in bytes and cycles, for real lines, too. [`FramedHost`] connects it to the simulated
//! line with its noise.

mod conversation;
mod peer;
mod report;
#[cfg(test)]
mod tests;
mod tick_sums;

pub use conversation::{Conversation, Counts};
pub use peer::{GivenUp, Job, Known, Progress};
pub use report::{HostStatus, Report, ReportRow, for_real_line};

use crate::line::noise::Noise;
use alloc::{vec, vec::Vec};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::uart::{Receiver, RxEvent};
use stepscope_peripheral::wire::{Line, schedule::line_time};
use stepscope_scenario::Host as Settings;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sending {
    end: Instant,
    crashes: bool,
}

/// The host of a simulated framed line.
#[derive(Clone, Debug)]
pub struct FramedHost {
    clock_hz: u32,
    baud: u32,
    bit: Cycles,
    conversation: Conversation,
    sending: Option<Sending>,
    receiver: Receiver,
    received_level: bool,
    noise: Option<Noise>,
    last_active: Instant,
}

impl FramedHost {
    /// A host that begins in cycle `start`. `bit` is the bit time of its receiver.
    pub fn new(
        jobs: Vec<Job>,
        settings: &Settings,
        (clock_hz, baud, bit): (u32, u32, Cycles),
        start: Instant,
        noise: Option<Noise>,
    ) -> Self {
        Self {
            clock_hz,
            baud,
            bit,
            conversation: Conversation::new(jobs, settings, bit, start),
            sending: None,
            receiver: Receiver::new(bit),
            received_level: true,
            noise,
            last_active: Instant::RESET,
        }
    }

    /// The state of the protocol.
    pub const fn conversation(&self) -> &Conversation {
        &self.conversation
    }

    /// The last cycle with an event.
    pub const fn last_active(&self) -> Instant {
        self.last_active
    }

    /// Whether it is sending in cycle `now`; then it receives nothing.
    pub fn is_sending(&self, now: Instant) -> bool {
        self.sending.is_some_and(|sending| now < sending.end)
    }

    /// The next cycle after `now` with an event while the level is constant; [`Instant::NEVER`] at the end.
    pub fn deadline(&self, now: Instant) -> Instant {
        match self.sending {
            Some(Sending { end, .. }) => end,
            None if self.conversation.is_waiting() => {
                self.conversation.deadline().min(self.receiver.deadline(now, self.received_level))
            }
            None => self.conversation.deadline(),
        }
    }

    /// Runs cycle `now`, in which it receives `level`.
    pub fn clock(&mut self, now: Instant, level: bool, line: &mut Line) {
        self.received_level = level;
        if self.conversation.is_waiting()
            && let Some(RxEvent::Byte(byte)) = self.receiver.clock(now, level)
        {
            self.last_active = now;
            self.receive(byte, now);
        }
        if let Some(Sending { end, crashes }) = self.sending {
            if end <= now {
                (self.last_active, self.sending) = (now, None);
                self.sent(now, crashes);
            }
        } else if self.conversation.deadline() <= now {
            self.last_active = now;
            if let Some(bytes) = self.conversation.poll(now) {
                self.send(now, bytes, line);
            }
        }
    }

    fn send(&mut self, now: Instant, mut bytes: Vec<u8>, line: &mut Line) {
        let start = now.next();
        let mut crashes = false;
        if let Some(noise) = &mut self.noise {
            let corrupted = noise.send(start, &bytes);
            (bytes, crashes) = (corrupted.bytes, corrupted.crashes);
            if let Some(forced) = corrupted.forced {
                line.force(forced);
            }
        }
        let end = start + Cycles(line_time(bytes.len() as u64, self.clock_hz, self.baud));
        line.send(start, &bytes);
        self.sending = Some(Sending { end, crashes });
    }

    fn sent(&mut self, now: Instant, crashes: bool) {
        if crashes {
            self.conversation.crash(now);
        } else {
            self.receiver = Receiver::new(self.bit);
            self.conversation.sent(now);
        }
    }

    fn receive(&mut self, byte: u8, now: Instant) {
        let Self { conversation, noise, .. } = self;
        let received = noise.as_mut().map_or_else(|| vec![byte], |noise| noise.receive(byte));
        for byte in received {
            conversation.receive_unless(byte, now, || noise.as_mut().is_some_and(Noise::misses_reply));
        }
    }
}
