//! The level of the serial line (DESIGN A4): what the host sends, and what is forced upon it.
//!
//! ```text
//!  idle  start  d0    d1        d7   stop
//! ──────┐     ┌─────┬─────┬ ─ ┬─────┬─────
//!       └─────┴─────┴─────┴   ┴─────┘
//!       t0    |     |  bit k begins at t0 + floor(k*clock_hz/baud)
//! ```
//!
//! The line says its level and when it changes next, so a run can skip what lies between.

use super::Schedule;
use crate::{scenario::Forced, units::Instant};
use alloc::{collections::BTreeSet, rc::Rc, vec::Vec};

/// Bits of a byte on the line: start, eight data bits, stop.
const FRAME_BITS: usize = 10;

/// The line as a run walks along it.
#[derive(Clone, Debug)]
pub struct Line {
    sender: Sender,
    sender_level: bool,
    /// Disjoint, rising, all later than what has passed; the last one first.
    forced: Vec<Forced>,
    level: bool,
    next: Instant,
}

impl Line {
    /// The line before cycle 1: idle. A rate of 0 counts as 1 baud.
    #[must_use]
    pub fn new(schedule: Rc<Schedule>, forced: &[Forced], clock_hz: u32, baud: u32) -> Self {
        let mut forced = flatten(forced);
        forced.reverse();
        let sender = Sender::new(schedule, clock_hz, baud);
        let mut line = Self { sender, sender_level: true, forced, level: true, next: Instant::RESET };
        line.look_ahead();
        line
    }

    /// Level in the current cycle.
    #[must_use]
    pub const fn level(&self) -> bool {
        self.level
    }

    /// Cycle in which the level changes next; [`Instant::NEVER`] if it stays.
    #[must_use]
    pub const fn next_change(&self) -> Instant {
        self.next
    }

    /// Enters the cycle of [`Self::next_change`]: the level changes.
    #[inline(always)]
    pub fn change(&mut self) {
        self.level = !self.level;
        self.look_ahead();
    }

    /// Finds the next cycle in which the level that is heard differs from the current one.
    fn look_ahead(&mut self) {
        if self.forced.is_empty() && self.sender_level == self.level {
            self.next = self.sender.next_edge();
            if self.next != Instant::NEVER {
                self.sender_level = !self.sender_level;
                self.sender.pass();
            }
            return;
        }
        loop {
            let edge = self.sender.next_edge();
            let force = self
                .forced
                .last()
                .map_or(Instant::NEVER, |f| if self.next < f.start { f.start } else { f.end });
            let at = edge.min(force);
            if at == Instant::NEVER {
                self.next = Instant::NEVER;
                return;
            }
            if at == edge {
                self.sender_level = !self.sender_level;
                self.sender.pass();
            }
            self.next = at;
            while self.forced.last().is_some_and(|f| f.end <= at) {
                self.forced.pop();
            }
            let level = match self.forced.last() {
                Some(f) if f.start <= at => f.level,
                _ => self.sender_level,
            };
            if level != self.level {
                return;
            }
        }
    }
}

/// The edges of the bytes of a schedule.
#[derive(Clone, Debug)]
struct Sender {
    schedule: Rc<Schedule>,
    clock_hz: u64,
    baud: u64,
    /// floor(k*clock_hz/baud): where bit k begins.
    bit_starts: [u64; FRAME_BITS],
    send: usize,
    byte: usize,
    byte_start: Instant,
    /// Bits of the byte that differ from the bit before them and have not passed.
    edges: u16,
}

impl Sender {
    fn new(schedule: Rc<Schedule>, clock_hz: u32, baud: u32) -> Self {
        let (clock_hz, baud) = (u64::from(clock_hz), u64::from(baud.max(1)));
        let bit_starts = core::array::from_fn(|k| k as u64 * clock_hz / baud);
        let byte_start = Instant::NEVER;
        let mut sender =
            Self { schedule, clock_hz, baud, bit_starts, send: 0, byte: 0, byte_start, edges: 0 };
        sender.load();
        sender
    }

    /// Takes up the byte at (`send`, `byte`), or the first one after it.
    fn load(&mut self) {
        while let Some(send) = self.schedule.get(self.send) {
            if let Some(&byte) = send.bytes.get(self.byte) {
                let offset = 10 * self.byte as u64 * self.clock_hz / self.baud;
                self.byte_start = Instant(send.start.0 + offset);
                // Start bit 0, data, stop bit 1; before the start bit the line is high.
                let frame = u16::from(byte) << 1 | 1 << 9;
                self.edges = (frame ^ (frame << 1 | 1)) & 0x3ff;
                return;
            }
            self.send += 1;
            self.byte = 0;
        }
        self.edges = 0;
    }

    fn next_edge(&self) -> Instant {
        match self.bit_starts.get(self.edges.trailing_zeros() as usize) {
            Some(offset) => Instant(self.byte_start.0 + offset),
            None => Instant::NEVER,
        }
    }

    fn pass(&mut self) {
        self.edges &= self.edges.wrapping_sub(1);
        if self.edges == 0 {
            self.byte += 1;
            self.load();
        }
    }
}

/// Makes disjoint, rising spans of forced levels that overlap: the later entry wins.
fn flatten(forced: &[Forced]) -> Vec<Forced> {
    let mut bounds: Vec<(Instant, usize)> =
        forced.iter().enumerate().flat_map(|(i, f)| [(f.start, i), (f.end, i)]).collect();
    bounds.sort_unstable();
    let mut active = BTreeSet::new();
    let mut flat: Vec<Forced> = Vec::new();
    let mut from = Instant::RESET;
    for (at, index) in bounds {
        let top = active.last().and_then(|&i: &usize| forced.get(i));
        if let Some(top) = top
            && from < at
        {
            match flat.last_mut() {
                Some(last) if last.end == from && last.level == top.level => last.end = at,
                _ => flat.push(Forced { start: from, end: at, level: top.level }),
            }
        }
        from = at;
        if !active.remove(&index) {
            active.insert(index);
        }
    }
    flat
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Hex, LineScript, ScriptedSend};
    use alloc::vec;

    fn changes(sends: &[(u64, &[u8])], forced: &[(u64, u64, bool)], clock_hz: u32, baud: u32) -> Vec<u64> {
        let sends = sends
            .iter()
            .map(|(start, bytes)| ScriptedSend { start_cycle: *start, bytes: Hex(bytes.to_vec()) })
            .collect();
        let schedule = Schedule::scripted(&LineScript { sends });
        let forced: Vec<Forced> = forced
            .iter()
            .map(|&(start, length, level)| Forced {
                start: Instant(start),
                end: Instant(start + length),
                level,
            })
            .collect();
        let mut line = Line::new(Rc::new(schedule), &forced, clock_hz, baud);
        let mut found = vec![];
        while line.next_change() != Instant::NEVER {
            found.push(line.next_change().0);
            line.change();
        }
        assert!(line.level(), "the line ends idle");
        found
    }

    #[test]
    fn bits_begin_at_the_floor_of_their_exact_time() {
        // 10.5 cycles a bit: 0, 10, 21, 31, 42, 52, 63, 73, 84, 94, 105.
        let rows: &[(&[u8], &[u64])] = &[
            (&[0x00], &[1, 95]),
            (&[0xff], &[1, 11]),
            (&[0x55], &[1, 11, 22, 32, 43, 53, 64, 74, 85, 95]),
            (&[0xff, 0xff], &[1, 11, 106, 116]),
        ];
        for (bytes, expected) in rows {
            assert_eq!(changes(&[(1, bytes)], &[], 21, 2), *expected, "{bytes:?}");
        }
    }

    #[test]
    fn the_later_of_two_overlapping_glitches_wins() {
        type Row<'a> = (&'a [(u64, u64, bool)], &'a [u64]);
        let rows: &[Row<'_>] = &[
            (&[(5, 10, false)], &[5, 15]),
            (&[(5, 10, false), (8, 2, true)], &[5, 8, 10, 15]),
            (&[(8, 2, true), (5, 10, false)], &[5, 15]),
            (&[(5, 5, false), (10, 5, false)], &[5, 15]),
            (&[(5, 5, true)], &[]),
            (&[(5, 10, false), (5, 10, true)], &[]),
        ];
        for (forced, expected) in rows {
            assert_eq!(changes(&[], forced, 100, 10), *expected, "{forced:?}");
        }
    }

    #[test]
    fn a_glitch_within_a_byte_covers_what_is_sent() {
        // Start bit 100..110 and data 0x0f: high from 110 to 150, low to 190.
        assert_eq!(changes(&[(100, &[0x0f])], &[], 100, 10), [100, 110, 150, 190]);
        assert_eq!(changes(&[(100, &[0x0f])], &[(105, 10, true)], 100, 10), [100, 105, 150, 190]);
        assert_eq!(changes(&[(100, &[0x0f])], &[(110, 40, false)], 100, 10), [100, 190]);
        assert_eq!(changes(&[(100, &[0x0f])], &[(90, 200, true)], 100, 10), [0; 0]);
    }
}
