//! The level of the serial line (DESIGN A4, A9): what the host sends, what controllers reply, and
//! what is forced upon it.
//!
//! A level that is forced is heard whatever is sent; else the line is the AND of all that send. The
//! line tells when what the host sends or what is forced changes next, so a run can skip what lies
//! between.

use super::{Schedule, sender::Sender};
use crate::{scenario::Forced, units::Instant};
use alloc::{collections::BTreeSet, rc::Rc, vec::Vec};

/// The line as a run walks along it.
#[derive(Clone, Debug)]
pub struct Line {
    sender: Sender,
    /// Disjoint and rising; those before `passed` are over.
    forced: Rc<Vec<Forced>>,
    passed: usize,
    /// The level that is forced now.
    force: Option<bool>,
    next: Instant,
}

impl Line {
    /// The line before cycle 1: idle. A rate of 0 counts as 1 baud.
    #[must_use]
    pub fn new(schedule: Rc<Schedule>, forced: &[Forced], clock_hz: u32, baud: u32) -> Self {
        let sender = Sender::new(schedule, clock_hz, baud);
        let mut line =
            Self { sender, forced: Rc::new(flatten(forced)), passed: 0, force: None, next: Instant::NEVER };
        line.look_ahead();
        line
    }

    /// What the host has sent and will send, as far as it is known.
    #[must_use]
    pub fn schedule(&self) -> &Schedule {
        self.sender.schedule()
    }

    /// Adds a send, after all that were added before.
    pub fn send(&mut self, start: Instant, bytes: &[u8]) {
        self.sender.send(start, bytes);
        self.look_ahead();
    }

    /// Forces a level from `forced.start` on, after all that was forced before.
    pub fn force(&mut self, forced: Forced) {
        Rc::make_mut(&mut self.forced).push(forced);
        self.look_ahead();
    }

    /// Level in the current cycle as one hears it while all others together send `others`.
    #[must_use]
    #[inline(always)]
    pub fn heard(&self, others: bool) -> bool {
        self.force.unwrap_or(self.sender.level() && others)
    }

    /// Level in the current cycle as the host hears it: what controllers send, or what is forced.
    #[must_use]
    pub fn replied(&self, others: bool) -> bool {
        self.force.unwrap_or(others)
    }

    /// Whether the host holds the line low.
    #[must_use]
    pub const fn is_pulled_low(&self) -> bool {
        !self.sender.level()
    }

    /// Next cycle in which what the host sends or what is forced changes; [`Instant::NEVER`] if
    /// neither does.
    #[must_use]
    #[inline(always)]
    pub const fn next_change(&self) -> Instant {
        self.next
    }

    /// Whether no change is left that anyone hears while no controller sends.
    #[must_use]
    #[inline(always)]
    pub fn is_over(&self) -> bool {
        if self.passed == self.forced.len() { self.next == Instant::NEVER } else { self.stays() }
    }

    /// Whether what is left to be forced changes nothing.
    fn stays(&self) -> bool {
        let (mut ahead, level) = (self.clone(), self.heard(true));
        while ahead.next != Instant::NEVER {
            ahead.change();
            if ahead.heard(true) != level {
                return false;
            }
        }
        true
    }

    /// Enters the cycle of [`Self::next_change`].
    #[inline(always)]
    pub fn change(&mut self) {
        let now = self.next;
        if self.sender.next_edge() == now {
            self.sender.pass();
        }
        if self.passed < self.forced.len() {
            self.follow_forced(now);
        }
        self.look_ahead();
    }

    fn follow_forced(&mut self, now: Instant) {
        while self.forced.get(self.passed).is_some_and(|forced| forced.end <= now) {
            self.passed += 1;
        }
        self.force =
            self.forced.get(self.passed).filter(|forced| forced.start <= now).map(|forced| forced.level);
    }

    #[inline(always)]
    fn look_ahead(&mut self) {
        let force = self
            .forced
            .get(self.passed)
            .map_or(Instant::NEVER, |forced| if self.force.is_some() { forced.end } else { forced.start });
        self.next = self.sender.next_edge().min(force);
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
            .map(|(start, bytes)| ScriptedSend {
                start_cycle: *start,
                bytes: Hex(bytes.to_vec()),
                frame: None,
            })
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
        let mut level = true;
        while !line.is_over() {
            let at = line.next_change();
            line.change();
            if line.heard(true) != level {
                level = !level;
                found.push(at.0);
            }
        }
        assert!(line.heard(true), "the line ends idle");
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
