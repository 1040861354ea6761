//! The bus: A3's records as changes, and records made from A8's segments and from F7's self-test.

use std::collections::BTreeMap;

/// EN's bit of a record's levels.
pub const EN: u32 = 32;
/// DIR of channel 0.
pub const DIR: u32 = 16;
/// EN = RX = TX = 1, all else 0: the reset state (A3).
pub const RESET: u64 = 1 << 32 | 1 << 33 | 1 << 34;

/// One entry of a channel's list (A8); `interval`, `add` and `dwell` are in 1/65536 cycle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Segment {
    /// `steps` steps, the first `interval` after the previous event, each next interval `add` longer.
    Steps {
        /// At least 1.
        steps: u32,
        /// 48.16 cycles.
        interval: u64,
        /// 48.16 cycles per step.
        add: i64,
        /// DIR during these steps.
        dir: bool,
    },
    /// A pause of this length.
    Dwell(u64),
}

impl Segment {
    /// Steps with `interval` and `add` in whole cycles.
    pub fn whole(steps: u32, interval: u64, add: i64, dir: bool) -> Self {
        Self::Steps { steps, interval: interval << 16, add: add << 16, dir }
    }
}

/// A cycle with a change that affects the plant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Change {
    pub(super) cycle: u64,
    /// Channels whose STEP rises.
    pub(super) rises: u16,
    /// DIR of all channels in this cycle.
    pub(super) dirs: u16,
    /// EN from this cycle on.
    pub(super) en: bool,
}

/// EN at cycle 0.
pub(super) fn starts_enabled(records: &[(u64, u64)]) -> bool {
    records.first().is_none_or(|&(_, levels)| levels >> EN & 1 == 1)
}

/// The records after the first as changes.
pub(super) fn changes(records: &[(u64, u64)]) -> Vec<Change> {
    let of = |pair: &[(u64, u64)]| {
        let (before, (cycle, levels)) = (pair[0].1, pair[1]);
        Change {
            cycle,
            rises: (levels & !before) as u16,
            dirs: (levels >> DIR) as u16,
            en: levels >> EN & 1 == 1,
        }
    };
    records.windows(2).map(of).collect()
}

/// The cycles in which EN rises.
pub(super) fn enable_rises(changes: &[Change], starts_enabled: bool) -> Vec<u64> {
    let mut en = starts_enabled;
    let mut rises = Vec::new();
    for change in changes {
        if change.en && !en {
            rises.push(change.cycle);
        }
        en = change.en;
    }
    rises
}

/// Changes of levels, in any order.
#[derive(Debug, Clone, Default)]
pub struct Bus {
    /// Bits to set and bits to clear in a cycle.
    orders: BTreeMap<u64, (u64, u64)>,
}

impl Bus {
    /// From `cycle` on the bit has this level. Within a cycle, the later call for a bit wins.
    pub fn order(&mut self, cycle: u64, bit: u32, level: bool) {
        let (set, clear) = self.orders.entry(cycle).or_default();
        let mask = 1 << bit;
        *set &= !mask;
        *clear &= !mask;
        *(if level { set } else { clear }) |= mask;
    }

    /// A pulse of STEP: rises at `rise`, falls `width` cycles later.
    pub fn pulse(&mut self, channel: usize, rise: u64, width: u64) {
        self.order(rise, channel as u32, true);
        self.order(rise + width, channel as u32, false);
    }

    /// A3's records of the cycles 0..cycles.
    pub fn records(&self, cycles: u64) -> Vec<(u64, u64)> {
        let mut levels = RESET;
        let mut records = vec![(0, RESET)];
        for (&cycle, &(set, clear)) in &self.orders {
            let after = levels & !clear | set;
            if cycle < cycles && after != levels {
                records.push((cycle, after));
                levels = after;
            }
        }
        records
    }
}

/// A8: a list (start cycle, segments) per channel from 0 on. The lists must be valid; D and H are 0.
pub fn segment_bus(lists: &[(u64, Vec<Segment>)], width: u64) -> Bus {
    let mut bus = Bus::default();
    for (channel, (start_cycle, list)) in lists.iter().enumerate() {
        let mut next = start_cycle << 16;
        let mut last_fall = 0;
        let mut dir_so_far = false;
        for segment in list {
            match *segment {
                Segment::Dwell(dwell) => next += dwell,
                Segment::Steps { steps, interval, add, dir } => {
                    if dir != dir_so_far {
                        bus.order((next >> 16).max(last_fall), DIR + channel as u32, dir);
                        dir_so_far = dir;
                    }
                    let mut interval = interval;
                    for _ in 0..steps {
                        next += interval;
                        bus.pulse(channel, next >> 16, width);
                        last_fall = (next >> 16) + width;
                        interval = interval.wrapping_add_signed(add);
                    }
                }
            }
        }
    }
    bus
}

/// F7's self-test: for channel i from S = 1 + i*24*Ts one step right at S + 10*Ts and one left 2*Ts later.
pub fn self_test_bus(channels: usize, step_period: u64, dir_setup: u64, width: u64) -> Bus {
    let mut bus = Bus::default();
    let setup = dir_setup.max(1);
    for channel in 0..channels {
        let rise = 1 + channel as u64 * 24 * step_period + 10 * step_period;
        let dir = DIR + channel as u32;
        bus.order(rise - setup, dir, true);
        bus.pulse(channel, rise, width);
        bus.order(rise + 2 * step_period - setup, dir, false);
        bus.pulse(channel, rise + 2 * step_period, width);
    }
    bus
}
