//! Reactions to the sensors of a plant (PLANT F7): stop on overload, and the self-test, which measures the settling time of
//! the supply current during boot.
//!
//! ```text
//! channel i, Ts: step period, D: DIR setup time, S = 1 + i*24*Ts: start of its time slot
//! DIR   ____________________┌───────────┐________   at S + 10*Ts - max(D, 1), S + 12*Ts - max(D, 1)
//! STEP  ______________________┌┐__________┌┐_____   at r = S + 10*Ts, r + 2*Ts
//!       S      i_q            r   dp_i    r + 2*Ts
//! ```
//!
//! i_q is the idle supply current (average from S to r), dp_i the settling time of channel i.

use crate::config::{Bus, Config, DirLine};
use crate::device::plan::{Change, Lines};
use crate::device::{Device, Faults};
use crate::segment::PulseTimes;
use crate::signal::{Event, Levels, Sink};
use crate::units::{Cycles, Instant};
use alloc::vec::Vec;

/// Length of one channel's time slot, in step periods.
const TEST_PERIODS: u64 = 24;
/// Idle time before the first pulse, in step periods.
const IDLE_PERIODS: u64 = 10;

/// One channel's time slot of a self-test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SelfTest {
    /// Start of the time slot, S.
    pub start: Instant,
    /// First rise of STEP, r.
    pub rise: Instant,
    /// Step period Ts: the current is sampled for this time from the rise on.
    pub step_period: Cycles,
}

impl SelfTest {
    pub const fn of(config: &Config, channel: u8) -> Self {
        let period = config.step_period();
        let start = 1 + channel as u64 * TEST_PERIODS * period;
        let rise = start + IDLE_PERIODS * period;
        Self { start: Instant(start), rise: Instant(rise), step_period: Cycles(period) }
    }
}

/// Minimum boot time for a self-test of all channels.
pub const fn min_boot_time(config: &Config) -> Cycles {
    Cycles(SelfTest::of(config, config.channels()).start.0)
}

/// Levels of STEP and DIR during the self-test; offsets count from reset.
fn self_test_levels(config: &Config) -> Vec<Change> {
    let mut changes = Vec::new();
    let pulse = PulseTimes::from(config);
    let setup = pulse.setup.0.max(1);
    for channel in 0..config.channels() {
        let SelfTest { rise: Instant(rise), step_period: Cycles(period), .. } = SelfTest::of(config, channel);
        let dir_mask: Lines = match config.bus().dir_line {
            DirLine::PerChannel => 1 << channel,
            // All channels share DIR.
            DirLine::Common => (1 << config.channels()) - 1,
        };
        for (rise, dir) in [(rise, dir_mask << Levels::DIR_SHIFT), (rise + 2 * period, 0)] {
            changes.push(Change { offset: rise - setup, lines: dir });
            changes.push(Change { offset: rise, lines: dir | 1 << channel });
            changes.push(Change { offset: rise + pulse.width.0, lines: dir });
        }
    }
    changes
}

impl Device {
    /// A peripheral at reset that runs a self-test during boot. The boot time must be at least [`min_boot_time`]. The caller
    /// measures and reports the result with [`Self::set_settling_time`].
    pub fn with_self_test(config: &Config) -> Self {
        let mut device = Self::new(config);
        device.executor.sequencer.start_self_test(self_test_levels(config));
        device
    }

    /// Sets the settling time at the end of the latest cycle. `None` means that a channel did not settle: the step period is
    /// used and fault SELF_TEST is set. On a common DIR line, the settling time is at least a pulse with its DIR times.
    pub fn set_settling_time(&mut self, measured: Option<Cycles>) {
        let bus = self.latches.config.bus().clone();
        let dir_cycles = bus.dir_setup_cycles.saturating_add(bus.dir_hold_cycles).max(1);
        let min = match bus.dir_line {
            DirLine::PerChannel => 0,
            DirLine::Common => bus.pulse_width_cycles.saturating_add(dir_cycles),
        };
        let cycles = measured
            .map_or(bus.step_period_cycles, |Cycles(cycles)| u32::try_from(cycles).unwrap_or(u32::MAX));
        let settle_cycles = cycles.max(min);
        // A time beyond the limits of a configuration does not apply.
        if let Ok(config) = self.latches.config.with_bus(&Bus { settle_cycles, ..bus }) {
            self.executor.retime(&config);
            self.latches.timing.settle = settle_cycles;
            self.latches.config = config;
        }
        if measured.is_none() {
            self.executor.fault(Faults::SELF_TEST);
        }
    }

    /// The supply current was too high for too long: STOP and fault OVERLOAD at the end of the latest cycle.
    pub fn stop_on_overload(&mut self, sink: &mut impl Sink) {
        // No cycle has run yet.
        if self.now == Instant::RESET {
            return;
        }
        let last_cycle = self.last_cycle();
        self.executor.stop(last_cycle);
        self.executor.fault(Faults::OVERLOAD);
        sink.event(last_cycle, Event::Stopped);
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
            let test = SelfTest::of(&config, channel);
            assert_eq!((test.start, test.step_period), (Instant(start), Cycles(320)));
            assert_eq!(test.rise, Instant(start + 3200));
        }
        assert_eq!(min_boot_time(&config), Cycles(1 + 72 * 320));
    }
}
