//! Analyzes the edges of STEP: whether the driver may step at both edges, and whether pulses are low.

use crate::channel_map::{ChannelMap, EdgeHint, Entry, Input};
use crate::{capture::Capture, changes::MAX_INSPECTED};

/// Intervals that are needed to call edges evenly spaced.
const MIN_INTERVALS: u64 = 14;

#[derive(Clone, Copy, Debug, Default)]
struct Edges {
    last: Option<u64>,
    /// The two latest intervals, the later one first.
    latest: [u64; 2],
    intervals: u64,
    /// Intervals about equal to the mean of their neighbors.
    even: u64,
    /// Total times at each level.
    high: u64,
    low: u64,
}

impl Edges {
    fn add(&mut self, tick: u64, was_high: bool) {
        let Some(last) = self.last.replace(tick) else { return };
        let interval = tick - last;
        let total = if was_high { &mut self.high } else { &mut self.low };
        *total = total.saturating_add(interval);
        self.intervals += 1;
        let [middle, first] = self.latest;
        if self.intervals > 2 {
            let sum = first.saturating_add(interval);
            let deviation = sum.abs_diff(middle.saturating_mul(2));
            // Within an eighth of the interval, or, for intervals of at least eight samples, within one sample.
            self.even += u64::from(deviation.saturating_mul(8) <= sum || deviation <= 2 && sum >= 16);
        }
        self.latest = [interval, middle];
    }

    const fn is_even(&self) -> bool {
        self.intervals >= MIN_INTERVALS && self.even * 10 >= (self.intervals - 2) * 9
    }
}

impl ChannelMap {
    /// Hints for the motors whose edges are conclusive.
    pub fn edge_hints(&self, capture: &Capture) -> Vec<EdgeHint> {
        let step = |entry: &Entry| match Input::from_bit(entry.bit) {
            Some((Input::Step, motor)) => Some((motor as u8, *entry, Edges::default())),
            _ => None,
        };
        let mut motors: Vec<(u8, Entry, Edges)> = self.entries().iter().filter_map(step).collect();
        let Some(first) = capture.changes.first().filter(|_| !motors.is_empty()) else { return Vec::new() };
        let mut before = first.levels;
        for change in capture.changes.iter().take(MAX_INSPECTED) {
            let changed = core::mem::replace(&mut before, change.levels) ^ change.levels;
            for (_, entry, edges) in &mut motors {
                if changed >> entry.channel & 1 == 1 {
                    edges.add(change.tick, !entry.level(change.levels));
                }
            }
        }
        let hint = |(motor, entry, edges): (u8, Entry, Edges)| {
            let idles_high = edges.intervals >= MIN_INTERVALS / 2
                && entry.level(first.levels)
                && entry.level(before)
                && edges.low.saturating_mul(4) < edges.high;
            let both_edges = edges.is_even();
            let count = (capture.changes.len() <= MAX_INSPECTED).then_some(edges.intervals + 1);
            let hint = EdgeHint { motor, channel: entry.channel, both_edges, idles_high, edges: count };
            (hint.both_edges || hint.idles_high).then_some(hint)
        };
        motors.into_iter().filter_map(hint).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Change, Channel, Format};

    fn hint(first: u64, intervals: &[u64]) -> (bool, bool) {
        let mut at = 0;
        let edges = intervals.iter().zip(1..).map(|(interval, index)| {
            at += interval;
            Change { tick: at, levels: first ^ (index & 1) }
        });
        let changes = [Change { tick: 0, levels: first }].into_iter().chain(edges).collect();
        let channels = vec![Channel { name: "S".into() }];
        let capture = Capture { channels, changes, ..Capture::new(Format::Vcd) };
        let map = ChannelMap::parse("STEP0=S", &capture).expect("a map");
        let found = map.edge_hints(&capture).first().map(|hint| (hint.both_edges, hint.idles_high));
        found.unwrap_or_default()
    }

    #[test]
    fn evenly_spaced_edges_and_low_pulses_are_found() {
        let ramp: Vec<u64> = (0..40).map(|k| 4000 - 60 * k).collect();
        let period_ramp: Vec<u64> = (0..40).map(|k| 4000 - 60 * (k / 2)).collect();
        let fixed_width: Vec<u64> = (0..40).map(|k| if k % 2 == 1 { 500 } else { 2000 - 30 * k }).collect();
        for (first, intervals, expected) in [
            (0, &ramp[..], (true, false)),
            (0, &period_ramp, (true, false)),
            (0, &[100; 40], (true, false)),
            (0, &[100; 10], (false, false)),
            (0, &fixed_width, (false, false)),
            (0, &[60, 40].repeat(20), (false, false)),
            (0, &[8, 9].repeat(20), (true, false)),
            (0, &[90, 10].repeat(20), (false, false)),
            (1, &[90, 10].repeat(20), (false, true)),
            (1, &[90, 10].repeat(2), (false, false)),
        ] {
            assert_eq!(hint(first, intervals), expected, "{first} {intervals:?}");
        }
    }
}
