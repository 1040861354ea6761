//! The STEP and DIR lines of one tick, worked out when it starts (DESIGN A7).
//!
//! ```text
//! slot k starts at s = c0 + k*Ts
//!
//! per-channel DIR, simultaneous         common DIR, simultaneous
//! DIR   ═╳═══════════════  at c0        DIR   ─┐_________________┌────────
//! STEP  ─────┌────┐______               left  ─┼───┌────┐________│________
//!        | D |  W |                     right ─┼───│────│────────│───┌────┐
//!        s   rise fall                         s D   W       H     D    W
//!
//! staggered: the j-th pulse rises at s + D + j*d, d = min(dp, floor(Ts/nd)), nd firing channels
//! ```
//!
//! The plan is a list of (offset from c0, lines after it), so that running a tick is only iterating
//! over it. Successive ticks with the same commands share it.

use crate::{
    config::{Config, DirLine, Distribution, PulsePhasing},
    signal::{Levels, MAX_CHANNELS},
    wire::packet::{ChannelCommand, MAX_STEPS, Tick},
};
use alloc::vec::Vec;

/// STEP in bits 0..=15, DIR in bits 16..=31: the low half of a trace's levels.
pub(super) type Lines = u32;

/// STEP bits of [`Lines`].
pub(super) const STEPS: Lines = 0xffff;

/// The lines from `offset` cycles after the tick's start on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Change {
    pub(super) offset: u64,
    pub(super) lines: Lines,
}

/// The changes of one tick.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    config: Config,
    /// DIR of the channels in use, all right.
    all_right: Lines,
    commands: Tick,
    /// Invariant: offsets rise, none is beyond the tick's end; no two in a row have the same lines.
    changes: Vec<Change>,
}

impl Plan {
    pub(super) fn new(config: &Config) -> Self {
        let all_right = !(!0 << config.channels) << Levels::DIR_SHIFT;
        let commands = [0; MAX_CHANNELS];
        let mut plan = Self { config: config.clone(), all_right, commands, changes: Vec::new() };
        plan.rebuild();
        plan
    }

    /// The commands that the plan is of.
    pub(super) const fn commands(&self) -> &Tick {
        &self.commands
    }

    /// Whether any channel makes a step.
    pub(super) fn has_steps(&self) -> bool {
        self.commands.iter().any(|&byte| ChannelCommand::parse(byte).steps > 0)
    }

    /// Rising offsets. With a common DIR line the first change sets DIR: what it was before the
    /// tick does not matter.
    pub(super) fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Makes this the plan of `commands`.
    pub(super) fn set(&mut self, commands: Tick) {
        if commands != self.commands {
            self.commands = commands;
            self.rebuild();
        }
    }

    fn rebuild(&mut self) {
        let counts = self.commands.map(|byte| ChannelCommand::parse(byte).steps);
        let right = tops(halves(self.commands));
        let dir = Lines::from(right) << Levels::DIR_SHIFT & self.all_right;
        let firing = Firing::new(counts, self.config.slots, self.config.distribution);
        match (self.config.dir_line, self.config.pulse_phasing) {
            (DirLine::PerChannel, PulsePhasing::Simultaneous) => self.pulses(firing, dir),
            _ => self.slots(firing, dir, right),
        }
        debug_assert!(are_changes(&self.changes), "{:?}", self.changes);
        debug_assert!(
            self.changes.last().is_none_or(|last| last.offset <= self.config.tick().0),
            "a pulse ends after its tick"
        );
    }

    /// DIR at the tick's start, and in each slot one pulse of all that fire. Nearly all ticks are such: two places are written for
    /// every slot, and kept where any channel fires.
    fn pulses(&mut self, mut firing: Firing, dir: Lines) {
        let first = Change { offset: 0, lines: dir };
        self.changes.resize(1 + 2 * usize::from(self.config.slots), first);
        self.changes[0] = first;
        let (mut kept, mut rise) = (1, self.config.dir_setup);
        for slot in 0..self.config.slots {
            let fires = firing.slot(slot);
            if let Some([up, down]) = self.changes.get_mut(kept..).and_then(<[_]>::first_chunk_mut) {
                *up = Change { offset: rise, lines: dir | Lines::from(fires) };
                *down = Change { offset: rise + self.config.pulse_width, lines: dir };
            }
            kept += 2 * usize::from(fires != 0);
            rise += self.config.step_period;
        }
        self.changes.truncate(kept);
        // Without a setup time the first pulse may rise with DIR.
        if self.changes.get(1).is_some_and(|second| second.offset == 0) {
            self.changes.remove(0);
        }
    }

    /// What is not [`Self::pulses`], slot by slot.
    fn slots(&mut self, mut firing: Firing, dir: Lines, right: u16) {
        self.changes.clear();
        if self.config.dir_line == DirLine::PerChannel {
            self.push(0, dir);
        }
        for slot in 0..self.config.slots {
            let start = u64::from(slot) * self.config.step_period;
            match (firing.slot(slot), self.config.dir_line, self.config.pulse_phasing) {
                (0, ..) => {}
                (fires, DirLine::PerChannel, _) => self.staggered(start, fires, dir),
                (fires, DirLine::Common, PulsePhasing::Simultaneous) => self.common(start, fires, right),
                (fires, DirLine::Common, PulsePhasing::Staggered) => {
                    self.common_staggered(start, fires, right);
                }
            }
        }
    }

    /// All of `fires` from `rise` on, for W cycles; DIR stays at `dir`.
    fn pulse(&mut self, rise: u64, fires: u16, dir: Lines) {
        if fires != 0 {
            self.push(rise, dir | Lines::from(fires));
            self.push(rise + self.config.pulse_width, dir);
        }
    }

    /// From pulse to pulse of a slot: d = min(dp, floor(Ts/nd)).
    fn distance(&self, fires: u16) -> u64 {
        self.config.settle.min(self.config.step_period / u64::from(fires.count_ones().max(1)))
    }

    /// The left ones, then the right ones.
    fn common(&mut self, start: u64, fires: u16, right: u16) {
        let second = start + self.config.dir_setup + self.config.pulse_width + self.config.dir_hold;
        self.push(start, 0);
        self.pulse(start + self.config.dir_setup, fires & !right, 0);
        self.push(second, self.all_right);
        self.pulse(second + self.config.dir_setup, fires & right, self.all_right);
    }

    /// One channel after another, ascending; pulses that are closer than W overlap.
    fn staggered(&mut self, start: u64, fires: u16, dir: Lines) {
        let (distance, width) = (self.distance(fires), self.config.pulse_width);
        let first = start + self.config.dir_setup;
        let pulses = || channels(fires).zip(0_u64..).map(|(bit, j)| (bit, first + j * distance));
        let (mut rises, mut falls) = (pulses().peekable(), pulses().peekable());
        let mut lines = dir;
        while let Some(&(bit, rise)) = falls.peek() {
            match rises.next_if(|&(_, next)| next <= rise + width) {
                Some((bit, rise)) => {
                    lines |= bit;
                    self.push(rise, lines);
                }
                None => {
                    lines &= !bit;
                    falls.next();
                    self.push(rise + width, lines);
                }
            }
        }
    }

    /// The left ones ascending, then the right ones ascending; L <= d, so no two pulses meet.
    fn common_staggered(&mut self, start: u64, fires: u16, right: u16) {
        let distance = self.distance(fires);
        let order = channels(fires & !right).zip([0].into_iter().cycle());
        let order = order.chain(channels(fires & right).zip([self.all_right].into_iter().cycle()));
        for ((bit, dir), j) in order.zip(0_u64..) {
            let at = start + j * distance;
            self.push(at, dir);
            self.push(at + self.config.dir_setup, dir | bit);
            self.push(at + self.config.dir_setup + self.config.pulse_width, dir);
        }
    }

    /// Adds what is a change; of several at the same offset the last counts.
    fn push(&mut self, offset: u64, lines: Lines) {
        match self.changes.last_mut() {
            Some(last) if last.offset == offset => last.lines = lines,
            Some(last) if last.lines == lines => {}
            _ => self.changes.push(Change { offset, lines }),
        }
    }
}

/// Whether offsets rise and each entry changes the lines.
fn are_changes(changes: &[Change]) -> bool {
    changes.is_sorted_by(|one, next| one.offset < next.offset && one.lines != next.lines)
}

/// The STEP bits of `fires` one by one, ascending.
fn channels(fires: u16) -> impl Iterator<Item = Lines> {
    (0..MAX_CHANNELS).map(|channel| 1 << channel).filter(move |bit| Lines::from(fires) & bit != 0)
}

/// Which channels fire in a slot.
///
/// `spread` fires in slot k if floor(((k+1)*c + h)/M) > floor((k*c + h)/M), h = floor(M/2): each
/// channel keeps r = (k*c + h) mod M and fires if r >= M - c. `burst` fires if k < c.
///
/// Eight channels go side by side in one number, a byte each. r, c, k and M are at most 127: with bit
/// 7 set beforehand a subtraction takes nothing from the byte above, and bit 7 is left where it
/// did not go below 0.
struct Firing {
    /// c of each channel, and r.
    counts: [u64; 2],
    remainders: [u64; 2],
    /// M in each byte.
    slots: u64,
    distribution: Distribution,
}

/// A 1 in each byte.
const ONES: u64 = u64::from_le_bytes([1; 8]);
/// Bit 7 of each byte.
const TOPS: u64 = ONES << 7;
// A byte of the numbers above has room for a count, and for bit 7.
const _: () = assert!(MAX_STEPS == 0x7f && TOPS & (ONES * MAX_STEPS as u64) == 0);

impl Firing {
    fn new(counts: [u8; MAX_CHANNELS], slots: u8, distribution: Distribution) -> Self {
        debug_assert!((1..=MAX_STEPS).contains(&slots), "{slots} slots in a tick");
        debug_assert!(counts.iter().all(|&count| count <= slots), "{counts:?} in {slots} slots");
        let remainders = [u64::from(slots / 2) * ONES; 2];
        Self { counts: halves(counts), remainders, slots: u64::from(slots) * ONES, distribution }
    }

    /// The channels that fire in slot `slot`; slots are asked for in order.
    #[inline(always)]
    fn slot(&mut self, slot: u8) -> u16 {
        match self.distribution {
            // c - (k + 1) >= 0
            Distribution::Burst => {
                let slot = (u64::from(slot) + 1) * ONES;
                tops(self.counts.map(|counts| (counts | TOPS) - slot))
            }
            // r - (M - c) >= 0, which then is the next r; that of the others is M more.
            Distribution::Spread => {
                let [low, high] = self.counts;
                let [first, second] = &mut self.remainders;
                tops([Self::spread(first, low, self.slots), Self::spread(second, high, self.slots)])
            }
        }
    }

    /// Goes on to the next slot; who fires has bit 7.
    #[inline(always)]
    const fn spread(remainders: &mut u64, counts: u64, slots: u64) -> u64 {
        let rest = (*remainders | TOPS) - (slots - counts);
        let rests = !rest & TOPS;
        // M where none fires: the lower bits of those bytes are taken from it.
        let more = (rests - (rests >> 7)) & slots;
        *remainders = (rest + more) & !TOPS;
        rest
    }
}

/// Of channels 0 to 7, and of 8 to 15.
fn halves(bytes: [u8; MAX_CHANNELS]) -> [u64; 2] {
    let both = u128::from_le_bytes(bytes);
    [both as u64, (both >> 64) as u64]
}

/// Bit i of the result is bit 7 of byte i.
///
/// The multiplication moves byte i's bit to bit 56 + i; no two of them meet.
fn tops([low, high]: [u64; 2]) -> u16 {
    let half = |bytes: u64| ((bytes >> 7 & ONES).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u16;
    half(low) | half(high) << 8
}

#[cfg(test)]
mod tests;
