//! How late something was, as a histogram with few bars.

use std::fmt;

/// Upper ends of the bars, in microseconds; what is later is in the last.
const BARS_US: [u64; 9] = [100, 250, 500, 1000, 2000, 5000, 10_000, 20_000, 50_000];

/// Latenesses, counted.
#[derive(Clone, Copy, Default)]
pub(crate) struct Histogram {
    bars: [u64; BARS_US.len() + 1],
    worst_ns: u64,
}

impl Histogram {
    pub(crate) fn add(&mut self, late_ns: u64) {
        let bar = BARS_US.iter().position(|&end| late_ns <= 1000 * end).unwrap_or(BARS_US.len());
        if let Some(count) = self.bars.get_mut(bar) {
            *count += 1;
        }
        self.worst_ns = self.worst_ns.max(late_ns);
    }

    pub(crate) fn count(&self) -> u64 {
        self.bars.iter().sum()
    }

    pub(crate) const fn worst_ms(&self) -> f64 {
        self.worst_ns as f64 / 1e6
    }

    /// The end of the bar, in ms, in which so many per cent of all are, or the worst.
    pub(crate) fn within_ms(&self, percent: u64) -> f64 {
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

    /// Each bar's end in ms (`None`: later than all) and its count.
    pub(crate) fn bars(&self) -> impl Iterator<Item = (Option<f64>, u64)> {
        let ends = BARS_US.iter().map(|&end| Some(end as f64 / 1e3)).chain([None]);
        ends.zip(self.bars)
    }
}

impl fmt::Display for Histogram {
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

    #[test]
    fn a_lateness_is_in_the_first_bar_that_reaches_it() {
        let mut late = Histogram::default();
        for us in [0, 100, 101, 1500, 60_000] {
            late.add(us * 1000);
        }
        assert_eq!(late.to_string(), " <=0.1ms:2 <=0.25ms:1 <=2ms:1 later:1 worst:60.00ms");
        assert_eq!([40, 60, 80, 100].map(|percent| late.within_ms(percent)), [0.1, 0.25, 2.0, 60.0]);
    }
}
