//! The peripheral's configuration: what a device is built from, and the rules of DESIGN A4 and A7 that it keeps.
//!
//! [`Bus`] and [`SerialLine`] are what one asks for, [`Config`] is what holds: it is made of them, or every rule that
//! they break is told with its numbers.
//!
//! ```
//! use stepscope_peripheral::config::{Bus, Config, SerialLine};
//!
//! let bus = Bus { channels: 4, slots: 50, ..Bus::default() };
//! let config = Config::new(16_000_000, &bus, &SerialLine::default()).expect("it holds");
//! assert_eq!(config.tick().0, 50 * 320);
//!
//! let bus = Bus { step_period_cycles: 60, ..bus };
//! let problems = Config::new(16_000_000, &bus, &SerialLine::default()).unwrap_err();
//! assert!(problems[0].to_string().contains("give a step period of at least 80"), "{}", problems[0]);
//! ```

use crate::{
    segment::PulseTimes,
    units::{Cycles, Instant},
};
use alloc::vec::Vec;
use core::{fmt, ops::RangeInclusive};

/// Least cycles of a receiver's bit (A4).
const MIN_BIT_CYCLES: u64 = 11;

/// The range of each number that [`Config::new`] holds by itself; other rules join several.
pub mod limits {
    use crate::signal::MAX_CHANNELS;
    use core::ops::RangeInclusive;

    /// Greatest length in cycles that a time of the bus may have.
    const MAX_CYCLES: u64 = 1_000_000_000;

    /// Clock in Hz; the slowest is one that hears 1 baud.
    pub const CLOCK_HZ: RangeInclusive<u64> = super::MIN_BIT_CYCLES..=1_000_000_000;
    /// [`Bus::channels`](super::Bus::channels).
    pub const CHANNELS: RangeInclusive<u64> = 1..=MAX_CHANNELS as u64;
    /// M.
    pub const SLOTS: RangeInclusive<u64> = 1..=127;
    /// Ts.
    pub const STEP_PERIOD_CYCLES: RangeInclusive<u64> = 2..=MAX_CYCLES;
    /// W.
    pub const PULSE_WIDTH_CYCLES: RangeInclusive<u64> = 1..=MAX_CYCLES;
    /// D.
    pub const DIR_SETUP_CYCLES: RangeInclusive<u64> = 0..=MAX_CYCLES;
    /// H.
    pub const DIR_HOLD_CYCLES: RangeInclusive<u64> = 0..=MAX_CYCLES;
    /// dp.
    pub const SETTLE_CYCLES: RangeInclusive<u64> = 0..=MAX_CYCLES;
    /// Ticks of the queue.
    pub const QUEUE_DEPTH: RangeInclusive<u64> = 1..=255;
    /// A controller's own address; 255 is for all.
    pub const ADDRESS: RangeInclusive<u64> = 0..=254;
}

/// The tick sequencer and its driver bus (DESIGN A7).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bus {
    /// Channels in use, 1 to 16; a packet has one byte for each.
    pub channels: u8,
    /// Slots in a tick, 1 to 127: the most steps a channel can make in one tick.
    pub slots: u8,
    /// Ts, length of a slot in cycles; a tick lasts `slots` times as long.
    pub step_period_cycles: u32,
    /// W, how long STEP stays high, in cycles.
    pub pulse_width_cycles: u32,
    /// D, from the start of a slot to the rise of STEP, in cycles: DIR has changed by then.
    pub dir_setup_cycles: u32,
    /// H, how long DIR is held after STEP has fallen, in cycles.
    pub dir_hold_cycles: u32,
    /// Where in a tick the steps go.
    pub distribution: Distribution,
    /// How many DIR lines the controller has.
    pub dir_line: DirLine,
    /// When the pulses of one slot come.
    pub pulse_phasing: PulsePhasing,
    /// dp, settling time of the drivers' supply current after a step, in cycles (the patent's delta t_p): staggered
    /// pulses are at most so far apart.
    pub settle_cycles: u32,
    /// Ticks that the queue holds, 1 to 255.
    pub queue_depth: u8,
    /// Self-test after reset in cycles. Packets that end within it are dropped, framed ticks answered with BUSY.
    pub boot_cycles: u32,
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
            boot_cycles: 1600,
        }
    }
}

/// Where in a tick a channel's steps go (DESIGN A7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distribution {
    /// The first `count` slots of the tick, as in RU 2704486.
    Burst,
    /// Evenly over the tick.
    #[default]
    Spread,
}

/// How many DIR lines the controller has (DESIGN A7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DirLine {
    /// One a channel; they change when a tick starts.
    #[default]
    PerChannel,
    /// One for all channels; it changes within each slot that has a step.
    Common,
}

/// When the pulses of one slot come (DESIGN A7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PulsePhasing {
    /// All at once.
    #[default]
    Simultaneous,
    /// One after another, so that the drivers' current peaks do not meet.
    Staggered,
}

/// What a controller has to know of the serial line (DESIGN A4 to A6).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SerialLine {
    /// Bit rate of the host in baud.
    pub baud: u32,
    /// Bit rate of the receiver in baud where its clock differs from the host's.
    pub receiver_baud: Option<u32>,
    /// The controller's address, 0 to 254, if packets begin with one; on a framed line 0 if none is given.
    pub address: Option<u8>,
    /// What stands around the orders.
    pub protocol: Protocol,
}

impl Default for SerialLine {
    fn default() -> Self {
        Self { baud: 115_200, receiver_baud: None, address: None, protocol: Protocol::Raw }
    }
}

/// What stands around the orders on the line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// Nothing: bytes, and pauses between packets, as in RU 2704486 (DESIGN A5).
    #[default]
    Raw,
    /// Frames with a check, sequence numbers and replies (DESIGN A6).
    Framed,
}

/// Which number of a configuration has to change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// The clock of the peripheral.
    ClockHz,
    /// A field of [`Bus`], by its name.
    Bus(&'static str),
    /// A field of [`SerialLine`], by its name.
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

/// One number of a configuration that breaks a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConfigProblem {
    /// The field that has to change.
    pub field: Field,
    /// The rule that it breaks.
    pub error: ConfigError,
}

impl fmt::Display for ConfigProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.field, self.error)
    }
}

impl core::error::Error for ConfigProblem {}

/// A rule that a configuration breaks (DESIGN A4, A7), with its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A number out of its range.
    Range {
        /// The number.
        given: u64,
        /// Least allowed.
        least: u64,
        /// Greatest allowed.
        most: u64,
        /// Unit of all three, empty for a plain count.
        unit: &'static str,
    },
    /// The receiver's bit time is too short (A4).
    BitTooShort {
        /// Cycles a bit.
        bit_cycles: u64,
        /// Receiver's rate.
        baud: u32,
        /// Clock of the peripheral.
        clock_hz: u32,
        /// Highest rate that this clock can hear.
        max_baud: u32,
    },
    /// The pulses of a slot do not fit in it (A7).
    PulseTooLong {
        /// W.
        width: u64,
        /// D.
        setup: u64,
        /// H.
        hold: u64,
        /// L = W + max(D + H, 1), of one pulse.
        needed: u64,
        /// Pulses that have to follow each other in a slot.
        pulses: u64,
        /// Which these are.
        of: &'static str,
        /// Ts.
        period: u64,
    },
    /// Staggered pulses with a common DIR line are closer than one lasts (A7).
    SettleTooShort {
        /// dp.
        settle: u64,
        /// W.
        width: u64,
        /// D.
        setup: u64,
        /// H.
        hold: u64,
        /// L = W + max(D + H, 1).
        needed: u64,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Range { given, least, most, unit } => {
                let space = if unit.is_empty() { "" } else { " " };
                write!(f, "{given}{space}{unit} is out of range; give {least}")?;
                if least < most {
                    write!(f, " to {most}")?;
                }
                write!(f, "{space}{unit}")
            }
            Self::BitTooShort { bit_cycles, baud, clock_hz, max_baud } => write!(
                f,
                "{baud} baud at {clock_hz} Hz is {bit_cycles} cycles a bit, the receiver needs 11; give at most {max_baud} baud or a faster clock"
            ),
            Self::PulseTooLong { width, setup, hold, needed, pulses, of, period } => write!(
                f,
                "a pulse needs width {width} + max(setup {setup} + hold {hold}, 1) = {needed} cycles, {pulses} in a slot ({of}), the slot has {period}; give a step period of at least {} or shorter times",
                needed * pulses
            ),
            Self::SettleTooShort { settle, width, setup, hold, needed } => write!(
                f,
                "{settle} cycles from pulse to pulse, but one needs width {width} + max(setup {setup} + hold {hold}, 1) = {needed} on a common DIR line; give at least {needed} or shorter times"
            ),
        }
    }
}

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
    pub(crate) pulse_phasing: PulsePhasing,
    pub(crate) distribution: Distribution,
    pub(crate) queue_depth: u8,
    pub(crate) boot: Instant,
    pub(crate) bit_cycles: u64,
    pub(crate) reply_baud: u32,
    pub(crate) protocol: Protocol,
    pub(crate) address: Option<u8>,
}

impl Config {
    /// Checks what is asked for.
    ///
    /// # Errors
    /// Every rule that is broken, each with the field that has to change.
    pub fn new(clock_hz: u32, bus: &Bus, line: &SerialLine) -> Result<Self, Vec<ConfigProblem>> {
        Self::judged(clock_hz, bus, line, true)
    }

    /// Checks what is asked of a bus that segments drive (A8): there are no slots for
    /// the pulses to fit in, and nothing is received.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_segments(clock_hz: u32, bus: &Bus, line: &SerialLine) -> Result<Self, Vec<ConfigProblem>> {
        Self::judged(clock_hz, bus, line, false)
    }

    fn judged(
        clock_hz: u32,
        bus: &Bus,
        line: &SerialLine,
        has_ticks: bool,
    ) -> Result<Self, Vec<ConfigProblem>> {
        let mut rules = Rules::default();
        rules.range(Field::ClockHz, clock_hz, limits::CLOCK_HZ, "Hz");
        rules.range(Field::Bus("channels"), bus.channels, limits::CHANNELS, "");
        rules.range(Field::Bus("slots"), bus.slots, limits::SLOTS, "");
        for (name, given, range) in [
            ("step_period_cycles", bus.step_period_cycles, limits::STEP_PERIOD_CYCLES),
            ("pulse_width_cycles", bus.pulse_width_cycles, limits::PULSE_WIDTH_CYCLES),
            ("dir_setup_cycles", bus.dir_setup_cycles, limits::DIR_SETUP_CYCLES),
            ("dir_hold_cycles", bus.dir_hold_cycles, limits::DIR_HOLD_CYCLES),
        ] {
            rules.range(Field::Bus(name), given, range, "cycles");
        }
        rules.range(Field::Bus("queue_depth"), bus.queue_depth, limits::QUEUE_DEPTH, "ticks");
        if let Some(address) = line.address {
            rules.range(Field::Line("address"), address, limits::ADDRESS, "");
        }
        rules.range(Field::Bus("settle_cycles"), bus.settle_cycles, limits::SETTLE_CYCLES, "cycles");
        if has_ticks {
            pulses_fit(bus, &mut rules);
        }
        let baud = line.receiver_baud.unwrap_or(line.baud);
        let field = Field::Line(if line.receiver_baud.is_some() { "receiver_baud" } else { "baud" });
        let (bit_cycles, max_baud) = (bit_cycles(clock_hz, baud.max(1)), max_baud(clock_hz));
        if !has_ticks {
            // No bit is heard.
        } else if baud == 0 {
            rules.range(field, baud, 1..=max_baud.max(1).into(), "baud");
        } else if bit_cycles < MIN_BIT_CYCLES && u64::from(clock_hz) >= *limits::CLOCK_HZ.start() {
            rules.add(field, ConfigError::BitTooShort { bit_cycles, baud, clock_hz, max_baud });
        }
        rules.end(Self {
            clock_hz,
            channels: bus.channels,
            slots: bus.slots,
            step_period: u64::from(bus.step_period_cycles),
            pulse_width: u64::from(bus.pulse_width_cycles),
            dir_setup: u64::from(bus.dir_setup_cycles),
            dir_hold: u64::from(bus.dir_hold_cycles),
            settle: u64::from(bus.settle_cycles),
            dir_line: bus.dir_line,
            pulse_phasing: bus.pulse_phasing,
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

    /// The bus that it was made of.
    pub(crate) const fn bus(&self) -> Bus {
        // Each of these came from 32 bits.
        Bus {
            channels: self.channels,
            slots: self.slots,
            step_period_cycles: self.step_period as u32,
            pulse_width_cycles: self.pulse_width as u32,
            dir_setup_cycles: self.dir_setup as u32,
            dir_hold_cycles: self.dir_hold as u32,
            distribution: self.distribution,
            dir_line: self.dir_line,
            pulse_phasing: self.pulse_phasing,
            settle_cycles: self.settle as u32,
            queue_depth: self.queue_depth,
            boot_cycles: self.boot.0 as u32,
        }
    }

    /// The same controller with another bus: checked as [`Self::new`] does.
    ///
    /// # Errors
    /// Every rule that is broken.
    pub(crate) fn with_bus(&self, bus: &Bus) -> Result<Self, Vec<ConfigProblem>> {
        let line = SerialLine {
            baud: self.reply_baud,
            address: self.address,
            protocol: self.protocol,
            ..SerialLine::default()
        };
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

    /// First cycle after the self-test (A7's `boot`).
    #[must_use]
    pub const fn boot(&self) -> Instant {
        self.boot
    }

    /// Ticks that the queue holds, 1 to 255.
    #[must_use]
    pub const fn queue_depth(&self) -> u8 {
        self.queue_depth
    }

    /// How many DIR lines the controller has.
    #[must_use]
    pub const fn dir_line(&self) -> DirLine {
        self.dir_line
    }

    /// When the pulses of one slot come.
    #[must_use]
    pub const fn pulse_phasing(&self) -> PulsePhasing {
        self.pulse_phasing
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

/// The rules that are broken so far.
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
            let (least, most) = range.into_inner();
            self.add(field, ConfigError::Range { given, least, most, unit });
        }
    }

    fn end<T>(self, value: T) -> Result<T, Vec<ConfigProblem>> {
        if self.broken.is_empty() { Ok(value) } else { Err(self.broken) }
    }
}

/// A7's rules: with L = W + max(D + H, 1), simultaneous L <= Ts, with a common DIR line 2*L <= Ts;
/// staggered L <= floor(Ts/channels), with a common DIR line also dp >= L.
fn pulses_fit(bus: &Bus, rules: &mut Rules) {
    let (width, setup, hold, period, settle) = (
        u64::from(bus.pulse_width_cycles),
        u64::from(bus.dir_setup_cycles),
        u64::from(bus.dir_hold_cycles),
        u64::from(bus.step_period_cycles),
        u64::from(bus.settle_cycles),
    );
    let needed = width + (setup + hold).max(1);
    let (pulses, of) = match (bus.pulse_phasing, bus.dir_line) {
        (PulsePhasing::Simultaneous, DirLine::PerChannel) => (1, "all channels at once"),
        (PulsePhasing::Simultaneous, DirLine::Common) => (2, "left, then right, on a common DIR line"),
        (PulsePhasing::Staggered, _) => (u64::from(bus.channels.max(1)), "one channel after another"),
    };
    if needed > period / pulses {
        rules.add(
            Field::Bus("step_period_cycles"),
            ConfigError::PulseTooLong { width, setup, hold, needed, pulses, of, period },
        );
    }
    if bus.pulse_phasing == PulsePhasing::Staggered && bus.dir_line == DirLine::Common && settle < needed {
        rules.add(
            Field::Bus("settle_cycles"),
            ConfigError::SettleTooShort { settle, width, setup, hold, needed },
        );
    }
}

/// B = floor((2*clock_hz + baud) / (2*baud)): the bit time rounded to the nearest cycle (A4).
const fn bit_cycles(clock_hz: u32, baud: u32) -> u64 {
    (2 * clock_hz as u64 + baud as u64) / (2 * baud as u64)
}

/// The highest rate whose bit time is at least 11 cycles (A4).
#[must_use]
pub const fn max_baud(clock_hz: u32) -> u32 {
    (2 * clock_hz as u64 / (2 * MIN_BIT_CYCLES - 1)) as u32
}

impl From<&Config> for PulseTimes {
    fn from(config: &Config) -> Self {
        Self {
            width: Cycles(config.pulse_width),
            setup: Cycles(config.dir_setup),
            hold: Cycles(config.dir_hold),
        }
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
    fn the_receivers_bit_time_is_rounded_to_the_nearest_cycle() {
        let rows =
            vec![(16_000_000, 115_200, 139), (1000, 50, 20), (1000, 300, 3), (105, 10, 11), (104, 10, 10)];
        for (clock_hz, baud, expected) in rows {
            assert_eq!(bit_cycles(clock_hz, baud), expected, "{clock_hz} Hz, {baud} baud");
        }
    }
}
