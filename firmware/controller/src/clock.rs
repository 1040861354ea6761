//! Extends a timer of up to 32 bits to 64. Read it at least once per turn of the counter; [`Clock::sleep_time`] limits
//! sleeps accordingly.
//!
//! ```
//! use stepscope_controller_firmware::clock::Clock;
//! use stepscope_peripheral::units::Instant;
//!
//! let mut clock = Clock::new(24);
//! assert_eq!(clock.tick(0xff_fff0), Instant(0xff_fff0));
//! assert_eq!(clock.tick(5), Instant(0x100_0005));
//! ```

use stepscope_peripheral::units::{Cycles, Instant};

/// A timer of 64 bits.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    mask: u32,
    tick: u64,
}

impl Clock {
    /// A timer of 1 to 32 bits that starts near 0.
    pub const fn new(bits: u32) -> Self {
        let mask = if bits >= u32::BITS { u32::MAX } else { (1 << bits) - 1 };
        Self { mask, tick: 0 }
    }

    /// The tick at this value of an up-counter, at most one turn after the last call.
    pub fn tick(&mut self, counter: u32) -> Instant {
        let passed = counter.wrapping_sub(self.tick as u32) & self.mask;
        self.tick += u64::from(passed);
        Instant(self.tick)
    }

    /// Time to sleep until `wake`, at most half a turn of the counter.
    pub fn sleep_time(&self, wake: Option<Instant>) -> Cycles {
        let max = u64::from(self.mask / 2);
        Cycles(wake.map_or(max, |wake| wake.0.saturating_sub(self.tick).min(max)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_continue_over_many_turns_of_a_timer_of_any_width() {
        for bits in [8, 16, 24, 32] {
            let (mut clock, mut tick) = (Clock::new(bits), 0_u64);
            let turn = 1_u64 << bits;
            for step in [0, 1, turn - 1, turn / 2, turn / 3, turn - 1, 7] {
                tick += step;
                assert_eq!(clock.tick((tick % turn) as u32), Instant(tick), "{bits} bits, {step}");
            }
        }
    }

    #[test]
    fn sleep_times_are_at_most_half_a_turn_of_the_counter() {
        let mut clock = Clock::new(24);
        let now = clock.tick(1000).0;
        for (wake, expected) in
            [(Some(now + 50), 50), (Some(now), 0), (Some(3), 0), (Some(now + (1 << 30)), 0x7f_ffff)]
        {
            assert_eq!(clock.sleep_time(wake.map(Instant)), Cycles(expected));
        }
        assert_eq!(clock.sleep_time(None), Cycles(0x7f_ffff));
    }
}
