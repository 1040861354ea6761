//! A trace as pixel columns of a logic view.
//!
//! Nothing is sampled: a glitch of one cycle shows in a column of any width.
//!
//! ```
//! use stepscope_inspect::trace::columns::columns;
//! use stepscope_peripheral::{signal::{Levels, Record}, units::Instant};
//!
//! // STEP0 is high in cycles 5 to 7; two columns of ten cycles each.
//! let trace = [(0, 0), (5, 1), (8, 0)].map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
//! let columns = columns(&trace, 0, 20, 2);
//! assert_eq!((columns.high[0] & 1, columns.low[0] & 1), (1, 1)); // both within the first
//! assert_eq!((columns.high[1] & 1, columns.last[1] & 1), (0, 0));
//! ```

use alloc::{vec, vec::Vec};
use stepscope_peripheral::signal::Record;

/// One bit per signal, as in [`stepscope_peripheral::signal::Levels`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// High in some cycle of the column.
    pub high: Vec<u64>,
    /// Low in some cycle of the column.
    pub low: Vec<u64>,
    pub last: Vec<u64>,
}

/// Column i starts at start + floor(i*span/count) and has at least one cycle. Columns past the last record continue
/// its levels.
pub fn columns(trace: &[Record], start: u64, end: u64, count: usize) -> Columns {
    let span = u128::from(end.saturating_sub(start).max(1));
    let bound = |i: usize| start.saturating_add((span * i as u128 / count.max(1) as u128) as u64);
    let mut result = Columns { high: vec![0; count], low: vec![0; count], last: vec![0; count] };
    let mut next = trace.partition_point(|r| r.cycle.0 <= start);
    let mut levels = next.checked_sub(1).and_then(|i| trace.get(i)).map_or(0, |r| r.levels.0);
    for i in 0..count {
        let (first, after) = (bound(i), bound(i + 1).max(bound(i).saturating_add(1)));
        // Columns narrower than a cycle share it.
        let (mut high, mut low) = (levels, !levels);
        while let Some(record) = trace.get(next).filter(|r| r.cycle.0 < after) {
            if record.cycle.0 == first && high == levels && low == !levels {
                (high, low) = (0, 0);
            }
            levels = record.levels.0;
            high |= levels;
            low |= !levels;
            next += 1;
        }
        result.high[i] = high;
        result.low[i] = low;
        result.last[i] = levels;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_peripheral::{signal::Levels, units::Instant};

    #[test]
    fn columns_equal_brute_force_over_every_cycle() {
        let trace: Vec<Record> =
            [(0, 0b10), (3, 0b11), (4, 0b01), (10, 0b00), (11, 0b01), (12, 0b11), (40, 0b10)]
                .map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) })
                .to_vec();
        let at = |cycle: u64| trace.iter().rev().find(|r| r.cycle.0 <= cycle).map_or(0, |r| r.levels.0);
        for (start, end) in [(0, 50), (1, 12), (3, 7), (9, 13), (0, 3), (38, 100), (10, 11)] {
            for count in 1..=60 {
                let found = columns(&trace, start, end, count);
                for i in 0..count {
                    let bound = |i: usize| start + (end - start) * i as u64 / count as u64;
                    let (first, after) = (bound(i), bound(i + 1).max(bound(i) + 1));
                    let expected = (first..after).fold((0, 0), |(h, l), c| (h | at(c), l | !at(c)));
                    assert_eq!((found.high[i], found.low[i]), expected, "{start}..{end} {i}/{count}");
                    assert_eq!(found.last[i], at(after - 1));
                }
            }
        }
    }
}
