//! Register values that have no effect yet: the timing until COMMIT, and the commands of a tick until PUSH.

use crate::config::{Bus, Config, Distribution, PulsePhasing};
use crate::{signal::MAX_CHANNELS, wire::packet::Tick};
use stepscope_registers as map;

#[derive(Clone, Debug)]
pub(super) struct Latches {
    pub(super) config: Config,
    pub(super) timing: Timing,
    pub(super) commands: Tick,
    pub(super) result: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Timing {
    pub(super) slots: u32,
    pub(super) step_period: u32,
    pub(super) pulse_width: u32,
    pub(super) dir_setup: u32,
    pub(super) dir_hold: u32,
    pub(super) settle: u32,
    pub(super) mode: u32,
}

impl Timing {
    pub(super) fn of(config: &Config) -> Self {
        let bus = config.bus();
        let distribution = match bus.distribution {
            Distribution::Burst => map::mode::DISTRIBUTION_BURST,
            Distribution::Spread => map::mode::DISTRIBUTION_SPREAD,
        };
        let pulses = match bus.pulse_phasing {
            PulsePhasing::Simultaneous => map::mode::PULSES_SIMULTANEOUS,
            PulsePhasing::Staggered => map::mode::PULSES_STAGGERED,
        };
        Self {
            slots: bus.slots.into(),
            step_period: bus.step_period_cycles,
            pulse_width: bus.pulse_width_cycles,
            dir_setup: bus.dir_setup_cycles,
            dir_hold: bus.dir_hold_cycles,
            settle: bus.settle_cycles,
            mode: map::mode::DISTRIBUTION.insert(distribution) | map::mode::PULSES.insert(pulses),
        }
    }

    /// `config` with this timing, if it is valid.
    pub(super) fn apply(self, config: &Config) -> Option<Config> {
        let bus = Bus {
            slots: u8::try_from(self.slots).ok()?,
            step_period_cycles: self.step_period,
            pulse_width_cycles: self.pulse_width,
            dir_setup_cycles: self.dir_setup,
            dir_hold_cycles: self.dir_hold,
            distribution: match map::mode::DISTRIBUTION.extract(self.mode) {
                map::mode::DISTRIBUTION_BURST => Distribution::Burst,
                map::mode::DISTRIBUTION_SPREAD => Distribution::Spread,
                _ => return None,
            },
            pulse_phasing: match map::mode::PULSES.extract(self.mode) {
                map::mode::PULSES_SIMULTANEOUS => PulsePhasing::Simultaneous,
                map::mode::PULSES_STAGGERED => PulsePhasing::Staggered,
                _ => return None,
            },
            settle_cycles: self.settle,
            ..config.bus().clone()
        };
        config.with_bus(&bus).ok()
    }

    pub(super) const fn register(&mut self, offset: u32) -> Option<&mut u32> {
        match offset {
            map::slots::OFFSET => Some(&mut self.slots),
            map::step_period::OFFSET => Some(&mut self.step_period),
            map::pulse_width::OFFSET => Some(&mut self.pulse_width),
            map::dir_setup::OFFSET => Some(&mut self.dir_setup),
            map::dir_hold::OFFSET => Some(&mut self.dir_hold),
            map::settle::OFFSET => Some(&mut self.settle),
            map::mode::OFFSET => Some(&mut self.mode),
            _ => None,
        }
    }
}

impl Latches {
    pub(super) fn new(config: &Config) -> Self {
        Self { config: config.clone(), timing: Timing::of(config), commands: [0; MAX_CHANNELS], result: 0 }
    }

    /// Commands of four channels, the first in the lowest byte.
    pub(super) fn commands(&self, index: usize) -> u32 {
        self.commands.as_chunks::<4>().0.get(index).map_or(0, |four| u32::from_le_bytes(*four))
    }

    pub(super) fn set_commands(&mut self, index: usize, value: u32) {
        let used = usize::from(self.config.channels());
        if let Some(four) = self.commands.as_chunks_mut::<4>().0.get_mut(index) {
            *four = value.to_le_bytes();
        }
        self.commands.iter_mut().skip(used).for_each(|byte| *byte = 0);
    }
}
