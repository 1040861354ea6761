//! Edges for the logic view: the next edge, the pulse at a cycle, lists and counts.
//!
//! Searches use the pyramid of [`changes`](crate::trace::changes), so they do not scan the trace.

use crate::trace::changes::{Changes, Edge};
use alloc::vec::Vec;
use serde::Serialize;
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::{trace::levels_at, units::Instant};

const SIGNALS: u32 = 36;

/// One edge of one signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct EdgeRow {
    pub cycle: u64,
    pub bit: u32,
    pub high: bool,
}

/// Edges in ascending order of cycles.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct EdgeList {
    pub rows: Vec<EdgeRow>,
    /// Whether there are more in the requested direction.
    pub more: bool,
}

/// The high or low pulse of a signal at a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Pulse {
    pub high: bool,
    /// Cycle of the edge that began it; `None` for the initial level.
    pub begin: Option<u64>,
    pub end: Option<u64>,
    pub next: Option<u64>,
}

/// A trace with its pyramid.
#[derive(Clone, Copy)]
pub struct Signals<'a> {
    pub trace: &'a [Record],
    pub changes: &'a Changes,
}

impl Signals<'_> {
    pub fn level(&self, bit: u8, cycle: u64) -> bool {
        levels_at(self.trace, Instant(cycle)).has(1 << bit.min(63))
    }

    /// Cycle of the first edge after `cycle`, or of the last one before it (`forward` = false).
    pub fn next(&self, bit: u8, cycle: u64, forward: bool, edge: Edge) -> Option<u64> {
        let found = self.edge(bit, cycle, forward, edge);
        found.and_then(|index| self.trace.get(index)).map(|record| record.cycle.0)
    }

    pub fn pulse_at(&self, bit: u8, cycle: u64) -> Pulse {
        let end = self.next(bit, cycle, true, Edge::Any);
        Pulse {
            high: self.level(bit, cycle),
            begin: self.next(bit, cycle.saturating_add(1), false, Edge::Any),
            end,
            next: end.and_then(|end| self.next(bit, end, true, Edge::Any)),
        }
    }

    /// Edges of one or all signals after `cycle` (`None`: from reset) or before it: at least `max`, with whole cycles.
    pub fn list(&self, bit: Option<u8>, cycle: Option<u64>, forward: bool, max: usize) -> EdgeList {
        let at = cycle.unwrap_or(0);
        let mut index = match (forward, cycle) {
            (true, None) => 1,
            (true, Some(at)) => self.trace.partition_point(|record| record.cycle.0 <= at).max(1),
            (false, _) => self.trace.partition_point(|record| record.cycle.0 < at),
        };
        let mut list = EdgeList::default();
        while let Some(found) = self.changed_from(bit, index, forward) {
            if list.rows.len() >= max {
                list.more = true;
                break;
            }
            let (before, now) = (self.levels(found - 1), self.levels(found));
            let bits = (0..SIGNALS).filter(|signal| (before ^ now) >> signal & 1 == 1);
            let shown = bits.filter(|&signal| bit.is_none_or(|bit| u32::from(bit) == signal));
            let cycle = self.trace.get(found).map_or(0, |record| record.cycle.0);
            let edge = |signal| EdgeRow { cycle, bit: signal, high: now >> signal & 1 == 1 };
            // A backward list is reversed at the end, so the rows of one cycle are added in reverse, too.
            if forward {
                list.rows.extend(shown.map(edge));
            } else {
                list.rows.extend(shown.rev().map(edge));
            }
            index = if forward { found + 1 } else { found };
        }
        if !forward {
            list.rows.reverse();
        }
        list
    }

    /// Index of the next record, from `index` on or before it, in which one or any signal changes.
    fn changed_from(&self, bit: Option<u8>, index: usize, forward: bool) -> Option<usize> {
        match (bit, forward) {
            (Some(bit), true) => {
                let before = self.trace.get(index.checked_sub(1)?)?.cycle.0;
                self.edge(bit, before, true, Edge::Any)
            }
            (Some(bit), false) => {
                let after = self.trace.get(index).map_or(u64::MAX, |record| record.cycle.0);
                self.edge(bit, after, false, Edge::Any)
            }
            (None, true) => (index < self.trace.len()).then_some(index),
            (None, false) => index.checked_sub(1).filter(|&index| index > 0),
        }
    }

    fn edge(&self, bit: u8, cycle: u64, forward: bool, edge: Edge) -> Option<usize> {
        if forward {
            self.changes.next_edge(self.trace, bit, cycle, edge)
        } else {
            self.changes.previous_edge(self.trace, bit, cycle, edge)
        }
    }

    fn levels(&self, index: usize) -> u64 {
        self.trace.get(index).map_or(0, |record| record.levels.0)
    }
}

/// Number of edges of all signals.
pub fn count(trace: &[Record]) -> u64 {
    let pairs = trace.iter().zip(trace.iter().skip(1));
    pairs.map(|(before, now)| u64::from((before.levels.0 ^ now.levels.0).count_ones())).sum()
}

/// Bits of the signals that change.
pub fn changing(trace: &[Record]) -> Vec<u8> {
    let Levels(first) = trace.first().map_or(Levels::RESET, |record| record.levels);
    let mask = trace.iter().fold(0, |mask, record| mask | (record.levels.0 ^ first));
    (0..64).filter(|bit| mask >> bit & 1 == 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_in_both_directions_include_all_edges_of_a_cycle() {
        let trace = [(0, 0b00), (5, 0b11), (9, 0b10), (12, 0b00)];
        let trace = trace.map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
        let mut changes = Changes::default();
        changes.extend(&trace);
        let signals = Signals { trace: &trace, changes: &changes };
        let list = |bit, cycle, forward, max| {
            let found = signals.list(bit, cycle, forward, max);
            (found.rows.iter().map(|row| (row.cycle, row.bit, row.high)).collect::<Vec<_>>(), found.more)
        };
        assert_eq!(list(None, None, true, 1), ([(5, 0, true), (5, 1, true)].to_vec(), true));
        assert_eq!(
            list(None, Some(12), false, 2),
            ([(5, 0, true), (5, 1, true), (9, 0, false)].to_vec(), false)
        );
        assert_eq!(list(Some(1), Some(5), true, 9), ([(12, 1, false)].to_vec(), false));
        assert_eq!(signals.pulse_at(1, 7), Pulse { high: true, begin: Some(5), end: Some(12), next: None });
        assert_eq!((count(&trace), changing(&trace)), (4, [0, 1].to_vec()));
    }

    #[test]
    fn the_first_pulse_of_a_run_has_the_default_width() {
        use crate::trace::stored_run::StoredRun;
        use crate::trace::{changes::Changes, edges::Signals};
        use stepscope_peripheral::trace::steps;
        use stepscope_sim::Experiment;

        let experiment = Experiment::from_json("{}").expect("the default motion");
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        let mut changes = Changes::default();
        changes.extend(&recording.trace);
        let signals = Signals { trace: &recording.trace, changes: &changes };
        let pulse = signals.pulse_at(0, steps(&recording.trace, 0)[0].cycle);
        assert!(pulse.high);
        assert_eq!(pulse.end.zip(pulse.begin).map(|(end, begin)| end - begin), Some(40));
    }
}
