//! A histogram of delays in real time (LIVE H2, H3).

use core::fmt;

/// Upper ends of the bars in microseconds; the last bar has no end.
const BARS_US: [u64; 9] = [100, 250, 500, 1000, 2000, 5000, 10_000, 20_000, 50_000];

/// A histogram of delays, with their maximum.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lateness {
    bars: [u64; BARS_US.len() + 1],
    worst_ns: u64,
}

impl Lateness {
    pub fn add(&mut self, late_ns: u64) {
        let bar = BARS_US.iter().position(|&end| late_ns <= 1000 * end).unwrap_or(BARS_US.len());
        if let Some(count) = self.bars.get_mut(bar) {
            *count += 1;
        }
        self.worst_ns = self.worst_ns.max(late_ns);
    }

    pub fn count(&self) -> u64 {
        self.bars.iter().sum()
    }

    /// The maximum in ms.
    pub const fn worst_ms(&self) -> f64 {
        self.worst_ns as f64 / 1e6
    }

    /// The end in ms of the bar below which `percent` of all delays are, or the maximum.
    pub fn within_ms(&self, percent: u64) -> f64 {
        let wanted = (self.count() * percent).div_ceil(100);
        let mut sum = 0;
        for (bar, end) in self.bars.iter().zip(BARS_US) {
            sum += bar;
            if sum >= wanted {
                return end as f64 / 1e3;
            }
        }
        self.worst_ms()
    }

    /// The end of each bar in ms (`None` for the last bar) and its count.
    pub fn bars(&self) -> impl Iterator<Item = (Option<f64>, u64)> {
        let ends = BARS_US.iter().map(|&end| Some(end as f64 / 1e3)).chain([None]);
        ends.zip(self.bars)
    }
}

impl fmt::Display for Lateness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (end, count) in self.bars().filter(|(_, count)| *count > 0) {
            match end {
                Some(end) => write!(f, " <={end}ms:{count}")?,
                None => write!(f, " later:{count}")?,
            }
        }
        write!(f, " worst:{:.2}ms", self.worst_ms())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString as _;

    #[test]
    fn a_lateness_is_in_the_first_bar_that_reaches_it() {
        let mut late = Lateness::default();
        for us in [0, 100, 101, 1500, 60_000] {
            late.add(us * 1000);
        }
        assert_eq!(late.to_string(), " <=0.1ms:2 <=0.25ms:1 <=2ms:1 later:1 worst:60.00ms");
        assert_eq!([40, 60, 80, 100].map(|percent| late.within_ms(percent)), [0.1, 0.25, 2.0, 60.0]);
    }

    #[test]
    fn delays_are_counted_by_bars() {
        use crate::lateness::Lateness;

        let mut late = Lateness::default();
        [80_000, 120_000, 7_300_000].into_iter().for_each(|ns| late.add(ns));
        assert_eq!((late.within_ms(50), late.within_ms(99), late.worst_ms()), (0.25, 10.0, 7.3));
    }
}
