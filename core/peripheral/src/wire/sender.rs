//! The sender of the serial line (DESIGN A4): the cycles of all edges of its bytes. Host and controllers share it.
//!
//! ```text
//!  idle  start  d0    d1        d7   stop
//! ──────┐     ┌─────┬─────┬ ─ ┬─────┬─────
//!       └─────┴─────┴─────┴   ┴─────┘
//!       t0    |     |  bit k begins at t0 + floor(k*clock_hz/baud)
//! ```
//!
//! ```
//! use std::sync::Arc;
//! use stepscope_peripheral::{units::Instant, wire::{Schedule, Sender}};
//!
//! let mut host = Schedule::default();
//! host.push(Instant(100), &[0xf0]);
//! let mut sender = Sender::new(Arc::new(host), 16_000_000, 1_000_000);
//! let mut edges = Vec::new();
//! while sender.next_edge() != Instant::NEVER {
//!     edges.push(sender.next_edge().0);
//!     sender.pass();
//! }
//! // 16 cycles per bit: the start bit falls, the line rises four zeros later and stays high for the stop bit.
//! assert_eq!(edges, [100, 180]);
//! ```

use crate::units::Instant;
use crate::wire::{BitTimes, Schedule, bit_times::BYTE_BITS};
use alloc::{sync::Arc, vec::Vec};
use core::ops::Range;

/// Sends the bytes of a schedule, edge by edge.
#[derive(Clone, Debug)]
pub struct Sender {
    schedule: Arc<Schedule>,
    times: BitTimes,
    sends_begun: usize,
    /// Start, bytes begun and indices of the remaining bytes of the last send begun.
    send_start: Instant,
    bytes_begun: u64,
    remaining: Range<usize>,
    byte_start: Instant,
    /// Remaining edges of the current byte: bits that differ from the bit before, the start bit lowest.
    edges: u16,
    /// Cycle of the next edge; [`Instant::NEVER`] without one.
    next: Instant,
    level: bool,
}

impl Sender {
    /// A sender before its first byte. A rate of 0 counts as 1 baud.
    pub fn new(schedule: Arc<Schedule>, clock_hz: u32, baud: u32) -> Self {
        let mut sender = Self {
            schedule,
            times: BitTimes::new(clock_hz, baud),
            sends_begun: 0,
            send_start: Instant::NEVER,
            bytes_begun: 0,
            remaining: 0..0,
            byte_start: Instant::NEVER,
            edges: 0,
            next: Instant::NEVER,
            level: true,
        };
        sender.load_byte();
        sender
    }

    pub fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    /// Adds a send after all others.
    pub fn send(&mut self, start: Instant, bytes: &[u8]) {
        Arc::make_mut(&mut self.schedule).push(start, bytes);
        if self.edges == 0 {
            self.load_byte();
        }
    }

    /// Adds bytes to the last send. The first byte must not begin before the next cycle.
    pub fn extend(&mut self, bytes: &[u8]) {
        let schedule = Arc::make_mut(&mut self.schedule);
        schedule.extend(bytes);
        if self.sends_begun == schedule.len() {
            self.remaining.end = schedule.total_bytes();
        }
        if self.edges == 0 {
            self.load_byte();
        }
    }

    /// Removes bytes that were sent, to bound the memory of an endless line.
    pub fn forget_sent(&mut self) {
        if self.sends_begun == 0 || self.sends_begun < self.schedule.len() {
            return;
        }
        let remaining: Vec<u8> =
            self.remaining.clone().filter_map(|index| self.schedule.byte(index)).collect();
        let mut schedule = Schedule::default();
        schedule.push(self.send_start, &remaining);
        (self.sends_begun, self.remaining) = (1, 0..remaining.len());
        self.schedule = Arc::new(schedule);
    }

    /// The level in the current cycle.
    pub const fn level(&self) -> bool {
        self.level
    }

    fn load_byte(&mut self) {
        while self.remaining.is_empty() {
            let Some((start, bytes)) = self.schedule.byte_range(self.sends_begun) else {
                (self.edges, self.next) = (0, Instant::NEVER);
                return;
            };
            self.sends_begun += 1;
            (self.send_start, self.remaining, self.bytes_begun) = (start, bytes, 0);
        }
        let byte = self.schedule.byte(self.remaining.start).unwrap_or_default();
        self.remaining.start += 1;
        self.byte_start = self.send_start + self.times.byte(self.bytes_begun);
        self.bytes_begun += 1;
        // Start bit 0, data, stop bit 1; the line is high before the start bit.
        let frame = u16::from(byte) << 1 | 1 << 9;
        self.edges = (frame ^ (frame << 1 | 1)) & ((1 << BYTE_BITS) - 1);
        self.next = self.byte_start;
    }

    /// Cycle of the next edge; [`Instant::NEVER`] without one.
    pub const fn next_edge(&self) -> Instant {
        self.next
    }

    /// Enters the cycle of [`Self::next_edge`].
    pub fn pass(&mut self) {
        debug_assert!(self.edges != 0, "there is no edge to pass");
        self.level = !self.level;
        self.edges &= self.edges.wrapping_sub(1);
        if self.edges == 0 {
            self.load_byte();
        } else {
            self.next = self.byte_start + self.times.bit(self.edges.trailing_zeros().into());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10.5 cycles per bit.
    fn sender(start: u64, bytes: &[u8]) -> Sender {
        let mut schedule = Schedule::default();
        schedule.push(Instant(start), bytes);
        Sender::new(Arc::new(schedule), 21, 2)
    }

    /// The next edges, at most `max`.
    fn edges(sender: &mut Sender, max: usize) -> Vec<u64> {
        let next = || {
            let edge = sender.next_edge();
            (edge != Instant::NEVER).then(|| sender.pass())?;
            Some(edge.0)
        };
        core::iter::from_fn(next).take(max).collect()
    }

    #[test]
    fn bytes_added_to_a_send_later_have_the_same_edges() {
        let bytes = [0x00, 0xff, 0x55, 0x81, 0x7e];
        let all = edges(&mut sender(100, &bytes), usize::MAX);
        for (known, passed) in
            (0..=bytes.len()).flat_map(|known| (0..=all.len()).map(move |passed| (known, passed)))
        {
            let (first, later) = bytes.split_at(known);
            let mut joined = sender(100, first);
            let mut found = edges(&mut joined, passed);
            let mut forgetful = joined.clone();
            joined.extend(later);
            let remaining = edges(&mut joined, usize::MAX);
            if known > 0 {
                forgetful.forget_sent();
                assert!(forgetful.schedule().total_bytes() < known);
                forgetful.extend(later);
                assert_eq!(
                    edges(&mut forgetful, usize::MAX),
                    remaining,
                    "{known} bytes known, {passed} edges passed"
                );
            }
            found.extend(remaining);
            assert_eq!(found, all, "{known} bytes known, {passed} edges passed");
        }
    }

    #[test]
    fn a_send_after_forgetting_starts_at_its_own_cycle() {
        let mut sender = sender(7, &[0x00, 0xff]);
        edges(&mut sender, usize::MAX);
        sender.forget_sent();
        sender.send(Instant(900), &[0x0f]);
        assert_eq!(edges(&mut sender, usize::MAX), [900, 910, 952, 994]);
    }
}
