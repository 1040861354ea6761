//! The peripheral's configuration: what of a scenario the device is built from, and the rules of
//! DESIGN A4 and A7 that it keeps.

use super::{Bus, Cause, DirLine, Distribution, Line, Problem, Protocol, Pulses, judge::Judge};
use crate::{
    signal::MAX_CHANNELS,
    units::{Cycles, Instant},
};
use alloc::vec::Vec;

/// Least cycles of a receiver's bit (A4).
const LEAST_BIT_CYCLES: u64 = 11;
/// Slowest clock: one that hears 1 baud.
const LEAST_CLOCK_HZ: u64 = 11;

/// The peripheral's configuration, checked: every rule of A4 and A7 holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Config {
    pub(crate) clock_hz: u32,
    pub(crate) channels: u8,
    pub(crate) slots: u8,
    pub(crate) step_period: u64,
    pub(crate) pulse_width: u64,
    pub(crate) dir_setup: u64,
    pub(crate) dir_hold: u64,
    pub(crate) settle: u64,
    pub(crate) dir_line: DirLine,
    pub(crate) pulses: Pulses,
    pub(crate) distribution: Distribution,
    pub(crate) queue_depth: u8,
    pub(crate) boot: Instant,
    pub(crate) bit_cycles: u64,
    pub(crate) reply_baud: u32,
    pub(crate) protocol: Protocol,
    pub(crate) address: Option<u8>,
}

impl Config {
    /// Checks the peripheral's part of a scenario.
    ///
    /// # Errors
    /// Every problem, with paths as in a scenario (`bus.slots`, `line.receiver_baud`).
    pub fn new(clock_hz: u32, bus: &Bus, line: &Line) -> Result<Self, Vec<Problem>> {
        Self::judged(clock_hz, bus, line, true)
    }

    /// Checks the part of a scenario whose bus is driven by segments (A8): there are no slots for
    /// the pulses to fit in, and nothing is received.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_segments(clock_hz: u32, bus: &Bus, line: &Line) -> Result<Self, Vec<Problem>> {
        Self::judged(clock_hz, bus, line, false)
    }

    fn judged(clock_hz: u32, bus: &Bus, line: &Line, has_ticks: bool) -> Result<Self, Vec<Problem>> {
        let mut judge = Judge::default();
        judge.range("clock_hz", clock_hz, LEAST_CLOCK_HZ, 1_000_000_000, "Hz");
        judge.range("bus.channels", bus.channels, 1, MAX_CHANNELS as u64, "");
        judge.range("bus.slots", bus.slots, 1, 127, "");
        judge.range("bus.step_period_cycles", bus.step_period_cycles, 2, 1_000_000_000, "cycles");
        judge.range("bus.pulse_width_cycles", bus.pulse_width_cycles, 1, 1_000_000_000, "cycles");
        judge.range("bus.dir_setup_cycles", bus.dir_setup_cycles, 0, 1_000_000_000, "cycles");
        judge.range("bus.dir_hold_cycles", bus.dir_hold_cycles, 0, 1_000_000_000, "cycles");
        judge.range("bus.queue_depth", bus.queue_depth, 1, 255, "ticks");
        if let Some(address) = line.address {
            judge.range("line.address", address, 0, 254, "");
        }
        judge.range("bus.settle_cycles", bus.settle_cycles, 0, 1_000_000_000, "cycles");
        if has_ticks {
            pulses_fit(bus, &mut judge);
        }
        let baud = line.receiver_baud.unwrap_or(line.baud);
        let path = if line.receiver_baud.is_some() { "line.receiver_baud" } else { "line.baud" };
        let (bit_cycles, most_baud) = (bit_cycles(clock_hz, baud.max(1)), most_baud(clock_hz));
        if !has_ticks {
            // No bit is heard.
        } else if baud == 0 {
            judge.range(path, baud, 1, most_baud.max(1).into(), "baud");
        } else if bit_cycles < LEAST_BIT_CYCLES && u64::from(clock_hz) >= LEAST_CLOCK_HZ {
            judge.add(path, Cause::BitTooShort { bit_cycles, baud, clock_hz, most_baud });
        }
        judge.end(Self {
            clock_hz,
            channels: bus.channels,
            slots: bus.slots,
            step_period: u64::from(bus.step_period_cycles),
            pulse_width: u64::from(bus.pulse_width_cycles),
            dir_setup: u64::from(bus.dir_setup_cycles),
            dir_hold: u64::from(bus.dir_hold_cycles),
            settle: u64::from(bus.settle_cycles),
            dir_line: bus.dir_line,
            pulses: bus.pulses,
            distribution: bus.distribution,
            queue_depth: bus.queue_depth,
            boot: Instant(u64::from(bus.boot_cycles)),
            bit_cycles,
            reply_baud: baud,
            protocol: line.protocol,
            address: match line.protocol {
                Protocol::Raw => line.address,
                Protocol::Framed => Some(line.address.unwrap_or(0)),
            },
        })
    }

    /// The same controller with another bus: checked as [`Self::new`] does.
    ///
    /// # Errors
    /// Every problem, with paths as in a scenario.
    pub(crate) fn with_bus(&self, bus: &Bus) -> Result<Self, Vec<Problem>> {
        let line =
            Line { baud: self.reply_baud, address: self.address, protocol: self.protocol, ..Line::default() };
        Self::new(self.clock_hz, bus, &line)
    }

    /// Clock of the peripheral in Hz.
    #[must_use]
    pub const fn clock_hz(&self) -> u32 {
        self.clock_hz
    }

    /// Channels in use, 1 to 16.
    #[must_use]
    pub const fn channels(&self) -> u8 {
        self.channels
    }

    /// What stands around the orders on the line.
    #[must_use]
    pub const fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// The controller's address, where packets begin with one; always on a framed line.
    #[must_use]
    pub const fn address(&self) -> Option<u8> {
        self.address
    }

    /// Slots in a tick, 1 to 127.
    #[must_use]
    pub const fn slots(&self) -> u8 {
        self.slots
    }

    /// Length of a tick, M*Ts.
    #[must_use]
    pub const fn tick(&self) -> Cycles {
        Cycles(self.slots as u64 * self.step_period)
    }

    /// The rate at which the controller replies, in baud (A6).
    #[must_use]
    pub const fn reply_baud(&self) -> u32 {
        self.reply_baud
    }

    /// The receiver's bit time B (A4).
    #[must_use]
    pub const fn bit(&self) -> Cycles {
        Cycles(self.bit_cycles)
    }

    /// The bit time of a receiver of `baud` (A4). A rate of 0 counts as 1 baud.
    #[must_use]
    pub fn bit_of(clock_hz: u32, baud: u32) -> Cycles {
        Cycles(bit_cycles(clock_hz, baud.max(1)))
    }

    /// Bytes of a packet: one a channel, and the address on an addressed raw line. A frame has its
    /// address itself.
    #[must_use]
    pub const fn packet_len(&self) -> usize {
        self.channels as usize + self.packet_address().is_some() as usize
    }

    /// The address that packets begin with, if they do.
    #[must_use]
    pub const fn packet_address(&self) -> Option<u8> {
        match self.protocol {
            Protocol::Raw => self.address,
            Protocol::Framed => None,
        }
    }
}

/// A7's rules: with L = W + max(D + H, 1), simultaneous L <= Ts, with a common DIR line 2*L <= Ts;
/// staggered L <= floor(Ts/channels), with a common DIR line also dp >= L.
fn pulses_fit(bus: &Bus, judge: &mut Judge) {
    let (width, setup, hold, period, settle) = (
        u64::from(bus.pulse_width_cycles),
        u64::from(bus.dir_setup_cycles),
        u64::from(bus.dir_hold_cycles),
        u64::from(bus.step_period_cycles),
        u64::from(bus.settle_cycles),
    );
    let needed = width + (setup + hold).max(1);
    let (pulses, of) = match (bus.pulses, bus.dir_line) {
        (Pulses::Simultaneous, DirLine::PerChannel) => (1, "all channels at once"),
        (Pulses::Simultaneous, DirLine::Common) => (2, "left, then right, on a common DIR line"),
        (Pulses::Staggered, _) => (u64::from(bus.channels.max(1)), "one channel after another"),
    };
    if needed > period / pulses {
        judge.add(
            "bus.step_period_cycles",
            Cause::PulseTooLong { width, setup, hold, needed, pulses, of, period },
        );
    }
    if bus.pulses == Pulses::Staggered && bus.dir_line == DirLine::Common && settle < needed {
        judge.add("bus.settle_cycles", Cause::SettleTooShort { settle, width, setup, hold, needed });
    }
}

/// B = floor((2*clock_hz + baud) / (2*baud)): the bit time rounded to the nearest cycle (A4).
const fn bit_cycles(clock_hz: u32, baud: u32) -> u64 {
    (2 * clock_hz as u64 + baud as u64) / (2 * baud as u64)
}

/// The highest rate whose bit time is at least 11 cycles (A4).
pub(crate) const fn most_baud(clock_hz: u32) -> u32 {
    (2 * clock_hz as u64 / (2 * LEAST_BIT_CYCLES - 1)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn the_receivers_bit_time_is_rounded_to_the_nearest_cycle() {
        let rows =
            vec![(16_000_000, 115_200, 139), (1000, 50, 20), (1000, 300, 3), (105, 10, 11), (104, 10, 10)];
        for (clock_hz, baud, expected) in rows {
            assert_eq!(bit_cycles(clock_hz, baud), expected, "{clock_hz} Hz, {baud} baud");
        }
    }
}
