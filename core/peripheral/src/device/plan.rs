//! Plans STEP and DIR of one tick when it starts (DESIGN A7).
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
//! staggered: the j-th pulse rises at s + D + j*d, d = min(dp, floor(Ts/nd)), with nd channels that step
//! ```

use crate::config::{Config, DirLine, Distribution, PulsePhasing};
use crate::signal::{Levels, MAX_CHANNELS};
use crate::wire::packet::{ChannelCommand, Tick};
use crate::{segment::PulseTimes, units::Cycles};
use alloc::vec::Vec;

/// STEP in bits 0..=15, DIR in bits 16..=31, as in a trace's levels.
pub(super) type Lines = u32;

pub(super) const STEPS: Lines = 0xffff;

/// The levels from `offset` cycles after the start of the tick on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Change {
    pub(super) offset: u64,
    pub(super) lines: Lines,
}

#[derive(Clone, Debug)]
pub(super) struct Plan {
    config: Config,
    pulse: PulseTimes,
    all_right: Lines,
    commands: Tick,
    /// Invariant: offsets rise and stay within the tick; no two in a row have the same lines.
    changes: Vec<Change>,
}

impl Plan {
    pub(super) fn new(config: &Config) -> Self {
        let mut plan = Self {
            config: config.clone(),
            pulse: PulseTimes::from(config),
            all_right: !(!0 << config.channels()) << Levels::DIR_SHIFT,
            commands: [0; MAX_CHANNELS],
            changes: Vec::new(),
        };
        plan.rebuild();
        plan
    }

    pub(super) fn has_steps(&self) -> bool {
        self.commands.iter().any(|&byte| ChannelCommand::parse(byte).steps > 0)
    }

    /// The first entry may repeat the current levels.
    pub(super) fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Plans a tick. Consecutive ticks often have the same commands and then share the plan.
    pub(super) fn set(&mut self, commands: Tick) {
        if commands != self.commands {
            self.commands = commands;
            self.rebuild();
        }
    }

    fn rebuild(&mut self) {
        self.changes.clear();
        let right = mask(self.commands.map(|byte| ChannelCommand::parse(byte).right));
        let dir = Lines::from(right) << Levels::DIR_SHIFT & self.all_right;
        let (slots, dir_line) = (self.config.slots(), self.config.bus().dir_line);
        if dir_line == DirLine::PerChannel {
            self.push(0, dir);
        }
        let mut firing = Firing::new(&self.commands, slots, self.config.bus().distribution);
        for slot in 0..slots {
            let start = u64::from(slot) * self.config.step_period();
            let fires = firing.slot(slot);
            match (dir_line, self.config.bus().pulse_phasing) {
                _ if fires == 0 => {}
                (DirLine::PerChannel, PulsePhasing::Simultaneous) => {
                    self.add_pulse(start + self.pulse.setup.0, fires, dir);
                }
                (DirLine::PerChannel, PulsePhasing::Staggered) => self.add_staggered(start, fires, dir),
                (DirLine::Common, PulsePhasing::Simultaneous) => self.add_common(start, fires, right),
                (DirLine::Common, PulsePhasing::Staggered) => self.add_common_staggered(start, fires, right),
            }
        }
        debug_assert!(
            self.changes.is_sorted_by(|one, next| one.offset < next.offset && one.lines != next.lines),
            "{:?}",
            self.changes
        );
        debug_assert!(
            self.changes.last().is_none_or(|last| Cycles(last.offset) <= self.config.tick()),
            "a pulse ends after its tick"
        );
    }

    /// A pulse on the channels of `fires`; DIR stays at `dir`.
    fn add_pulse(&mut self, rise: u64, fires: u16, dir: Lines) {
        if fires != 0 {
            self.push(rise, dir | Lines::from(fires));
            self.push(rise + self.pulse.width.0, dir);
        }
    }

    /// d: time between staggered pulses.
    fn stagger_cycles(&self, fires: u16) -> u64 {
        u64::from(self.config.bus().settle_cycles)
            .min(self.config.step_period() / u64::from(fires.count_ones().max(1)))
    }

    /// The channels to the left, then those to the right.
    fn add_common(&mut self, start: u64, fires: u16, right: u16) {
        let PulseTimes { width, setup, hold } = self.pulse;
        let second = start + setup.0 + width.0 + hold.0;
        self.push(start, 0);
        self.add_pulse(start + setup.0, fires & !right, 0);
        self.push(second, self.all_right);
        self.add_pulse(second + setup.0, fires & right, self.all_right);
    }

    /// One channel after another in ascending order; pulses closer than W overlap.
    fn add_staggered(&mut self, start: u64, fires: u16, dir: Lines) {
        let (distance, width) = (self.stagger_cycles(fires), self.pulse.width.0);
        let first = start + self.pulse.setup.0;
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

    /// Channels to the left, then to the right, each in ascending order; L <= d, so pulses do not overlap.
    fn add_common_staggered(&mut self, start: u64, fires: u16, right: u16) {
        let (distance, all_right) = (self.stagger_cycles(fires), self.all_right);
        let left = channels(fires & !right).map(|bit| (bit, 0));
        let sequence = left.chain(channels(fires & right).map(|bit| (bit, all_right)));
        for ((bit, dir), j) in sequence.zip(0_u64..) {
            let at = start + j * distance;
            self.push(at, dir);
            self.add_pulse(at + self.pulse.setup.0, bit as u16, dir);
        }
    }

    fn push(&mut self, offset: u64, lines: Lines) {
        match self.changes.last_mut() {
            Some(last) if last.offset == offset => last.lines = lines,
            Some(last) if last.lines == lines => {}
            _ => self.changes.push(Change { offset, lines }),
        }
    }
}

/// Distributes the steps of each channel over the slots of a tick.
struct Firing {
    counts: [u8; MAX_CHANNELS],
    slots: u8,
    distribution: Distribution,
    /// (k*c + h) mod M of each channel: with `Spread` it steps in slot k if floor(((k+1)*c + h)/M) >
    /// floor((k*c + h)/M), where c is its count, M the slots and h = floor(M/2).
    remainders: [u8; MAX_CHANNELS],
}

impl Firing {
    fn new(commands: &Tick, slots: u8, distribution: Distribution) -> Self {
        let counts = commands.map(|byte| ChannelCommand::parse(byte).steps);
        Self { counts, slots, distribution, remainders: [slots / 2; MAX_CHANNELS] }
    }

    /// The channels that step in `slot`; call it for each slot in order.
    fn slot(&mut self, slot: u8) -> u16 {
        let mut fires = [false; MAX_CHANNELS];
        for ((fires, count), remainder) in fires.iter_mut().zip(self.counts).zip(&mut self.remainders) {
            *fires = match self.distribution {
                Distribution::Burst => slot < count,
                Distribution::Spread => {
                    let next = *remainder + count;
                    *remainder = if next >= self.slots { next - self.slots } else { next };
                    next >= self.slots
                }
            };
        }
        mask(fires)
    }
}

/// Channel 0 in bit 0.
fn mask(channels: [bool; MAX_CHANNELS]) -> u16 {
    (0..).zip(channels).map(|(channel, is_set)| u16::from(is_set) << channel).sum()
}

/// The STEP line of each channel in `fires`.
fn channels(fires: u16) -> impl Iterator<Item = Lines> {
    (0..MAX_CHANNELS).map(|channel| 1 << channel).filter(move |bit| Lines::from(fires) & bit != 0)
}

#[cfg(test)]
mod tests;
