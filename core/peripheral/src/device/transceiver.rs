//! The signals EN, TX and DE (DESIGN A6): drivers on or off, and replies.
//!
//! ```text
//! p            p + 10*B    p + 11*B                     t + floor(10*clock_hz/receiver_baud)
//! frame's end  DE rises    first start bit … last byte at t … DE falls
//! ```

use crate::units::{Cycles, Instant};
use crate::wire::{BitTimes, Schedule, Sender, frame::REPLY_LEN};
use crate::{config::Config, signal::Levels};
use alloc::sync::Arc;

/// Bit times from the end of a frame to the rise of DE.
const TURNAROUND_BITS: u64 = 10;

#[derive(Clone, Debug)]
pub(super) struct Transceiver {
    clock_hz: u32,
    baud: u32,
    bit: Cycles,
    levels: u64,
    /// Cycle of the next change of EN, and its level.
    enable: Option<(Instant, bool)>,
    /// At most one: the receiver ignores the line during a reply, and no frame can end before the reply starts.
    reply: Option<Reply>,
    /// Next cycle in which a signal may change.
    next: Instant,
}

#[derive(Clone, Debug)]
struct Reply {
    rise: Instant,
    fall: Instant,
    sender: Sender,
}

impl Transceiver {
    pub(super) const fn new(config: &Config) -> Self {
        Self {
            clock_hz: config.clock_hz(),
            baud: config.reply_baud(),
            bit: config.bit(),
            levels: Levels::EN | Levels::TX,
            enable: None,
            reply: None,
            next: Instant::NEVER,
        }
    }

    pub(super) const fn levels(&self) -> u64 {
        self.levels
    }

    pub(super) const fn drives(&self) -> bool {
        self.levels & Levels::DE != 0
    }

    pub(super) const fn deadline(&self) -> Instant {
        self.next
    }

    /// EN, TX and DE in cycle `now`, the next one, and when they change after it.
    pub(super) fn in_cycle(&self, now: Instant) -> (Levels, Instant) {
        if now != self.next {
            return (Levels(self.levels), self.next);
        }
        let mut ahead = self.clone();
        ahead.clock(now);
        (Levels(ahead.levels), ahead.next)
    }

    pub(super) fn clock(&mut self, now: Instant) {
        debug_assert!(now <= self.next, "{:?} was skipped", self.next);
        if self.next != now {
            return;
        }
        if let Some((_, high)) = self.enable.take_if(|(at, _)| *at == now) {
            self.set(Levels::EN, high);
        }
        if let Some(reply) = &mut self.reply {
            if reply.rise == now {
                self.levels |= Levels::DE;
            }
            while reply.sender.next_edge() == now {
                reply.sender.pass();
            }
            let (tx, is_over) = (reply.sender.level(), reply.fall == now);
            self.set(Levels::TX, tx);
            if is_over {
                self.set(Levels::DE, false);
                self.reply = None;
            }
        }
        self.schedule_next(now);
    }

    const fn set(&mut self, mask: u64, high: bool) {
        self.levels = if high { self.levels | mask } else { self.levels & !mask };
    }

    fn schedule_next(&mut self, now: Instant) {
        let enable = self.enable.map_or(Instant::NEVER, |(at, _)| at);
        let reply = self.reply.as_ref().map_or(Instant::NEVER, |reply| {
            if now < reply.rise { reply.rise } else { reply.sender.next_edge().min(reply.fall) }
        });
        self.next = enable.min(reply);
    }

    pub(super) const fn turnaround(&self) -> Cycles {
        Cycles(TURNAROUND_BITS * self.bit.0)
    }

    pub(super) fn enable(&mut self, now: Instant, high: bool) {
        debug_assert!(self.enable.is_none_or(|(at, _)| at == now.next()), "EN was due before {now:?}");
        self.enable = Some((now.next(), high));
        self.schedule_next(now);
    }

    /// Replies to a frame that ended in cycle `now`. Returns the first start bit and the fall of DE.
    pub(super) fn reply(&mut self, now: Instant, bytes: &[u8]) -> (Instant, Instant) {
        debug_assert!(self.reply.is_none(), "a second reply before the first has been sent");
        debug_assert!(!bytes.is_empty() && bytes.len() <= REPLY_LEN, "a reply of {} bytes", bytes.len());
        let rise = now + self.turnaround();
        let start = rise + self.bit;
        let fall = start + BitTimes::new(self.clock_hz, self.baud).bytes(bytes.len() as u64);
        let mut schedule = Schedule::default();
        schedule.push(start, bytes);
        let sender = Sender::new(Arc::new(schedule), self.clock_hz, self.baud);
        self.reply = Some(Reply { rise, fall, sender });
        self.schedule_next(now);
        (start, fall)
    }
}
