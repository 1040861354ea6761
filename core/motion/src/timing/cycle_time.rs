//! Times in cycles with enough digits for their rounding, however late they are (DESIGN B1): whole cycles, and a fraction of
//! a cycle in 106 bits. In an f64 the fraction would only have 14 bits at 10^12 cycles.

use crate::{timing::decimal::Exact, timing::double::F106};

/// Relative distance from a tie that 106 bits do not resolve: 2^-94.
const TIE: f64 = f64::EPSILON * f64::EPSILON * 1024.0;

/// Distance in cycles from a tie that 106 bits do not resolve at this cycle.
pub(crate) fn tie(cycle: u64) -> F106 {
    ((cycle as f64 + 1.0) * TIE).into()
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct CycleTime {
    pub(crate) whole: u64,
    /// 0 to below 1.
    pub(crate) part: F106,
}

impl CycleTime {
    /// A time >= 0.
    pub(crate) fn of(cycles: F106) -> Self {
        // The low number may be negative.
        let mut whole = cycles.high as u64;
        let mut part = F106::sum(cycles.high - whole as f64, cycles.low);
        if part.high < 0.0 && whole > 0 {
            (whole, part) = (whole - 1, part + 1.0);
        }
        Self { whole, part }
    }

    /// A fraction >= 0 in cycles.
    pub(crate) fn exact(cycles: &Exact) -> Self {
        let (whole, part) = cycles.whole_and_part();
        Self::default().plus(Self { whole, part })
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        let (whole, part) = (self.whole.saturating_add(other.whole), self.part + other.part);
        let part_beyond = part - 1.0;
        if part_beyond.high < 0.0 {
            Self { whole, part }
        } else {
            Self { whole: whole.saturating_add(1), part: part_beyond }
        }
    }

    /// Whether the time is at or before the start of `cycle`, to within a tie.
    pub(crate) fn is_by(self, cycle: u64) -> bool {
        self.whole < cycle || (self.whole == cycle && self.part <= tie(cycle))
    }

    /// Whether the time is the start of `cycle`, to within a tie.
    pub(crate) fn is_at(self, cycle: u64) -> bool {
        let to_next = F106::from(1.0) - self.part;
        self.is_by(cycle) && (self.whole == cycle || (self.whole + 1 == cycle && to_next <= tie(cycle)))
    }

    pub(crate) fn double(self) -> F106 {
        F106::from(self.whole) + self.part
    }

    pub(crate) fn cycles(self) -> f64 {
        self.whole as f64 + self.part.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adds_parts_to_whole_cycles() {
        let half = F106::from(0.5);
        let time = CycleTime::of(3.75.into()).plus(CycleTime { whole: 1 << 60, part: half });
        assert_eq!(time, CycleTime { whole: (1 << 60) + 4, part: 0.25.into() });
        // The nearest f64 is 4, but the sum is less.
        let below = CycleTime::of(F106 { high: 4.0, low: -1e-20 });
        assert!(below.whole == 3 && below.part == F106 { high: 1.0, low: -1e-20 }, "{below:?}");
        // A time below 0 by a rounding is in cycle 0.
        assert_eq!(CycleTime::of(F106 { high: 0.0, low: -1e-30 }).whole, 0);
        assert_eq!(CycleTime::exact(&Exact::of(7.0).divided_by(2.0)), CycleTime { whole: 3, part: half });
    }
}
