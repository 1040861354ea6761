//! The host's sends: bytes at cycles (DESIGN A9).
//!
//! A line script is such a schedule itself; packets, and motions through their packets, are paced:
//! packet j starts at boot + 1 + j*M*Ts, so tick follows tick without a pause.

use crate::{
    scenario::{Cause, LineScript, most_baud},
    units::{Cycles, Instant},
};
use alloc::vec::Vec;

/// Bytes that are sent back to back from a cycle on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sent<'a> {
    /// Cycle in which the first start bit falls.
    pub start: Instant,
    /// The bytes.
    pub bytes: &'a [u8],
}

/// Everything that the host sends, rising in time and not overlapping.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Schedule {
    /// Start of each send, and the end of its bytes in `bytes`.
    sends: Vec<(Instant, usize)>,
    bytes: Vec<u8>,
}

impl Schedule {
    /// The schedule that a line script is. The script has been checked: its sends do not overlap.
    #[must_use]
    pub fn scripted(script: &LineScript) -> Self {
        let mut schedule = Self::default();
        for send in &script.sends {
            schedule.push(Instant(send.start_cycle), &send.wire());
        }
        schedule
    }

    /// Packets, one a tick of `tick` cycles, as the paced raw host sends them from `start` on.
    /// Whether the line can carry them is judged by [`carries`].
    #[must_use]
    pub fn paced(start: Instant, tick: Cycles, packets: impl Iterator<Item = impl AsRef<[u8]>>) -> Self {
        let mut schedule = Self::default();
        let mut start = start;
        for packet in packets {
            schedule.push(start, packet.as_ref());
            start += tick;
        }
        schedule
    }

    /// Adds a send, after all others.
    pub fn push(&mut self, start: Instant, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
        self.sends.push((start, self.bytes.len()));
    }

    /// How many sends there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.sends.len()
    }

    /// Whether nothing is sent.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sends.is_empty()
    }

    /// Bytes of all sends.
    #[must_use]
    pub fn total_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Send `index`, or `None` past the last.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<Sent<'_>> {
        let &(start, end) = self.sends.get(index)?;
        let first = index.checked_sub(1).and_then(|before| self.sends.get(before)).map_or(0, |s| s.1);
        self.bytes.get(first..end).map(|bytes| Sent { start, bytes })
    }

    /// All sends in order.
    pub fn iter(&self) -> impl Iterator<Item = Sent<'_>> {
        (0..self.len()).filter_map(|index| self.get(index))
    }
}

/// Judges whether what is sent for one tick, `bits` bit times at `baud`, fits in its cycles (A9).
///
/// # Errors
/// [`Cause::LineTooSlow`] where it does not, with the rate that would do.
pub fn carries(
    packet_cycles: u128,
    bits: u128,
    tick_cycles: u64,
    clock_hz: u32,
    baud: u32,
) -> Result<(), Cause> {
    let tick = u128::from(tick_cycles.max(1));
    if packet_cycles <= tick {
        return Ok(());
    }
    // What a message cannot tell exactly is more than any line can do.
    let told = |value: u128| u64::try_from(value).unwrap_or(u64::MAX);
    let (packet_cycles, needed_baud) =
        (told(packet_cycles), told((bits * u128::from(clock_hz)).div_ceil(tick)));
    let most_baud = u64::from(most_baud(clock_hz));
    Err(Cause::LineTooSlow { packet_cycles, tick_cycles, baud, needed_baud, most_baud })
}
