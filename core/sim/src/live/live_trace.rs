//! The last records of an endless session, and its positions (LIVE H4).

use alloc::{collections::VecDeque, vec, vec::Vec};
use stepscope_peripheral::signal::{Levels, Record, Sink};
use stepscope_peripheral::units::Instant;

/// A ring buffer of records.
#[derive(Clone, Debug)]
pub struct LiveTrace {
    /// Invariant: at most `max`, rising in time.
    records: VecDeque<Record>,
    max: usize,
    /// The levels before the first record, and whether older ones were dropped.
    before: Levels,
    is_cut: bool,
}

/// Positions at regular times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PositionCurve {
    /// Later than requested if the ring begins later.
    pub from: Instant,
    pub to: Instant,
    pub channels: Vec<Vec<i32>>,
}

impl LiveTrace {
    /// A ring of `max` records, at least one.
    pub fn new(max: usize) -> Self {
        Self { records: VecDeque::new(), max: max.max(1), before: Levels::RESET, is_cut: false }
    }

    pub fn len(&self) -> usize {
        self.records.len()
    }

    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// `points` positions per channel in a window of time; `now` has the positions after the last record.
    pub fn positions(&self, now: &[i32], (from, to): (Instant, Instant), points: usize) -> PositionCurve {
        let oldest = self.records.front().filter(|_| self.is_cut).map_or(from, |first| first.cycle);
        let from = from.max(oldest).min(to);
        let span = to.0 - from.0;
        let last = points.saturating_sub(1).max(1) as u64;
        let mut at = now.to_vec();
        let mut channels = vec![vec![0; points]; now.len()];
        let mut records = self.records.iter().rev().peekable();
        for point in (0..points).rev() {
            let time = from.0 + (u128::from(span) * point as u128 / u128::from(last)) as u64;
            while let Some(record) = records.next_if(|record| record.cycle.0 > time) {
                let before = records.peek().map_or(self.before, |before| before.levels);
                undo(&mut at, before, record.levels);
            }
            for (channel, position) in channels.iter_mut().zip(&at) {
                if let Some(value) = channel.get_mut(point) {
                    *value = *position;
                }
            }
        }
        PositionCurve { from, to, channels }
    }
}

fn undo(positions: &mut [i32], before: Levels, levels: Levels) {
    let rises = levels.step() & !before.step();
    for (channel, position) in positions.iter_mut().enumerate() {
        if rises >> channel & 1 == 1 {
            let right = levels.dir() >> channel & 1 == 1;
            *position = if right { position.wrapping_sub(1) } else { position.wrapping_add(1) };
        }
    }
}

impl Sink for LiveTrace {
    fn record(&mut self, record: Record) {
        if self.records.len() == self.max
            && let Some(first) = self.records.pop_front()
        {
            self.before = first.levels;
            self.is_cut = true;
        }
        self.records.push_back(record);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;
    use stepscope_scenario::Scenario;

    const TWO: &str = r#"{ "bus": { "channels": 2 },
        "source": { "packets": { "packets": ["8503", "0082", "0a81"] } }, "run_cycles": 400000 }"#;

    /// A trace of a run, the same in a ring, and the positions at its end.
    fn run(max: usize) -> (Vec<Record>, LiveTrace, Vec<i32>) {
        let experiment = Experiment::new(&Scenario::from_json(TWO).expect("reads")).expect("no problems");
        let (mut all, mut ring) = (Vec::new(), LiveTrace::new(max));
        let run = experiment.run(&mut (&mut all, &mut ring));
        let positions = run.positions()[..2].to_vec();
        (all, ring, positions)
    }

    /// Positions in a cycle, counted from the beginning.
    fn counted(records: &[Record], cycle: u64) -> Vec<i32> {
        let (mut positions, mut before) = (vec![0, 0], Levels::RESET);
        for record in records.iter().take_while(|record| record.cycle.0 <= cycle) {
            for (channel, position) in positions.iter_mut().enumerate() {
                let bit = |levels: u16| levels >> channel & 1 == 1;
                if bit(record.levels.step()) && !bit(before.step()) {
                    *position += if bit(record.levels.dir()) { 1 } else { -1 };
                }
            }
            before = record.levels;
        }
        positions
    }

    #[test]
    fn positions_counted_back_from_the_end_are_those_counted_from_the_beginning() {
        for max in [1_000_000, 30] {
            let (all, ring, now) = run(max);
            assert!(all.len() > 60 && ring.len() == all.len().min(max), "{}", all.len());
            assert_ne!(now, [0, 0]);
            let end = all.last().expect("it has some").cycle;
            let curve = ring.positions(&now, (Instant(0), end), 101);
            let oldest = all[all.len() - ring.len()].cycle;
            assert_eq!(curve.from, if max < all.len() { oldest } else { Instant(0) });
            for point in 0..=100 {
                let time = curve.from.0 + (end.0 - curve.from.0) * point / 100;
                let found: Vec<i32> = curve.channels.iter().map(|line| line[point as usize]).collect();
                assert_eq!(found, counted(&all, time), "{max}: {time}");
            }
        }
    }

    #[test]
    fn empty_and_late_windows_have_the_last_position() {
        let (_, ring, now) = run(10);
        for window in [(Instant(u64::MAX), Instant(u64::MAX)), (Instant(1 << 40), Instant(1 << 41))] {
            let curve = ring.positions(&now, window, 2);
            assert_eq!(curve.channels, [[now[0]; 2], [now[1]; 2]], "{window:?}");
        }
        assert!(LiveTrace::new(0).positions(&[], (Instant(0), Instant(9)), 0).channels.is_empty());
    }

    #[test]
    fn the_ring_drops_the_oldest_records() {
        use crate::live_trace::LiveTrace;
        use stepscope_peripheral::{
            signal::{Levels, Record, Sink},
            units::Instant,
        };

        let mut trace = LiveTrace::new(1000);
        // A step to the right in cycle 10.
        trace.record(Record { cycle: Instant(10), levels: Levels(1 | 1 << Levels::DIR_SHIFT) });
        let curve = trace.positions(&[1], (Instant(0), Instant(20)), 3);
        assert_eq!(curve.channels, [[0, 1, 1]]);
    }
}
