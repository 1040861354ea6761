//! The host's sends: bytes at cycles (DESIGN A9). Packet j of a paced schedule starts j ticks after the first, so ticks follow
//! each other without a pause.
//!
//! ```
//! use stepscope_peripheral::{units::Instant, wire::{Schedule, schedule::line_time}};
//!
//! let mut host = Schedule::default();
//! host.push(Instant(1601), &[0x85, 0x03]);
//! assert_eq!(host.total_bytes(), 2);
//! // Two bytes of ten bits at 115200 baud, in cycles of 16 MHz.
//! assert_eq!(line_time(2, 16_000_000, 115_200), 1388 + 1388);
//! ```

use crate::units::{Cycles, Instant};
use crate::wire::BitTimes;
use alloc::vec::Vec;
use core::ops::Range;

/// Bytes in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sent<'a> {
    /// Start bit of the first byte.
    pub start: Instant,
    pub bytes: &'a [u8],
}

/// The host's sends, rising in time and disjoint.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Schedule {
    /// Start of each send, and the end of its bytes in `bytes`.
    /// Invariant: both rising; the last end is that of `bytes`.
    sends: Vec<(Instant, usize)>,
    bytes: Vec<u8>,
}

impl Schedule {
    /// One packet per tick of `tick` cycles, from `start` on. The caller checks with [`line_time`] that the line is fast
    /// enough.
    pub fn paced(start: Instant, tick: Cycles, packets: impl Iterator<Item = impl AsRef<[u8]>>) -> Self {
        let mut schedule = Self::default();
        let mut start = start;
        for packet in packets {
            schedule.push(start, packet.as_ref());
            start += tick;
        }
        schedule
    }

    /// Adds a send after all others.
    pub fn push(&mut self, start: Instant, bytes: &[u8]) {
        debug_assert!(
            self.sends.last().is_none_or(|(before, _)| *before <= start),
            "a send in {start:?} after one in {:?}",
            self.sends.last()
        );
        self.bytes.extend_from_slice(bytes);
        self.sends.push((start, self.bytes.len()));
    }

    /// Adds bytes to the last send, if there is one.
    pub fn extend(&mut self, bytes: &[u8]) {
        debug_assert!(!self.sends.is_empty(), "there is no send to extend");
        if let Some((_, end)) = self.sends.last_mut() {
            self.bytes.extend_from_slice(bytes);
            *end = self.bytes.len();
        }
    }

    pub fn len(&self) -> usize {
        self.sends.len()
    }

    pub fn is_empty(&self) -> bool {
        self.sends.is_empty()
    }

    pub fn total_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Send `index`; `None` past the last.
    pub fn get(&self, index: usize) -> Option<Sent<'_>> {
        let (start, range) = self.byte_range(index)?;
        self.bytes.get(range).map(|bytes| Sent { start, bytes })
    }

    /// Start of a send, and the range of its bytes.
    pub(super) fn byte_range(&self, index: usize) -> Option<(Instant, Range<usize>)> {
        let &(start, end) = self.sends.get(index)?;
        let first = index.checked_sub(1).and_then(|before| self.sends.get(before)).map_or(0, |s| s.1);
        Some((start, first..end))
    }

    pub(super) fn byte(&self, index: usize) -> Option<u8> {
        self.bytes.get(index).copied()
    }

    /// The last send that begins in cycle `at` or before.
    pub fn last_at_or_before(&self, at: Instant) -> Option<Sent<'_>> {
        let after = self.sends.partition_point(|(start, _)| *start <= at);
        self.get(after.checked_sub(1)?)
    }

    pub fn iter(&self) -> impl Iterator<Item = Sent<'_>> {
        (0..self.len()).filter_map(|index| self.get(index))
    }
}

/// Cycles that `bytes` bytes in a row take, to the end of the last stop bit; a rate of 0 counts as 1 baud.
pub const fn line_time(bytes: u64, clock_hz: u32, baud: u32) -> u64 {
    BitTimes::new(clock_hz, baud).bytes(bytes).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paced_packets_start_once_per_tick() {
        let packets: [&[u8]; 4] = [&[1, 2], &[3], &[], &[4, 5, 6]];
        let schedule = Schedule::paced(Instant(101), Cycles(40), packets.iter());
        let sent: Vec<(u64, &[u8])> = schedule.iter().map(|sent| (sent.start.0, sent.bytes)).collect();
        assert_eq!(sent, [(101, packets[0]), (141, packets[1]), (181, packets[2]), (221, packets[3])]);
        assert_eq!((schedule.len(), schedule.total_bytes(), schedule.is_empty()), (4, 6, false));
        assert_eq!((schedule.get(4), Schedule::default().get(0)), (None, None));
        assert!(Schedule::default().is_empty());
    }

    #[test]
    fn bytes_are_added_to_the_last_send() {
        let mut schedule = Schedule::default();
        schedule.push(Instant(5), &[1]);
        schedule.push(Instant(90), &[2]);
        schedule.extend(&[3, 4]);
        schedule.push(Instant(200), &[5]);
        let sent: Vec<(u64, &[u8])> = schedule.iter().map(|sent| (sent.start.0, sent.bytes)).collect();
        assert_eq!(sent, [(5, &[1][..]), (90, &[2, 3, 4]), (200, &[5])]);
    }

    #[test]
    fn the_last_send_at_a_cycle_starts_in_it_or_before() {
        let packets: [&[u8]; 2] = [&[1, 2], &[3]];
        let schedule = Schedule::paced(Instant(101), Cycles(40), packets.iter());
        let found = [100, 101, 140, 141, 9000]
            .map(|at| schedule.last_at_or_before(Instant(at)).map(|sent| sent.bytes));
        assert_eq!(found, [None, Some(packets[0]), Some(packets[0]), Some(packets[1]), Some(packets[1])]);
    }

    #[test]
    fn line_time_includes_the_last_stop_bit() {
        // Bytes, clock, baud, cycles. With 10.5 cycles per bit, bytes start at 0, 105 and 210.
        let rows =
            [(0, 21, 2, 0), (1, 21, 2, 105), (3, 21, 2, 315), (2, 100, 7, 142 + 142), (5, 100, 0, 5000)];
        for (bytes, clock_hz, baud, expected) in rows {
            assert_eq!(
                line_time(bytes, clock_hz, baud),
                expected,
                "{bytes} bytes, {baud} baud, {clock_hz} Hz"
            );
        }
    }
}
