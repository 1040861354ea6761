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
use crate::wire::{
    BitTimes, Schedule,
    bit_times::{BYTE_BITS, ByteStarts},
};
use alloc::{rc::Rc, vec::Vec};
use core::ops::Range;

const _: () = assert!(BYTE_BITS <= u32::BITS as u64, "the edges of a byte have a bit each");

/// Cycles from a byte's start to where each of its bits begins, and to its end; those after it are never reached.
pub type BitStarts = [u64; NO_BIT + 1];

/// The place of a bit that no byte has; all bits of a place, too, so that masked with it every place is one of these.
pub const NO_BIT: usize = 15;
const _: () = assert!((NO_BIT + 1).is_power_of_two() && NO_BIT > BYTE_BITS as usize);

/// A byte that begins with a line's next edge.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ByteAhead<'a> {
    /// The byte.
    pub byte: u8,
    /// Cycle of its start bit.
    pub start: Instant,
    /// Bits that differ from the bit before them, the start bit lowest.
    pub edges: u32,
    /// When they begin.
    pub bit_starts: &'a BitStarts,
}

/// Iterates over the edges of a schedule's bytes.
#[derive(Clone, Debug)]
pub struct Sender {
    schedule: Rc<Schedule>,
    times: BitTimes,
    bit_starts: BitStarts,
    /// Sends that have been taken up; when the last of them begins, and the places of its bytes that are to come.
    sends: usize,
    send_start: Instant,
    places: Range<usize>,
    /// When those begin.
    byte_starts: ByteStarts,
    /// The byte that is sent or comes next, and when it begins.
    byte: u8,
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
            bit_starts: core::array::from_fn(|k| {
                if k as u64 <= BYTE_BITS { times.bit(k as u64).0 } else { u64::MAX / 2 }
            }),
            sends: 0,
            send_start: Instant::NEVER,
            places: 0..0,
            byte_starts: times.byte_starts(),
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
        let schedule = Rc::make_mut(&mut self.schedule);
        schedule.extend(bytes);
        if self.sends == schedule.len() {
            self.places.end = schedule.total_bytes();
        }
        if self.edges == 0 {
            self.load();
        }
    }

    /// Forgets what has been sent of the last send and before it.
    pub fn forget_sent(&mut self) {
        if self.sends == 0 || self.sends < self.schedule.len() {
            return;
        }
        let rest: Vec<u8> = self.places.clone().filter_map(|place| self.schedule.byte(place)).collect();
        let mut schedule = Schedule::default();
        schedule.push(self.send_start, &rest);
        (self.sends, self.places) = (1, 0..rest.len());
        self.schedule = Rc::new(schedule);
    }

    /// What is sent now.
    #[must_use]
    pub const fn level(&self) -> bool {
        self.level != 0
    }

    /// Takes up the next byte.
    fn load(&mut self) {
        while self.places.is_empty() {
            let Some((start, places)) = self.schedule.places(self.sends) else {
                (self.edges, self.next) = (0, Instant::NEVER);
                return;
            };
            self.sends += 1;
            (self.send_start, self.places, self.byte_starts) = (start, places, self.times.byte_starts());
        }
        self.byte = self.schedule.byte(self.places.start).unwrap_or_default();
        self.places.start += 1;
        self.byte_start = self.send_start + self.byte_starts.next();
        // Start bit 0, data, stop bit 1; before the start bit the line is high.
        let frame = u32::from(self.byte) << 1 | 1 << 9;
        self.edges = (frame ^ (frame << 1 | 1)) & ((1 << BYTE_BITS) - 1);
        debug_assert!(self.edges & 1 == 1, "every byte begins with the edge of its start bit");
        self.next = self.byte_start;
    }

    /// When the bits of a byte begin, from its start bit's on.
    #[must_use]
    pub const fn bit_starts(&self) -> &BitStarts {
        &self.bit_starts
    }

    /// The byte whose start bit is the next edge; `None` within a byte, and after the last.
    #[must_use]
    #[inline(always)]
    pub fn byte_ahead(&self) -> Option<ByteAhead<'_>> {
        let Self { byte, byte_start: start, edges, ref bit_starts, .. } = *self;
        (edges & 1 != 0).then_some(ByteAhead { byte, start, edges, bit_starts })
    }

    /// Passes all edges of [`Self::byte_ahead`].
    #[inline(always)]
    pub fn pass_byte(&mut self) {
        debug_assert!(self.edges & 1 != 0 && self.level == 1, "no byte is ahead");
        self.load();
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
        if self.edges == 0 {
            self.load();
        } else {
            self.next =
                Instant(self.byte_start.0 + self.bit_starts[self.edges.trailing_zeros() as usize & NO_BIT]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10.5 cycles a bit.
    fn sender(start: u64, bytes: &[u8]) -> Sender {
        let mut schedule = Schedule::default();
        schedule.push(Instant(start), bytes);
        Sender::new(Rc::new(schedule), 21, 2)
    }

    /// The next edges, at most so many.
    fn edges(sender: &mut Sender, most: usize) -> Vec<u64> {
        let next = || {
            let edge = sender.next_edge();
            (edge != Instant::NEVER).then(|| sender.pass())?;
            Some(edge.0)
        };
        core::iter::from_fn(next).take(most).collect()
    }

    #[test]
    fn bytes_that_join_a_send_later_begin_as_if_they_had_been_known() {
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
            let left = edges(&mut joined, usize::MAX);
            if known > 0 {
                forgetful.forget_sent();
                assert!(forgetful.schedule().total_bytes() < known);
                forgetful.extend(later);
                assert_eq!(
                    edges(&mut forgetful, usize::MAX),
                    left,
                    "{known} bytes known, {passed} edges passed"
                );
            }
            found.extend(left);
            assert_eq!(found, all, "{known} bytes known, {passed} edges passed");
        }
    }

    #[test]
    fn a_whole_byte_is_passed_as_its_edges_are() {
        let bytes = [0x00, 0xff, 0x55];
        let (mut whole, mut single) = (sender(7, &bytes), sender(7, &bytes));
        for byte in bytes {
            let ahead = whole.byte_ahead().expect("a byte is ahead");
            assert_eq!((ahead.byte, ahead.start), (byte, single.next_edge()));
            let places = (0..BYTE_BITS as usize).filter(|bit| ahead.edges >> bit & 1 != 0);
            let starts: Vec<u64> = places.map(|bit| ahead.start.0 + ahead.bit_starts[bit]).collect();
            assert_eq!(edges(&mut single, starts.len()), starts, "{byte:#x}");
            whole.pass_byte();
            assert_eq!((whole.next_edge(), whole.level()), (single.next_edge(), single.level()), "{byte:#x}");
        }
        assert!(whole.byte_ahead().is_none());
        // What is sent after all has been forgotten begins anew.
        whole.forget_sent();
        whole.send(Instant(900), &[0x0f]);
        assert_eq!(edges(&mut whole, usize::MAX), [900, 910, 952, 994]);
    }
}
