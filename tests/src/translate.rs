//! Converts configurations and inputs of the slow model to the core's types.

use crate::oracle::Config;
use stepscope_core::{
    peripheral::config::{Bus, DirLine, Distribution, PulsePhasing},
    scenario::{Glitch, Hex, ScriptedSend},
};

/// The driver bus of a configuration.
#[must_use]
pub fn bus(config: &Config) -> Bus {
    Bus {
        channels: config.channels as u8,
        slots: config.slots as u8,
        step_period_cycles: config.step_period as u32,
        pulse_width_cycles: config.pulse_width as u32,
        dir_setup_cycles: config.dir_setup as u32,
        dir_hold_cycles: config.dir_hold as u32,
        distribution: if config.spread { Distribution::Spread } else { Distribution::Burst },
        dir_line: if config.common_dir { DirLine::Common } else { DirLine::PerChannel },
        pulse_phasing: if config.staggered { PulsePhasing::Staggered } else { PulsePhasing::Simultaneous },
        settle_cycles: config.settle as u32,
        queue_depth: config.queue_depth as u8,
        self_test_cycles: config.boot as u32,
    }
}

/// Sends as a line script.
#[must_use]
pub fn sends(sends: &[(u64, Vec<u8>)]) -> Vec<ScriptedSend> {
    let send = |(start_cycle, bytes): &(u64, Vec<u8>)| ScriptedSend {
        start_cycle: *start_cycle,
        bytes: Hex(bytes.clone()),
        ..ScriptedSend::default()
    };
    sends.iter().map(send).collect()
}

/// Forced levels as the line's glitches.
#[must_use]
pub fn glitches(forced: &[(u64, u64, bool)]) -> Vec<Glitch> {
    let glitch = |&(start_cycle, length_cycles, level): &(u64, u64, bool)| Glitch {
        start_cycle,
        length_cycles,
        level: level.into(),
    };
    forced.iter().map(glitch).collect()
}

/// Positions of all channels; those of unused ones are 0.
pub fn positions(in_use: &[i32]) -> [i32; 16] {
    core::array::from_fn(|channel| in_use.get(channel).copied().unwrap_or(0))
}
