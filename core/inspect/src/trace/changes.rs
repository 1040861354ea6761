//! A pyramid over the levels of a long trace: the time to draw a view depends on its pixels, not on its records.
//!
//! ```text
//! level 1   [ signals high, signals low in 1024 records ] [ … ]      16 bytes per block
//! level 0   [ … in 64 records ] [ … ] [ … ]                          16 bytes per block
//! trace     r r r r r r r r r r r r r r r r r r r r r r r r r r      16 bytes per record
//! ```
//!
//! Masks are exact, so a search skips every block in which its signal is constant. All levels take about a quarter of
//! a byte per record.

use alloc::{vec, vec::Vec};
use stepscope_peripheral::signal::Record;

/// Records per block of level 0.
const BLOCK: usize = 64;
/// Blocks per block of the next level.
const FAN_OUT: usize = 16;

/// Pixel columns of a logic view, one bit per signal. Nothing is sampled: a glitch of one cycle shows in any column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// High in some cycle of the column.
    pub high: Vec<u64>,
    /// Low in some cycle of the column.
    pub low: Vec<u64>,
    /// Levels at the end of the column.
    pub last: Vec<u64>,
}

/// Signals that were high or low in a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Block {
    high: u64,
    low: u64,
}

impl Block {
    fn of(levels: u64) -> Self {
        Self { high: levels, low: !levels }
    }

    fn and(self, other: Self) -> Self {
        Self { high: self.high | other.high, low: self.low | other.low }
    }

    fn has(self, mask: u64, high: bool) -> bool {
        mask & if high { self.high } else { self.low } != 0
    }
}

/// The edges that a search finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    Any,
    Rise,
    Fall,
}

/// The pyramid over one trace. Every method takes the same trace, which may have grown since.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    levels: Vec<Vec<Block>>,
}

impl Changes {
    /// Adds the records since the last call.
    pub fn extend(&mut self, trace: &[Record]) {
        let first = self.level(0);
        let known = first.len() * BLOCK;
        let records = trace.get(known..).unwrap_or_default().chunks_exact(BLOCK);
        first.extend(records.map(|block| {
            block.iter().fold(Block::default(), |all, record| all.and(Block::of(record.levels.0)))
        }));
        for level in 1.. {
            let known = self.level(level).len() * FAN_OUT;
            let (lower, upper) = self.levels.split_at_mut(level);
            let (Some(lower), Some(upper)) = (lower.last(), upper.first_mut()) else { return };
            let blocks = lower.get(known..).unwrap_or_default().chunks_exact(FAN_OUT);
            upper.extend(blocks.map(|block| block.iter().fold(Block::default(), |all, one| all.and(*one))));
            if upper.len() < FAN_OUT {
                return;
            }
        }
    }

    fn level(&mut self, index: usize) -> &mut Vec<Block> {
        if self.levels.len() <= index {
            self.levels.resize(index + 1, Vec::new());
        }
        &mut self.levels[index]
    }

    /// Memory of the pyramid in bytes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| level.capacity() * size_of::<Block>()).sum()
    }

    /// The cycles `start..end` as `count` columns: column i starts at start + floor(i*span/count) and has at least one
    /// cycle. `margin` columns are added on each side. Columns before cycle 0 have no levels; those after the last record
    /// repeat its levels.
    pub fn columns(&self, trace: &[Record], start: u64, end: u64, count: usize, margin: usize) -> Columns {
        let span = i128::from(end.saturating_sub(start).max(1));
        let total = count + 2 * margin;
        let bound = |i: usize| {
            let i = i as i128 - margin as i128;
            i128::from(start) + (span * i).div_euclid(count.max(1) as i128)
        };
        let mut result = Columns { high: vec![0; total], low: vec![0; total], last: vec![0; total] };
        let mut until = 0_usize;
        for i in 0..total {
            let (first, after) = (bound(i), bound(i + 1).max(bound(i) + 1));
            let (Ok(after), first) = (u64::try_from(after), u64::try_from(first).unwrap_or(0)) else {
                continue;
            };
            if after == 0 {
                continue;
            }
            // Columns narrower than a cycle share it.
            let last_cycle = trace.get(until.saturating_sub(1)).map_or(0, |record| record.cycle.0);
            let from = if last_cycle > first { until.saturating_sub(1) } else { until };
            let begin = from + gallop(trace.get(from..).unwrap_or_default(), first);
            until = begin + gallop(trace.get(begin..).unwrap_or_default(), after - 1);
            let level =
                |index: usize| index.checked_sub(1).and_then(|i| trace.get(i)).map_or(0, |r| r.levels.0);
            let levels = Block::of(level(begin)).and(self.levels_between(trace, begin, until));
            result.high[i] = levels.high;
            result.low[i] = levels.low;
            result.last[i] = level(until);
        }
        result
    }

    /// Levels of the records `first..after`.
    fn levels_between(&self, trace: &[Record], first: usize, after: usize) -> Block {
        let mut all = Block::default();
        let mut at = first;
        while at < after {
            let (mut largest, mut size) = (None, BLOCK);
            for level in &self.levels {
                if !at.is_multiple_of(size) || at + size > after {
                    break;
                }
                let Some(block) = level.get(at / size) else { break };
                largest = Some((*block, size));
                size *= FAN_OUT;
            }
            let (block, size) = largest.unwrap_or_else(|| {
                let until = (at / BLOCK * BLOCK + BLOCK).min(after);
                let records = trace.get(at..until).unwrap_or_default();
                (records.iter().fold(Block::default(), |all, r| all.and(Block::of(r.levels.0))), until - at)
            });
            all = all.and(block);
            at += size;
        }
        all
    }

    /// Index of the next edge of signal `bit` after cycle `at`. The levels of the first record are no edge.
    pub fn next_edge(&self, trace: &[Record], bit: u8, at: u64, edge: Edge) -> Option<usize> {
        let mask = 1_u64.checked_shl(bit.into())?;
        let first = trace.partition_point(|record| record.cycle.0 <= at).max(1);
        let high = trace.get(first - 1)?.levels.has(mask);
        let found = self.first_at(trace, first, mask, !high)?;
        match edge {
            Edge::Rise if high => self.first_at(trace, found, mask, true),
            Edge::Fall if !high => self.first_at(trace, found, mask, false),
            _ => Some(found),
        }
    }

    /// Index of the last edge of signal `bit` before cycle `at`.
    pub fn previous_edge(&self, trace: &[Record], bit: u8, at: u64, edge: Edge) -> Option<usize> {
        let mask = 1_u64.checked_shl(bit.into())?;
        let after = trace.partition_point(|record| record.cycle.0 < at);
        let high = trace.get(after.checked_sub(1)?)?.levels.has(mask);
        let before = self.last_at(trace, after, mask, !high)?;
        match edge {
            Edge::Rise if !high => Some(self.last_at(trace, before, mask, false)? + 1),
            Edge::Fall if high => Some(self.last_at(trace, before, mask, true)? + 1),
            _ => Some(before + 1),
        }
    }

    /// Index of the first record from `at` on in which a signal of `mask` has the level `high`.
    fn first_at(&self, trace: &[Record], at: usize, mask: u64, high: bool) -> Option<usize> {
        let mut at = at;
        loop {
            let (mut skipped, mut size) = (0, BLOCK);
            for level in &self.levels {
                match level.get(at / size) {
                    Some(block) if at.is_multiple_of(size) && !block.has(mask, high) => skipped = size,
                    _ => break,
                }
                size *= FAN_OUT;
            }
            if skipped == 0 {
                let until = at / BLOCK * BLOCK + BLOCK;
                let rest = trace.get(at..until.min(trace.len())).filter(|rest| !rest.is_empty())?;
                let found = rest.iter().position(|record| Block::of(record.levels.0).has(mask, high));
                if let Some(found) = found {
                    return Some(at + found);
                }
                skipped = until - at;
            }
            at += skipped;
        }
    }

    /// Index of the last such record before `end`.
    fn last_at(&self, trace: &[Record], end: usize, mask: u64, high: bool) -> Option<usize> {
        let mut end = end;
        while end > 0 {
            let (mut skipped, mut size) = (0, BLOCK);
            for level in &self.levels {
                match (end / size).checked_sub(1).and_then(|index| level.get(index)) {
                    Some(block) if end.is_multiple_of(size) && !block.has(mask, high) => skipped = size,
                    _ => break,
                }
                size *= FAN_OUT;
            }
            if skipped == 0 {
                let from = (end - 1) / BLOCK * BLOCK;
                let records = trace.get(from..end).unwrap_or_default();
                let found = records.iter().rposition(|record| Block::of(record.levels.0).has(mask, high));
                if let Some(found) = found {
                    return Some(from + found);
                }
                skipped = end - from;
            }
            end -= skipped;
        }
        None
    }
}

/// Number of records up to `cycle`, by exponential search, because the result is usually small.
fn gallop(trace: &[Record], cycle: u64) -> usize {
    let mut reach = 1;
    while trace.get(reach - 1).is_some_and(|record| record.cycle.0 <= cycle) {
        reach *= 2;
    }
    let near = reach / 2;
    let within = trace.get(near..reach.min(trace.len())).unwrap_or_default();
    near + within.partition_point(|record| record.cycle.0 <= cycle)
}

#[cfg(test)]
mod tests;
