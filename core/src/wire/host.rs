//! The host's sends: bytes at cycles (DESIGN A9).
//!
//! A line script is such a schedule itself; packets, and motions through their packets, are paced:
//! packet j starts at boot + 1 + j*M*Ts, so tick follows tick without a pause.

use crate::{
    scenario::{Cause, Config, LineScript, line_time, most_baud},
    units::Instant,
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
            schedule.push(Instant(send.start_cycle), &send.bytes.0);
        }
        schedule
    }

    /// Packets of `packet_len` bytes, one a tick, as the paced raw host sends them. Whether the
    /// line can carry them is judged by [`carries`].
    #[must_use]
    pub fn paced(config: &Config, packets: impl Iterator<Item = impl AsRef<[u8]>>) -> Self {
        let mut schedule = Self::default();
        let mut start = config.boot.next();
        for packet in packets {
            schedule.push(start, packet.as_ref());
            start += config.tick();
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

/// Judges whether a line of `baud` carries a packet a tick (A9).
///
/// # Errors
/// [`Cause::LineTooSlow`] where a packet takes longer than a tick, with the rate that would do.
pub fn carries(config: &Config, baud: u32) -> Result<(), Cause> {
    let tick_cycles = config.tick().0;
    let bytes = config.packet_len() as u64;
    let packet_cycles = line_time(bytes, config.clock_hz, baud);
    if packet_cycles <= tick_cycles {
        return Ok(());
    }
    let needed_baud = (10 * bytes * u64::from(config.clock_hz)).div_ceil(tick_cycles);
    let most_baud = u64::from(most_baud(config.clock_hz));
    Err(Cause::LineTooSlow { packet_cycles, tick_cycles, baud, needed_baud, most_baud })
}
