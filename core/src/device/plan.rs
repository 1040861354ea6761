//! The STEP and DIR lines of one tick, worked out when it starts (DESIGN A7).
//!
//! ```text
//! slot k starts at s = c0 + k*Ts      per-channel DIR, simultaneous pulses:
//!
//! DIR   ═╳══════════════════════════  at c0 only
//! STEP  ────────┐        ┌─────────   rise at s + D, fall at s + D + W
//!               └ D ┘ W  ┘
//! ```
//!
//! The plan is a list of (offset from c0, lines after it), so that running a tick is only walking
//! along it. Successive ticks with the same orders share it.

use crate::{
    scenario::{Config, Distribution},
    signal::{Levels, MAX_CHANNELS},
    wire::packet::{Order, Tick},
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
    channels: u8,
    slots: u8,
    step_period: u64,
    pulse_width: u64,
    dir_setup: u64,
    distribution: Distribution,
    orders: Tick,
    changes: Vec<Change>,
}

impl Plan {
    pub(super) fn new(config: &Config) -> Self {
        let mut plan = Self {
            channels: config.channels,
            slots: config.slots,
            step_period: config.step_period,
            pulse_width: config.pulse_width,
            dir_setup: config.dir_setup,
            distribution: config.distribution,
            orders: [0; MAX_CHANNELS],
            changes: Vec::new(),
        };
        plan.rebuild();
        plan
    }

    /// The orders that the plan is of.
    pub(super) const fn orders(&self) -> &Tick {
        &self.orders
    }

    /// Rising offsets; the first is 0.
    pub(super) fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Makes this the plan of `orders`.
    pub(super) fn set(&mut self, orders: Tick) {
        if orders != self.orders {
            self.orders = orders;
            self.rebuild();
        }
    }

    fn rebuild(&mut self) {
        let counts = self.orders.map(|byte| Order::parse(byte).steps);
        let mut dir: Lines = 0;
        for (channel, byte) in self.orders.iter().enumerate().take(usize::from(self.channels)) {
            dir |= Lines::from(Order::parse(*byte).right) << channel << Levels::DIR_SHIFT;
        }
        self.changes.clear();
        self.changes.push(Change { offset: 0, lines: dir });
        let mut firing = Firing::new(counts, self.slots, self.distribution);
        let mut slot_start = 0;
        for slot in 0..self.slots {
            let steps = Lines::from(firing.slot(slot));
            if steps != 0 {
                let rise = slot_start + self.dir_setup;
                if rise == 0 {
                    self.changes.clear();
                }
                self.changes.push(Change { offset: rise, lines: dir | steps });
                self.changes.push(Change { offset: rise + self.pulse_width, lines: dir });
            }
            slot_start += self.step_period;
        }
    }
}

/// Which channels fire in a slot.
///
/// `spread` fires in slot k if floor(((k+1)*c + h)/M) > floor((k*c + h)/M), h = floor(M/2): each
/// channel keeps (k*c + h) mod M. `burst` fires if k < c.
struct Firing {
    counts: [u8; MAX_CHANNELS],
    remainders: [u8; MAX_CHANNELS],
    slots: u8,
    distribution: Distribution,
}

impl Firing {
    const fn new(counts: [u8; MAX_CHANNELS], slots: u8, distribution: Distribution) -> Self {
        Self { counts, remainders: [slots / 2; MAX_CHANNELS], slots, distribution }
    }

    /// The channels that fire in slot `slot`; slots are asked for in order. Counts are at most
    /// `slots` <= 127, so the sum below stays under 254.
    fn slot(&mut self, slot: u8) -> u16 {
        let mut fires = [0_u8; MAX_CHANNELS];
        match self.distribution {
            Distribution::Burst => {
                for (fire, count) in fires.iter_mut().zip(self.counts) {
                    *fire = u8::from(slot < count);
                }
            }
            Distribution::Spread => {
                for ((fire, remainder), count) in fires.iter_mut().zip(&mut self.remainders).zip(self.counts)
                {
                    let sum = *remainder + count;
                    *fire = u8::from(sum >= self.slots);
                    *remainder = if sum >= self.slots { sum - self.slots } else { sum };
                }
            }
        }
        pack(fires)
    }
}

/// Bit i of the result is byte i, each 0 or 1.
///
/// The multiplication moves byte i's bit to bit 56 + i of its half; no two of them meet.
fn pack(bits: [u8; MAX_CHANNELS]) -> u16 {
    let all = u128::from_le_bytes(bits);
    let half = |bytes: u64| (bytes.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u16;
    half(all as u64) | half((all >> 64) as u64) << 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pack_puts_byte_i_into_bit_i() {
        for value in [0, 1, 0x8000, 0xffff, 0xa5c3, 0x0180, 0x1234] {
            let bits = core::array::from_fn(|i| (value >> i & 1) as u8);
            assert_eq!(pack(bits), value);
        }
    }

    #[test]
    fn every_count_fires_as_often_as_ordered_and_where_the_formula_says() {
        for slots in 1..=127_u8 {
            for count in 0..=slots {
                let mut counts = [0; MAX_CHANNELS];
                counts[3] = count;
                let (m, c, h) = (u32::from(slots), u32::from(count), u32::from(slots / 2));
                let mut spread = Firing::new(counts, slots, Distribution::Spread);
                let mut burst = Firing::new(counts, slots, Distribution::Burst);
                for slot in 0..slots {
                    let k = u32::from(slot);
                    let formula = ((k + 1) * c + h) / m > (k * c + h) / m;
                    assert_eq!(spread.slot(slot), u16::from(formula) << 3, "{c} of {m}, slot {k}");
                    assert_eq!(burst.slot(slot), u16::from(k < c) << 3, "{c} of {m}, slot {k}");
                }
            }
        }
    }
}
