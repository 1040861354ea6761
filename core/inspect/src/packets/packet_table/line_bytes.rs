//! Positions of bytes on the line, and gaps between rows.

use super::PacketTable;
use crate::packets::log::RowOutcome;
use alloc::vec::Vec;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::{BitTimes, bit_times::BYTE_BITS};

/// A byte on the line, in cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineByte {
    pub packet: usize,
    pub byte: u8,
    pub start: u64,
    pub end: u64,
}

impl PacketTable<'_> {
    pub(crate) fn is_own_reply(&self, index: usize) -> bool {
        self.logged(index)
            .is_some_and(|row| matches!(row.outcome, RowOutcome::Reply(_) | RowOutcome::Recorded))
    }

    pub fn line_bytes(&self, index: usize) -> Vec<LineByte> {
        self.line_bytes_from(index, 0).collect()
    }

    /// Bytes of a row from an index on. Received bytes have the receiver's length, sent ones the sender's.
    pub(crate) fn line_bytes_from(&self, index: usize, first: usize) -> impl Iterator<Item = LineByte> {
        let seen = self.log.start_bits(index);
        let sent =
            self.is_own_reply(index).then(|| BitTimes::new(self.config.clock_hz(), self.config.reply_baud()));
        let byte_time = Cycles(BYTE_BITS * self.config.bit().0);
        let bytes = self.bytes(index).iter().zip(seen).enumerate().skip(first);
        bytes.map(move |(at, (&byte, &first))| {
            let (start, end) = match sent {
                Some(times) => (first + times.byte(at as u64), first + times.byte(at as u64 + 1)),
                None => {
                    (first, seen.get(at + 1).map_or(first + byte_time, |&next| next.min(first + byte_time)))
                }
            };
            LineByte { packet: index, byte, start: start.0, end: end.0 }
        })
    }

    /// The cycle in which row `index` ends on the line.
    pub fn line_end(&self, index: usize) -> u64 {
        let Some(row) = self.logged(index) else { return 0 };
        match row.outcome {
            RowOutcome::Reply(_) | RowOutcome::Recorded | RowOutcome::Collision => row.end.0,
            // A packet is complete half a bit and nine bits after its start bit.
            RowOutcome::Packet(_) | RowOutcome::Frame(_) | RowOutcome::Framing => {
                let (Cycles(bit), Cycles(byte)) = (self.config.bit(), self.host_times().byte(1));
                (row.end.0 + byte).saturating_sub(bit / 2 + 9 * bit)
            }
            RowOutcome::Short | RowOutcome::Ignored | RowOutcome::Incomplete => {
                self.line_bytes(index).last().map_or(row.end.0, |byte| byte.end)
            }
        }
    }

    /// Idle cycles before row `index`; `None` for the first.
    pub fn gap(&self, index: usize) -> Option<u64> {
        let is_sent = |row: &usize| self.logged(*row).is_some_and(|row| row.outcome != RowOutcome::Collision);
        let row = self.logged(index).filter(|_| is_sent(&index))?;
        let before = (0..index).rev().find(is_sent)?;
        row.start.0.checked_sub(self.line_end(before))
    }

    /// The byte that the host sent within a bit of a start bit.
    pub(crate) fn sent_at(&self, seen: Instant) -> Option<u8> {
        let (reach, times) = (self.config.bit(), self.host_times());
        let send = self.run.schedule().last_at_or_before(seen + reach)?;
        let after = Cycles(seen.0.saturating_sub(send.start.0));
        let index = times.nearest_byte(after);
        let byte = *send.bytes.get(usize::try_from(index).ok()?)?;
        let begins = send.start + times.byte(index);
        (begins.0.abs_diff(seen.0) <= reach.0).then_some(byte)
    }
}
