//! Extends a timer of up to 32 bits to 64. Read it at least once per counter period; [`Clock::sleep_time`] limits
//! sleeps accordingly.
//!
//! ```
//! use stepscope_controller_firmware::clock::Clock;
//! use stepscope_peripheral::units::Instant;
//!
//! let mut clock = Clock::new(24);
//! assert_eq!(clock.extend(0xff_fff0), Instant(0xff_fff0));
//! assert_eq!(clock.extend(5), Instant(0x100_0005));
//! ```

use stepscope_peripheral::units::{Cycles, Instant};

/// Extends a timer to 64 bits.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    mask: u32,
    cycles: u64,
}

impl Clock {
    /// For a timer of `bits` (1 to 32) bits whose counter was reset recently.
    pub const fn new(bits: u32) -> Self {
        let mask = if bits >= u32::BITS { u32::MAX } else { (1 << bits) - 1 };
        Self { mask, cycles: 0 }
    }

    /// The time at this value of an up-counter, at most one counter period after the last call.
    pub fn extend(&mut self, counter: u32) -> Instant {
        let passed = counter.wrapping_sub(self.cycles as u32) & self.mask;
        self.cycles += u64::from(passed);
        Instant(self.cycles)
    }

    /// Time to sleep until `wake`, from the last call of [`Self::extend`]; at most half a counter period.
    pub fn sleep_time(&self, wake: Option<Instant>) -> Cycles {
        let max = u64::from(self.mask / 2);
        Cycles(wake.map_or(max, |wake| wake.0.saturating_sub(self.cycles).min(max)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extends_timers_of_any_width_over_many_counter_periods() {
        for bits in [8, 16, 24, 32] {
            let (mut clock, mut time) = (Clock::new(bits), 0_u64);
            let period = 1_u64 << bits;
            for step in [0, 1, period - 1, period / 2, period / 3, period - 1, 7] {
                time += step;
                assert_eq!(clock.extend((time % period) as u32), Instant(time), "{bits} bits, {step}");
            }
        }
    }

    #[test]
    fn sleep_times_are_at_most_half_a_counter_period() {
        let mut clock = Clock::new(24);
        let now = clock.extend(1000).0;
        for (wake, expected) in
            [(Some(now + 50), 50), (Some(now), 0), (Some(3), 0), (Some(now + (1 << 30)), 0x7f_ffff)]
        {
            assert_eq!(clock.sleep_time(wake.map(Instant)), Cycles(expected));
        }
        assert_eq!(clock.sleep_time(None), Cycles(0x7f_ffff));
    }
}
