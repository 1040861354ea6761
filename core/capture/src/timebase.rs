//! A file's exact time base, and the conversion of ticks to clock cycles (DESIGN B1).

/// Length of a tick: `numerator / denominator` seconds, in lowest terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timebase {
    numerator: u64,
    denominator: u64,
}

impl Timebase {
    pub const SECOND: Self = Self { numerator: 1, denominator: 1 };

    /// Ticks of `numerator / denominator` seconds; `None` if one is 0.
    pub const fn new(numerator: u64, denominator: u64) -> Option<Self> {
        if numerator == 0 || denominator == 0 {
            return None;
        }
        let (mut a, mut b) = (numerator, denominator);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        Some(Self { numerator: numerator / a, denominator: denominator / a })
    }

    /// Length of a tick in seconds.
    pub const fn seconds(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// Numerator and denominator of the length in seconds.
    pub const fn parts(self) -> (u64, u64) {
        (self.numerator, self.denominator)
    }

    /// The clock in Hz with one cycle per tick; `None` if it is not a whole number.
    pub fn clock_hz(self) -> Option<u32> {
        if self.numerator == 1 { u32::try_from(self.denominator).ok() } else { None }
    }

    /// The cycle of a tick at `clock_hz`, rounded to the nearest, halves up; `None` if it does not fit.
    pub fn cycle(self, tick: u64, clock_hz: u32) -> Option<u64> {
        let scaled = u128::from(self.numerator) * u128::from(clock_hz);
        let (product, denominator) = (u128::from(tick).checked_mul(scaled)?, u128::from(self.denominator));
        u64::try_from((product.checked_mul(2)?.checked_add(denominator)?) / (2 * denominator)).ok()
    }

    /// Whether this tick is a whole number of cycles.
    pub fn is_on_cycle(self, tick: u64, clock_hz: u32) -> bool {
        let scaled = u128::from(self.numerator) * u128::from(clock_hz);
        let product = u128::from(tick).checked_mul(scaled);
        product.is_some_and(|product| product.is_multiple_of(u128::from(self.denominator)))
    }

    /// Cycles per tick; `None` if that is not a whole number.
    pub fn cycles_per_tick(self, clock_hz: u32) -> Option<u64> {
        let scaled = u128::from(self.numerator) * u128::from(clock_hz);
        let exact = self.is_exact(clock_hz).then(|| scaled / u128::from(self.denominator))?;
        u64::try_from(exact).ok()
    }

    /// Whether every tick is a whole number of cycles.
    pub fn is_exact(self, clock_hz: u32) -> bool {
        (u128::from(self.numerator) * u128::from(clock_hz)).is_multiple_of(u128::from(self.denominator))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_rounded_to_the_nearest_cycle_halves_up() {
        // Length of a tick in s, clock in Hz, tick, cycle.
        for ((numerator, denominator), clock_hz, tick, cycle) in [
            ((1, 1_000_000_000), 16_000_000, 31, Some(0)),
            ((1, 1_000_000_000), 16_000_000, 32, Some(1)),
            ((1, 2), 1, 1, Some(1)),
            ((1, 2), 1, 3, Some(2)),
            ((10, 1), 1_000_000_000, u64::MAX, None),
            ((1, 1_000_000_000_000_000), 1_000_000_000, u64::MAX, Some(18_446_744_073_710)),
        ] {
            let base = Timebase::new(numerator, denominator).expect("a time base");
            assert_eq!(base.cycle(tick, clock_hz), cycle, "{base:?} {clock_hz} {tick}");
            let cycles = base.cycles_per_tick(clock_hz);
            assert_eq!(cycles.is_some(), base.is_exact(clock_hz));
            assert!(
                cycles.is_none_or(|cycles| tick.checked_mul(cycles) == cycle),
                "{base:?} {clock_hz} {tick}"
            );
        }
        assert_eq!(Timebase::new(0, 1), None);
        assert_eq!(Timebase::new(1, 0), None);
        assert_eq!(Timebase::new(10, 1_000_000_000), Timebase::new(1, 100_000_000));
    }

    #[test]
    fn samples_at_24_mhz_become_cycles_of_16_mhz() {
        use crate::timebase::Timebase;

        // Sample 1 is at 0.67 cycles, sample 3 exactly at 2.
        let base = Timebase::new(1, 24_000_000).expect("a time base");
        assert_eq!(
            [0, 1, 2, 3].map(|tick| base.cycle(tick, 16_000_000)),
            [Some(0), Some(1), Some(1), Some(2)]
        );
        assert!(!base.is_exact(16_000_000) && base.is_exact(48_000_000));
    }
}
