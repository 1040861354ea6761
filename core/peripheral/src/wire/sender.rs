//! The sender of the serial line (DESIGN A4): bytes as edges, exact to the cycle.
//!
//! ```text
//!  idle  start  d0    d1        d7   stop
//! ──────┐     ┌─────┬─────┬ ─ ┬─────┬─────
//!       └─────┴─────┴─────┴   ┴─────┘
//!       t0    |     |  bit k begins at t0 + floor(k*clock_hz/baud)
//! ```
//!
//! The j-th of bytes sent back to back from t0 starts at t0 + floor(10*j*clock_hz/baud). Host and
//! controllers send by the same rule.
//!
//! ```
//! use std::rc::Rc;
//! use stepscope_peripheral::{units::Instant, wire::{Schedule, Sender}};
//!
//! let mut host = Schedule::default();
//! host.push(Instant(100), &[0xf0]);
//! let mut sender = Sender::new(Rc::new(host), 16_000_000, 1_000_000);
//! let mut edges = Vec::new();
//! while sender.next_edge() != Instant::NEVER {
//!     edges.push(sender.next_edge().0);
//!     sender.pass();
//! }
//! // 16 cycles a bit: the start bit falls, four zeros later the line rises, and stays for the stop bit.
//! assert_eq!(edges, [100, 180]);
//! ```

use crate::units::Instant;
use crate::wire::{BitTimes, Schedule, bit_times::BYTE_BITS};
use alloc::rc::Rc;

const _: () = assert!(BYTE_BITS <= u32::BITS as u64, "the edges of a byte have a bit each");

/// Iterates over the edges of a schedule's bytes.
#[derive(Clone, Debug)]
pub struct Sender {
    schedule: Rc<Schedule>,
    times: BitTimes,
    /// Where each bit of a byte begins.
    bit_starts: [u64; BYTE_BITS as usize],
    send: usize,
    byte: usize,
    byte_start: Instant,
    /// Bits of the byte that differ from the bit before them and have not passed.
    ///
    /// 32 bits, though ten are used: x86-64 code loads a narrower number as 32 bits, and right after a narrower store
    /// that load waits for the cache, at every edge of a run.
    edges: u32,
    /// Where the first of them is; [`Instant::NEVER`] without one.
    next: Instant,
    /// The level: 0 or 1, and of 32 bits for the same reason.
    level: u32,
}

impl Sender {
    /// A sender before its first byte. A rate of 0 counts as 1 baud.
    #[must_use]
    pub fn new(schedule: Rc<Schedule>, clock_hz: u32, baud: u32) -> Self {
        let times = BitTimes::new(clock_hz, baud);
        let mut sender = Self {
            schedule,
            times,
            bit_starts: core::array::from_fn(|k| times.bit(k as u64).0),
            send: 0,
            byte: 0,
            byte_start: Instant::NEVER,
            edges: 0,
            next: Instant::NEVER,
            level: 1,
        };
        sender.load();
        sender
    }

    /// All that has been sent and will be.
    #[must_use]
    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Adds a send after all others.
    pub fn send(&mut self, start: Instant, bytes: &[u8]) {
        Rc::make_mut(&mut self.schedule).push(start, bytes);
        if self.edges == 0 {
            self.load();
        }
    }

    /// Adds bytes to the last send. The first of them must not begin before the next cycle.
    pub fn extend(&mut self, bytes: &[u8]) {
        if self.edges == 0
            && let Some(last) = self.schedule.len().checked_sub(1)
        {
            (self.send, self.byte) = (last, self.schedule.get(last).map_or(0, |send| send.bytes.len()));
        }
        Rc::make_mut(&mut self.schedule).extend(bytes);
        if self.edges == 0 {
            self.load();
        }
    }

    /// Forgets what has been sent, if nothing is left to be.
    pub fn forget_sent(&mut self) {
        if self.edges == 0 {
            self.schedule = Rc::default();
            (self.send, self.byte) = (0, 0);
        }
    }

    /// What is sent now.
    #[must_use]
    pub const fn level(&self) -> bool {
        self.level != 0
    }

    /// Takes up the byte at (`send`, `byte`), or the first one after it.
    fn load(&mut self) {
        while let Some(send) = self.schedule.get(self.send) {
            if let Some(&byte) = send.bytes.get(self.byte) {
                self.byte_start = send.start + self.times.byte(self.byte as u64);
                // Start bit 0, data, stop bit 1; before the start bit the line is high.
                let frame = u32::from(byte) << 1 | 1 << 9;
                self.edges = (frame ^ (frame << 1 | 1)) & ((1 << BYTE_BITS) - 1);
                debug_assert!(self.edges & 1 == 1, "every byte begins with the edge of its start bit");
                self.next = self.byte_start;
                return;
            }
            self.send += 1;
            self.byte = 0;
        }
        self.edges = 0;
        self.next = Instant::NEVER;
    }

    /// Cycle of the next edge; [`Instant::NEVER`] without one.
    #[must_use]
    pub const fn next_edge(&self) -> Instant {
        self.next
    }

    /// Enters the cycle of [`Self::next_edge`].
    pub fn pass(&mut self) {
        debug_assert!(self.edges != 0, "there is no edge to pass");
        self.level ^= 1;
        self.edges &= self.edges.wrapping_sub(1);
        match self.bit_starts.get(self.edges.trailing_zeros() as usize) {
            Some(offset) => self.next = Instant(self.byte_start.0 + offset),
            None => {
                self.byte += 1;
                self.load();
            }
        }
    }
}
