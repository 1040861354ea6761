//! Reactions to the sensors of a plant (PLANT F7): stop on overload, and the self-test, which measures the settling time of
//! the supply current during boot.
//!
//! ```text
//! channel i, S = 1 + i*24*Ts
//! DIR   ____________________┌───────────┐________   at S + 10*Ts - max(D, 1), S + 12*Ts - max(D, 1)
//! STEP  ______________________┌┐__________┌┐_____   at r = S + 10*Ts, r + 2*Ts
//!       S      i_q            r   dp_i    r + 2*Ts
//! ```

use crate::config::{Bus, Config, DirLine};
use crate::device::plan::{Change, Lines};
use crate::device::{Device, Faults};
use crate::segment::PulseTimes;
use crate::signal::{Event, Levels, Sink};
use crate::units::{Cycles, Instant};
use alloc::vec::Vec;

/// Length of one channel's part, in Ts.
const PART_PERIODS: u64 = 24;
/// Rest before the first pulse, in Ts.
const REST_PERIODS: u64 = 10;

/// One channel's part of a self-test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SelfTest {
    /// S: its start.
    pub start: Instant,
    /// r: rise of STEP.
    pub rise: Instant,
    /// Ts: time from the rise during which the current is sampled.
    pub step: Cycles,
}

impl SelfTest {
    /// The part of a channel.
    pub const fn of(config: &Config, channel: u8) -> Self {
        let step = config.step_period();
        let start = 1 + channel as u64 * PART_PERIODS * step;
        Self { start: Instant(start), rise: Instant(start + REST_PERIODS * step), step: Cycles(step) }
    }

    /// Minimum boot time for all parts.
    pub const fn boot(config: &Config) -> Cycles {
        Cycles(1 + config.channels() as u64 * PART_PERIODS * config.step_period())
    }
}

/// Levels of STEP and DIR during the self-test; offsets count from reset.
fn changes(config: &Config) -> Vec<Change> {
    let (mut changes, mut lines): (Vec<Change>, Lines) = (Vec::new(), 0);
    let pulse = PulseTimes::from(config);
    let before = pulse.setup.0.max(1);
    for channel in 0..config.channels() {
        let SelfTest { rise: Instant(rise), step: Cycles(step), .. } = SelfTest::of(config, channel);
        let own = match config.bus().dir_line {
            DirLine::PerChannel => 1 << channel,
            DirLine::Common => !(!0 << config.channels()),
        };
        for (rise, dir) in [(rise, own << Levels::DIR_SHIFT), (rise + 2 * step, 0)] {
            let mut at = |offset, with| {
                lines = with;
                changes.push(Change { offset, lines });
            };
            at(rise - before, dir);
            at(rise, dir | 1 << channel);
            at(rise + pulse.width.0, dir);
        }
    }
    changes
}

impl Device {
    /// A peripheral before cycle 0 with a self-test during boot, which must last [`SelfTest::boot`]. The caller measures
    /// and reports the result with [`Self::set_settling_time`].
    pub fn with_self_test(config: &Config) -> Self {
        let mut device = Self::new(config);
        device.executor.sequencer.start_self_test(changes(config));
        device
    }

    /// Sets the measured settling time dp at the end of the latest cycle. If a channel has none, dp is Ts and fault
    /// SELF_TEST is set. On a common DIR line dp is at least one pulse with DIR around it.
    pub fn set_settling_time(&mut self, found: Option<Cycles>) {
        let config = &self.latches.config;
        let bus = config.bus().clone();
        let around = bus.dir_setup_cycles.saturating_add(bus.dir_hold_cycles).max(1);
        let min = match config.bus().dir_line {
            DirLine::PerChannel => 0,
            DirLine::Common => bus.pulse_width_cycles.saturating_add(around),
        };
        let found_cycles =
            found.map_or(bus.step_period_cycles, |Cycles(cycles)| u32::try_from(cycles).unwrap_or(u32::MAX));
        let settle_cycles = found_cycles.max(min);
        if let Ok(config) = config.with_bus(&Bus { settle_cycles, ..bus }) {
            self.executor.retime(&config);
            self.latches.timing.settle = settle_cycles;
            self.latches.config = config;
        }
        if found.is_none() {
            self.executor.fault(Faults::SELF_TEST);
        }
    }

    /// The supply current was too high for too long: STOP and fault OVERLOAD at the end of the latest cycle.
    pub fn overload(&mut self, sink: &mut impl Sink) {
        if self.now == Instant::RESET {
            return;
        }
        let now = self.before();
        self.executor.stop(now);
        self.executor.fault(Faults::OVERLOAD);
        sink.event(now, Event::Stopped);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::SerialLine;

    #[test]
    fn channels_are_tested_one_after_another_during_boot() {
        let bus = Bus { channels: 3, step_period_cycles: 320, ..Bus::default() };
        let config = Config::new(16_000_000, &bus, &SerialLine::default()).unwrap();
        for (channel, start) in [(0, 1), (1, 1 + 24 * 320), (2, 1 + 48 * 320)] {
            let part = SelfTest::of(&config, channel);
            assert_eq!((part.start, part.step), (Instant(start), Cycles(320)));
            assert_eq!(part.rise, Instant(start + 3200));
        }
        assert_eq!(SelfTest::boot(&config), Cycles(1 + 72 * 320));
    }
}
