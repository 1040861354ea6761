//! The level of the serial line (DESIGN A4, A9): a forced level, else the AND of all senders. [`Line::next_change`] lets a
//! run skip the cycles between changes.
//!
//! ```
//! use std::sync::Arc;
//! use stepscope_peripheral::{config::{Bus, Config, SerialLine}, device::{Device, Faults}, signal::Record,
//!     units::{Cycles, Instant}, wire::{ForcedLevel, Line, Schedule}};
//!
//! // A packet of one channel, and a break over its stop bit.
//! let host = Schedule::paced(Instant(2000), Cycles(32_000), [[0x85]].iter());
//! let broken = ForcedLevel { start: Instant(2000), end: Instant(5000), level: false };
//! let mut line = Line::new(Arc::new(host), &[broken], 16_000_000, 115_200);
//!
//! let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
//! let (mut device, mut trace) = (Device::new(&config), Vec::<Record>::new());
//! // From change to change of the line; the device does not reply.
//! while device.now() < Instant(20_000) {
//!     let next = line.next_change().min(Instant(20_000));
//!     device.run(line.level(true), next, &mut trace);
//!     if next == line.next_change() {
//!         line.change();
//!     }
//! }
//! assert_eq!(device.faults(), Faults::FRAMING);
//! ```

use crate::units::Instant;
use crate::wire::{Schedule, sender::Sender};
use alloc::{collections::BTreeSet, sync::Arc, vec::Vec};

/// A level that a fault forces on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ForcedLevel {
    /// First cycle with this level.
    pub start: Instant,
    /// The cycle after the last one, later than `start`.
    pub end: Instant,
    pub level: bool,
}

impl ForcedLevel {
    fn ends_by(self, cycle: Instant) -> bool {
        self.end <= cycle
    }
}

/// The serial line with its host.
#[derive(Clone, Debug)]
pub struct Line {
    sender: Sender,
    /// Invariant: disjoint and rising.
    forced: Arc<Vec<ForcedLevel>>,
    ended: usize,
    /// The level forced in the current cycle.
    force: Option<bool>,
    next: Instant,
    /// Next change of the level while no controller sends; [`Instant::RESET`] without future forced levels. It may be
    /// later than `next`, because a forced level may equal the line's own.
    next_level_change: Instant,
}

impl Line {
    /// The line before cycle 1, idle. A rate of 0 counts as 1 baud.
    pub fn new(schedule: Arc<Schedule>, forced: &[ForcedLevel], clock_hz: u32, baud: u32) -> Self {
        let sender = Sender::new(schedule, clock_hz, baud);
        let mut line = Self {
            sender,
            forced: Arc::new(flatten(forced)),
            ended: 0,
            force: None,
            next: Instant::NEVER,
            next_level_change: Instant::NEVER,
        };
        line.schedule_next();
        line.find_level_change();
        line
    }

    pub fn schedule(&self) -> &Schedule {
        self.sender.schedule()
    }

    /// Adds a send after all others.
    pub fn send(&mut self, start: Instant, bytes: &[u8]) {
        self.sender.send(start, bytes);
        self.schedule_next();
        self.find_level_change();
    }

    /// Adds bytes to the last send. The first byte must not begin before the next cycle.
    pub fn extend(&mut self, bytes: &[u8]) {
        self.sender.extend(bytes);
        self.schedule_next();
        self.find_level_change();
    }

    /// Removes past sends, to bound the memory of an endless line.
    pub fn forget_sent(&mut self) {
        self.sender.forget_sent();
    }

    /// Forces a level in future cycles; it replaces levels forced before.
    pub fn force(&mut self, new: ForcedLevel) {
        let forced = Arc::make_mut(&mut self.forced);
        let first = forced.partition_point(|one| one.ends_by(new.start));
        let end = forced.partition_point(|one| !new.ends_by(one.start));
        let overlapping = forced.get(first..end).unwrap_or_default();
        let before = overlapping.first().filter(|one| one.start < new.start);
        let after = overlapping.last().filter(|one| one.end > new.end);
        let before = before.map(|one| ForcedLevel { end: new.start, ..*one });
        let after = after.map(|one| ForcedLevel { start: new.end, ..*one });
        forced.splice(first..end, [before, Some(new), after].into_iter().flatten());
        let around = first.saturating_sub(1)..forced.len().min(first + 4);
        debug_assert!(
            is_flat(forced.get(around).unwrap_or_default()),
            "{new:?} overlaps what was forced before"
        );
        self.schedule_next();
        self.find_level_change();
    }

    /// Forced levels, past and future, rising in time and disjoint.
    pub fn forced(&self) -> &[ForcedLevel] {
        &self.forced
    }

    /// The level in the current cycle while all controllers together send `others`.
    pub fn level(&self, others: bool) -> bool {
        self.force.unwrap_or(self.sender.level() && others)
    }

    /// The level that the host receives, without its own, while controllers send `others`.
    pub fn host_level(&self, others: bool) -> bool {
        self.force.unwrap_or(others)
    }

    /// Whether the host drives the line low.
    pub const fn is_pulled_low(&self) -> bool {
        !self.sender.level()
    }

    /// Next cycle in which the host's or a forced level changes; [`Instant::NEVER`] without one.
    pub const fn next_change(&self) -> Instant {
        self.next
    }

    /// Whether the level no longer changes while no controller sends.
    pub fn is_over(&self) -> bool {
        self.next == Instant::NEVER || self.next_level_change == Instant::NEVER
    }

    fn find_level_change(&mut self) {
        if self.ended == self.forced.len() {
            self.next_level_change = Instant::RESET;
            return;
        }
        let (mut ahead, level) = (self.clone(), self.level(true));
        self.next_level_change = loop {
            let now = ahead.next;
            if now == Instant::NEVER {
                break now;
            }
            ahead.enter_cycle(now);
            if ahead.level(true) != level {
                break now;
            }
        };
    }

    /// Enters the cycle of [`Self::next_change`].
    pub fn change(&mut self) {
        let now = self.next;
        self.enter_cycle(now);
        if now == self.next_level_change {
            self.find_level_change();
        }
    }

    fn enter_cycle(&mut self, now: Instant) {
        debug_assert!(now == self.next && now != Instant::NEVER, "nothing changes in {now:?}");
        if self.sender.next_edge() == now {
            self.sender.pass();
        }
        if self.ended < self.forced.len() {
            self.update_forced(now);
        }
        self.schedule_next();
    }

    fn update_forced(&mut self, now: Instant) {
        while self.forced.get(self.ended).is_some_and(|forced| forced.ends_by(now)) {
            self.ended += 1;
        }
        if self.ended == self.forced.len() {
            self.next_level_change = Instant::RESET;
        }
        self.force =
            self.forced.get(self.ended).filter(|forced| forced.start <= now).map(|forced| forced.level);
    }

    fn schedule_next(&mut self) {
        let force = self
            .forced
            .get(self.ended)
            .map_or(Instant::NEVER, |forced| if self.force.is_some() { forced.end } else { forced.start });
        self.next = self.sender.next_edge().min(force);
    }
}

/// Makes overlapping levels disjoint and rising; the later entry wins.
fn flatten(forced: &[ForcedLevel]) -> Vec<ForcedLevel> {
    let mut bounds: Vec<(Instant, usize)> =
        forced.iter().enumerate().flat_map(|(i, f)| [(f.start, i), (f.end, i)]).collect();
    bounds.sort_unstable();
    let mut active = BTreeSet::new();
    let mut flat: Vec<ForcedLevel> = Vec::new();
    let mut from = Instant::RESET;
    for (at, index) in bounds {
        let top = active.last().and_then(|&i: &usize| forced.get(i));
        if let Some(top) = top
            && from < at
        {
            match flat.last_mut() {
                Some(last) if last.end == from && last.level == top.level => last.end = at,
                _ => flat.push(ForcedLevel { start: from, end: at, level: top.level }),
            }
        }
        from = at;
        if !active.remove(&index) {
            active.insert(index);
        }
    }
    debug_assert!(is_flat(&flat), "spans overlap");
    flat
}

fn is_flat(forced: &[ForcedLevel]) -> bool {
    forced.iter().all(|one| one.start < one.end) && forced.is_sorted_by(|one, next| one.ends_by(next.start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn changes(sends: &[(u64, &[u8])], forced: &[(u64, u64, bool)], clock_hz: u32, baud: u32) -> Vec<u64> {
        let mut schedule = Schedule::default();
        sends.iter().for_each(|(start, bytes)| schedule.push(Instant(*start), bytes));
        let forced: Vec<ForcedLevel> = forced
            .iter()
            .map(|&(start, length, level)| ForcedLevel {
                start: Instant(start),
                end: Instant(start + length),
                level,
            })
            .collect();
        let mut line = Line::new(Arc::new(schedule), &forced, clock_hz, baud);
        let mut found = vec![];
        let mut level = true;
        while !line.is_over() {
            let at = line.next_change();
            line.change();
            if line.level(true) != level {
                level = !level;
                found.push(at.0);
            }
        }
        assert!(line.level(true), "the line ends idle");
        found
    }

    #[test]
    fn bit_times_are_rounded_down() {
        // 10.5 cycles per bit: 0, 10, 21, 31, 42, 52, 63, 73, 84, 94, 105.
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
    fn a_level_forced_during_the_run_replaces_earlier_ones() {
        let span = |(start, length, level)| ForcedLevel {
            start: Instant(start),
            end: Instant(start + length),
            level,
        };
        type Row<'a> = (&'a [(u64, u64, bool)], (u64, u64, bool), &'a [(u64, u64, bool)]);
        let rows: &[Row<'_>] = &[
            (&[], (20, 5, false), &[(20, 5, false)]),
            (&[(50, 5, false)], (20, 5, true), &[(20, 5, true), (50, 5, false)]),
            (&[(50, 5, false)], (60, 5, true), &[(50, 5, false), (60, 5, true)]),
            (&[(50, 5, false)], (45, 5, true), &[(45, 5, true), (50, 5, false)]),
            (&[(50, 9, false)], (52, 2, true), &[(50, 2, false), (52, 2, true), (54, 5, false)]),
            (&[(50, 9, false)], (45, 9, true), &[(45, 9, true), (54, 5, false)]),
            (&[(50, 9, false)], (55, 9, true), &[(50, 5, false), (55, 9, true)]),
            (&[(50, 2, false), (60, 2, true)], (40, 40, true), &[(40, 40, true)]),
        ];
        for (before, new, expected) in rows {
            let before: Vec<ForcedLevel> = before.iter().copied().map(span).collect();
            let mut line = Line::new(Arc::new(Schedule::default()), &before, 100, 10);
            line.force(span(*new));
            let expected: Vec<ForcedLevel> = expected.iter().copied().map(span).collect();
            assert_eq!(line.forced(), expected, "{before:?} {new:?}");
            let low = |at| expected.iter().any(|one| !one.level && one.start <= at && at < one.end);
            let expected_changes: Vec<u64> =
                (1..100).filter(|&at| low(Instant(at)) != low(Instant(at - 1))).collect();
            let (mut changes, mut level) = (Vec::new(), true);
            while line.next_change() != Instant::NEVER {
                assert_eq!(
                    line.is_over(),
                    changes.len() == expected_changes.len(),
                    "{before:?} {new:?} {changes:?}"
                );
                let at = line.next_change();
                line.change();
                if core::mem::replace(&mut level, line.level(true)) != line.level(true) {
                    changes.push(at.0);
                }
            }
            assert_eq!(changes, expected_changes, "{before:?} {new:?}");
        }
    }

    #[test]
    fn a_glitch_replaces_the_level_of_a_byte() {
        // Start bit 100..110 and data 0x0f: high from 110 to 150, low to 190.
        assert_eq!(changes(&[(100, &[0x0f])], &[], 100, 10), [100, 110, 150, 190]);
        assert_eq!(changes(&[(100, &[0x0f])], &[(105, 10, true)], 100, 10), [100, 105, 150, 190]);
        assert_eq!(changes(&[(100, &[0x0f])], &[(110, 40, false)], 100, 10), [100, 190]);
        assert_eq!(changes(&[(100, &[0x0f])], &[(90, 200, true)], 100, 10), [0; 0]);
    }
}
