//! The peripheral's configuration and its rules (DESIGN A4, A7): [`Config::new`] validates a [`Bus`] and a [`SerialLine`].
//!
//! ```
//! use stepscope_peripheral::config::{Bus, Config, SerialLine};
//!
//! let bus = Bus { channels: 4, slots: 50, ..Bus::default() };
//! let config = Config::new(16_000_000, &bus, &SerialLine::default()).expect("valid values");
//! assert_eq!(config.tick().0, 50 * 320);
//!
//! let bus = Bus { step_period_cycles: 60, ..bus };
//! let problems = Config::new(16_000_000, &bus, &SerialLine::default()).unwrap_err();
//! assert!(problems[0].to_string().contains("use a step period of at least 80"), "{}", problems[0]);
//! ```

use crate::segment::PulseTimes;
use crate::units::{Cycles, Instant};
use alloc::vec::Vec;
use core::{fmt, ops::RangeInclusive};

const MIN_BIT_CYCLES: u64 = 11;

/// The range of each number; [`Config::new`] has rules that combine several.
pub mod limits {
    use crate::signal::MAX_CHANNELS;
    use core::ops::RangeInclusive;

    const MAX_CYCLES: u64 = 1_000_000_000;

    /// Clock of the peripheral; at the minimum it can receive 1 baud.
    pub const CLOCK_HZ: RangeInclusive<u64> = super::MIN_BIT_CYCLES..=1_000_000_000;
    pub const CHANNELS: RangeInclusive<u64> = 1..=MAX_CHANNELS as u64;
    pub const SLOTS: RangeInclusive<u64> = 1..=127;
    pub const STEP_PERIOD_CYCLES: RangeInclusive<u64> = 2..=MAX_CYCLES;
    pub const PULSE_WIDTH_CYCLES: RangeInclusive<u64> = 1..=MAX_CYCLES;
    pub const DIR_SETUP_CYCLES: RangeInclusive<u64> = 0..=MAX_CYCLES;
    pub const DIR_HOLD_CYCLES: RangeInclusive<u64> = 0..=MAX_CYCLES;
    pub const SETTLE_CYCLES: RangeInclusive<u64> = 0..=MAX_CYCLES;
    pub const QUEUE_DEPTH: RangeInclusive<u64> = 1..=255;
    /// Address of a controller; 255 is the broadcast address.
    pub const ADDRESS: RangeInclusive<u64> = 0..=254;
}

/// The tick sequencer and its driver bus.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bus {
    /// 1 to 16; a packet has one byte per channel.
    pub channels: u8,
    /// Slots per tick, 1 to 127: the maximum steps of a channel in one tick.
    pub slots: u8,
    /// Ts, length of a slot; a tick lasts `slots` times as long.
    pub step_period_cycles: u32,
    /// W, time that STEP stays high.
    pub pulse_width_cycles: u32,
    /// D, time from the start of a slot, where DIR may change, to the rise of STEP.
    pub dir_setup_cycles: u32,
    /// H, time that DIR is held after STEP has fallen.
    pub dir_hold_cycles: u32,
    pub distribution: Distribution,
    pub dir_line: DirLine,
    pub pulse_phasing: PulsePhasing,
    /// dp, settling time of the drivers' supply current after a step (the patent's delta t_p): the maximum distance of
    /// staggered pulses.
    pub settle_cycles: u32,
    /// Maximum ticks in the queue, 1 to 255.
    pub queue_depth: u8,
    /// Self-test after reset. Packets that end within it are dropped; framed ticks get BUSY.
    pub self_test_cycles: u32,
}

impl Default for Bus {
    fn default() -> Self {
        Self {
            channels: 1,
            slots: 100,
            step_period_cycles: 320,
            pulse_width_cycles: 40,
            dir_setup_cycles: 40,
            dir_hold_cycles: 0,
            distribution: Distribution::default(),
            dir_line: DirLine::default(),
            pulse_phasing: PulsePhasing::default(),
            settle_cycles: 0,
            queue_depth: 16,
            self_test_cycles: 1600,
        }
    }
}

/// Where the steps of a channel go within a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distribution {
    /// The first `count` slots of the tick, as in RU 2704486.
    Burst,
    /// Evenly spread over the tick.
    #[default]
    Spread,
}

/// The DIR lines of the bus.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirLine {
    /// One per channel; they change when a tick starts.
    #[default]
    PerChannel,
    /// One for all channels; it changes within each slot that has a step.
    Common,
}

/// When the pulses of one slot rise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PulsePhasing {
    #[default]
    Simultaneous,
    /// One after another, so that the drivers' current peaks do not add up.
    Staggered,
}

/// The serial line of a controller.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialLine {
    /// Bit rate of the host.
    pub baud: u32,
    /// Bit rate of the receiver if its clock differs from the host's.
    pub receiver_baud: Option<u32>,
    /// 0 to 254 if packets begin with an address; 0 by default on a framed line.
    pub address: Option<u8>,
    pub protocol: Protocol,
}

impl Default for SerialLine {
    fn default() -> Self {
        Self { baud: 115_200, receiver_baud: None, address: None, protocol: Protocol::Raw }
    }
}

/// How the bytes of the line form commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// Bytes with pauses between packets, as in RU 2704486.
    #[default]
    Raw,
    /// Frames with a CRC, sequence numbers and replies.
    Framed,
}

/// The field to change; it displays as a path such as `bus.slots`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    ClockHz,
    Bus(&'static str),
    Line(&'static str),
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ClockHz => f.write_str("clock_hz"),
            Self::Bus(name) => write!(f, "bus.{name}"),
            Self::Line(name) => write!(f, "line.{name}"),
        }
    }
}

/// A broken rule and the field to change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfigProblem {
    pub field: Field,
    pub error: ConfigError,
}

impl fmt::Display for ConfigProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.error)
    }
}

impl core::error::Error for ConfigProblem {}

/// A broken rule, with its numbers. Times are in cycles, rates in baud.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A number is out of its range. The unit is empty for a plain count.
    Range { given: u64, min: u64, max: u64, unit: &'static str },
    /// A bit of the receiver is shorter than 11 cycles.
    BitTooShort { bit_cycles: u64, baud: u32, clock_hz: u32, max_baud: u32 },
    /// A slot of `period` cannot hold `pulses` of `needed` = W + max(D + H, 1); `phasing` describes their order.
    PulseTooLong {
        width: u64,
        setup: u64,
        hold: u64,
        needed: u64,
        pulses: u64,
        phasing: &'static str,
        period: u64,
    },
    /// Staggered pulses on a common DIR line are closer than one lasts.
    SettleTooShort { settle: u64, width: u64, setup: u64, hold: u64, needed: u64 },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range { given, min, max, unit } => {
                let space = if unit.is_empty() { "" } else { " " };
                write!(f, "{given}{space}{unit} is out of range; use {min}")?;
                if min < max {
                    write!(f, " to {max}")?;
                }
                write!(f, "{space}{unit}")
            }
            Self::BitTooShort { bit_cycles, baud, clock_hz, max_baud } => write!(
                f,
                "{baud} baud at {clock_hz} Hz is {bit_cycles} cycles per bit; the receiver needs {MIN_BIT_CYCLES}; use at most {max_baud} baud, or a faster clock"
            ),
            Self::PulseTooLong { width, setup, hold, needed, pulses, phasing, period } => write!(
                f,
                "a pulse needs width {width} + max(setup {setup} + hold {hold}, 1) = {needed} cycles; a slot of {period} cycles must hold {pulses} ({phasing}); use a step period of at least {}, or shorter times",
                needed * pulses
            ),
            Self::SettleTooShort { settle, width, setup, hold, needed } => write!(
                f,
                "{settle} cycles between pulses are too short: a pulse on a common DIR line needs width {width} + max(setup {setup} + hold {hold}, 1) = {needed}; use at least {needed}, or shorter times"
            ),
        }
    }
}

/// A valid configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Config {
    clock_hz: u32,
    bus: Bus,
    baud: u32,
    protocol: Protocol,
    address: Option<u8>,
}

impl Config {
    /// Validates the bus and the line.
    /// Errors: every broken rule, each with the field to change.
    pub fn new(clock_hz: u32, bus: &Bus, line: &SerialLine) -> Result<Self, Vec<ConfigProblem>> {
        Self::validate(clock_hz, bus, line, true)
    }

    /// Validates a bus for segments: no slots limit the pulses, and nothing is received.
    /// Errors: as [`Self::new`].
    pub fn of_segments(clock_hz: u32, bus: &Bus, line: &SerialLine) -> Result<Self, Vec<ConfigProblem>> {
        Self::validate(clock_hz, bus, line, false)
    }

    fn validate(
        clock_hz: u32,
        bus: &Bus,
        line: &SerialLine,
        has_ticks: bool,
    ) -> Result<Self, Vec<ConfigProblem>> {
        let mut rules = Rules::default();
        rules.ranges(clock_hz, bus, line);
        if has_ticks {
            pulses_fit(bus, &mut rules);
            rules.bit_rate(clock_hz, line);
        }
        rules.end(Self {
            clock_hz,
            bus: bus.clone(),
            baud: line.receiver_baud.unwrap_or(line.baud),
            protocol: line.protocol,
            address: match line.protocol {
                Protocol::Raw => line.address,
                Protocol::Framed => Some(line.address.unwrap_or(0)),
            },
        })
    }

    pub const fn bus(&self) -> &Bus {
        &self.bus
    }

    pub(crate) const fn step_period(&self) -> u64 {
        self.bus.step_period_cycles as u64
    }

    /// The same controller with another bus.
    /// Errors: as [`Self::new`].
    pub(crate) fn with_bus(&self, bus: &Bus) -> Result<Self, Vec<ConfigProblem>> {
        let line = SerialLine {
            baud: self.baud,
            address: self.address,
            protocol: self.protocol,
            ..SerialLine::default()
        };
        Self::new(self.clock_hz, bus, &line)
    }

    pub const fn clock_hz(&self) -> u32 {
        self.clock_hz
    }

    pub const fn channels(&self) -> u8 {
        self.bus.channels
    }

    pub const fn protocol(&self) -> Protocol {
        self.protocol
    }

    /// The controller's address, if packets begin with one; always on a framed line.
    pub const fn address(&self) -> Option<u8> {
        self.address
    }

    pub const fn slots(&self) -> u8 {
        self.bus.slots
    }

    /// Length of a tick, M*Ts.
    pub const fn tick(&self) -> Cycles {
        Cycles(self.bus.slots as u64 * self.step_period())
    }

    /// End of the self-test.
    pub const fn boot(&self) -> Instant {
        Instant(self.bus.self_test_cycles as u64)
    }

    pub const fn queue_depth(&self) -> u8 {
        self.bus.queue_depth
    }

    /// Bit rate of replies: the receiver's.
    pub const fn reply_baud(&self) -> u32 {
        self.baud
    }

    /// The receiver's bit time B.
    pub const fn bit(&self) -> Cycles {
        Cycles(bit_cycles(self.clock_hz, if self.baud == 0 { 1 } else { self.baud }))
    }

    /// Bit time of a receiver at `baud`; 0 counts as 1 baud.
    pub fn bit_of(clock_hz: u32, baud: u32) -> Cycles {
        Cycles(bit_cycles(clock_hz, baud.max(1)))
    }

    /// Bytes of a packet: one per channel, and the address on an addressed raw line.
    pub const fn packet_len(&self) -> usize {
        self.bus.channels as usize + self.packet_address().is_some() as usize
    }

    /// The address in raw packets; `None` on a framed line.
    pub const fn packet_address(&self) -> Option<u8> {
        match self.protocol {
            Protocol::Raw => self.address,
            Protocol::Framed => None,
        }
    }
}

#[derive(Default)]
struct Rules {
    broken: Vec<ConfigProblem>,
}

impl Rules {
    fn add(&mut self, field: Field, error: ConfigError) {
        self.broken.push(ConfigProblem { field, error });
    }

    fn range(&mut self, field: Field, given: impl Into<u64>, range: RangeInclusive<u64>, unit: &'static str) {
        let given = given.into();
        if !range.contains(&given) {
            let (min, max) = range.into_inner();
            self.add(field, ConfigError::Range { given, min, max, unit });
        }
    }

    fn ranges(&mut self, clock_hz: u32, bus: &Bus, line: &SerialLine) {
        self.range(Field::ClockHz, clock_hz, limits::CLOCK_HZ, "Hz");
        self.range(Field::Bus("channels"), bus.channels, limits::CHANNELS, "");
        self.range(Field::Bus("slots"), bus.slots, limits::SLOTS, "");
        for (name, given, range) in [
            ("step_period_cycles", bus.step_period_cycles, limits::STEP_PERIOD_CYCLES),
            ("pulse_width_cycles", bus.pulse_width_cycles, limits::PULSE_WIDTH_CYCLES),
            ("dir_setup_cycles", bus.dir_setup_cycles, limits::DIR_SETUP_CYCLES),
            ("dir_hold_cycles", bus.dir_hold_cycles, limits::DIR_HOLD_CYCLES),
        ] {
            self.range(Field::Bus(name), given, range, "cycles");
        }
        self.range(Field::Bus("queue_depth"), bus.queue_depth, limits::QUEUE_DEPTH, "ticks");
        if let Some(address) = line.address {
            self.range(Field::Line("address"), address, limits::ADDRESS, "");
        }
        self.range(Field::Bus("settle_cycles"), bus.settle_cycles, limits::SETTLE_CYCLES, "cycles");
    }

    fn bit_rate(&mut self, clock_hz: u32, line: &SerialLine) {
        let (field, baud) = match line.receiver_baud {
            Some(baud) => (Field::Line("receiver_baud"), baud),
            None => (Field::Line("baud"), line.baud),
        };
        let (bit_cycles, max_baud) = (bit_cycles(clock_hz, baud.max(1)), max_baud(clock_hz));
        if baud == 0 {
            self.range(field, baud, 1..=max_baud.max(1).into(), "baud");
        } else if bit_cycles < MIN_BIT_CYCLES && u64::from(clock_hz) >= *limits::CLOCK_HZ.start() {
            self.add(field, ConfigError::BitTooShort { bit_cycles, baud, clock_hz, max_baud });
        }
    }

    fn end<T>(self, value: T) -> Result<T, Vec<ConfigProblem>> {
        if self.broken.is_empty() { Ok(value) } else { Err(self.broken) }
    }
}

/// With L = W + max(D + H, 1): simultaneous L <= Ts, with a common DIR line 2*L <= Ts; staggered
/// L <= floor(Ts/channels), with a common DIR line also dp >= L.
fn pulses_fit(bus: &Bus, rules: &mut Rules) {
    let (width, setup, hold, period, settle) = (
        u64::from(bus.pulse_width_cycles),
        u64::from(bus.dir_setup_cycles),
        u64::from(bus.dir_hold_cycles),
        u64::from(bus.step_period_cycles),
        u64::from(bus.settle_cycles),
    );
    let needed = width + (setup + hold).max(1);
    let (pulses, phasing) = match (bus.pulse_phasing, bus.dir_line) {
        (PulsePhasing::Simultaneous, DirLine::PerChannel) => (1, "all channels at once"),
        (PulsePhasing::Simultaneous, DirLine::Common) => (2, "left, then right, on a common DIR line"),
        (PulsePhasing::Staggered, _) => (u64::from(bus.channels.max(1)), "one channel after another"),
    };
    if needed > period / pulses {
        rules.add(
            Field::Bus("step_period_cycles"),
            ConfigError::PulseTooLong { width, setup, hold, needed, pulses, phasing, period },
        );
    }
    if bus.pulse_phasing == PulsePhasing::Staggered && bus.dir_line == DirLine::Common && settle < needed {
        rules.add(
            Field::Bus("settle_cycles"),
            ConfigError::SettleTooShort { settle, width, setup, hold, needed },
        );
    }
}

/// B = floor((2*clock_hz + baud) / (2*baud)): the bit time rounded to a cycle.
const fn bit_cycles(clock_hz: u32, baud: u32) -> u64 {
    (2 * clock_hz as u64 + baud as u64) / (2 * baud as u64)
}

/// The highest rate whose bit time is at least 11 cycles.
pub const fn max_baud(clock_hz: u32) -> u32 {
    (2 * clock_hz as u64 / (2 * MIN_BIT_CYCLES - 1)) as u32
}

impl From<&Config> for PulseTimes {
    fn from(config: &Config) -> Self {
        Self::from(config.bus())
    }
}

impl From<&Bus> for PulseTimes {
    fn from(bus: &Bus) -> Self {
        let cycles = |given: u32| Cycles(given.into());
        Self {
            width: cycles(bus.pulse_width_cycles),
            setup: cycles(bus.dir_setup_cycles),
            hold: cycles(bus.dir_hold_cycles),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn rounds_the_bit_time_to_the_nearest_cycle() {
        let rows =
            vec![(16_000_000, 115_200, 139), (1000, 50, 20), (1000, 300, 3), (105, 10, 11), (104, 10, 10)];
        for (clock_hz, baud, expected) in rows {
            assert_eq!(bit_cycles(clock_hz, baud), expected, "{clock_hz} Hz, {baud} baud");
        }
    }
}
