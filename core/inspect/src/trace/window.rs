//! A part of a trace as records: the first one has the levels at its start.

use stepscope_peripheral::{signal::Record, trace::levels_at, units::Instant};

/// A range of cycles of a trace.
#[derive(Clone, Copy, Debug)]
pub struct TraceWindow<'a> {
    first: Record,
    rest: &'a [Record],
}

impl<'a> TraceWindow<'a> {
    /// The cycles `start..=end`.
    pub fn of(trace: &'a [Record], start: Instant, end: Instant) -> Self {
        let after = trace.partition_point(|record| record.cycle <= start);
        let until = trace.partition_point(|record| record.cycle <= end).max(after);
        let first = Record { cycle: start, levels: levels_at(trace, start) };
        Self { first, rest: trace.get(after..until).unwrap_or_default() }
    }

    /// Number of records; at least one.
    pub const fn records(&self) -> usize {
        1 + self.rest.len()
    }

    pub fn get(&self, index: usize) -> Option<Record> {
        match index.checked_sub(1) {
            None => Some(self.first),
            Some(index) => self.rest.get(index).copied(),
        }
    }

    pub fn iter_from(&self, index: usize) -> impl Iterator<Item = Record> {
        (index..).map_while(|index| self.get(index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use stepscope_peripheral::signal::Levels;

    #[test]
    fn a_window_begins_with_the_levels_at_its_start() {
        let trace = [(0, 7), (5, 1), (9, 3)]
            .map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
        for (start, end, expected) in [
            (0, 4, [(0, 7)].as_slice()),
            (5, 8, &[(5, 1)]),
            (6, 9, &[(6, 1), (9, 3)]),
            (12, 20, &[(12, 3)]),
            (8, 3, &[(8, 1)]),
        ] {
            let window = TraceWindow::of(&trace, Instant(start), Instant(end));
            let found: Vec<_> = window.iter_from(0).map(|record| (record.cycle.0, record.levels.0)).collect();
            assert_eq!((found.as_slice(), window.records()), (expected, expected.len()), "{start} to {end}");
        }
    }
}
