//! Measures each channel: number of changes, pulse widths, and whether it is a serial line.

use crate::{
    capture::Change,
    uart::{self, Edge},
};

/// Edges that are inspected to detect a serial line.
const LINE_EDGES: usize = 600;
/// Minimum number of pulses of STEP.
pub(super) const MIN_STEPS: u64 = 4;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Behavior {
    pub(super) first: bool,
    pub(super) last: bool,
    pub(super) rises: u64,
    pub(super) falls: u64,
    pub(super) high: u64,
    pub(super) low: u64,
    pub(super) longest_high: u64,
    pub(super) longest_low: u64,
    pub(super) shortest_high: u64,
    pub(super) shortest_low: u64,
    pub(super) since: Option<u64>,
    /// Whether it is a serial line; if so, whether it is inverted.
    pub(super) line: Option<bool>,
}

impl Behavior {
    fn edge(&mut self, tick: u64, was_high: bool) {
        let (edges, sum, longest, shortest) = if was_high {
            (&mut self.falls, &mut self.high, &mut self.longest_high, &mut self.shortest_high)
        } else {
            (&mut self.rises, &mut self.low, &mut self.longest_low, &mut self.shortest_low)
        };
        *edges += 1;
        if let Some(since) = self.since.replace(tick) {
            let length = tick - since;
            (*sum, *longest, *shortest) = (*sum + length, length.max(*longest), length.min(*shortest));
        }
    }

    pub(super) fn changes(&self) -> u64 {
        self.rises + self.falls
    }

    pub(super) const fn idles_high(&self) -> bool {
        self.first && self.high > self.low
    }

    pub(super) const fn longest_pulse(&self) -> u64 {
        if self.idles_high() { self.longest_low } else { self.longest_high }
    }

    /// Equal pulses, low when idle, which no serial line has.
    pub(super) const fn is_pulses(&self) -> bool {
        !self.first
            && !self.last
            && self.rises >= 2 * MIN_STEPS
            && self.longest_high <= self.shortest_high.saturating_mul(2)
    }
}

pub(super) fn behaviors(changes: &[Change], channels: usize) -> Vec<Behavior> {
    let never = u64::MAX;
    let none = Behavior { shortest_high: never, shortest_low: never, ..Behavior::default() };
    let mut all = vec![none; channels];
    let (Some(first), Some(last)) = (changes.first(), changes.last()) else { return all };
    for (channel, each) in all.iter_mut().enumerate() {
        (each.first, each.last) = (first.levels >> channel & 1 == 1, last.levels >> channel & 1 == 1);
    }
    let mut edges: Vec<Vec<Edge>> = vec![Vec::new(); channels];
    for pair in changes.windows(2) {
        let [before, now] = pair else { continue };
        let mut changed = before.levels ^ now.levels;
        while changed != 0 {
            let channel = changed.trailing_zeros() as usize;
            changed &= changed - 1;
            let (Some(each), Some(edges)) = (all.get_mut(channel), edges.get_mut(channel)) else { continue };
            let was_high = before.levels >> channel & 1 == 1;
            if edges.len() < LINE_EDGES {
                edges.push(Edge { at: now.tick, high: !was_high });
            }
            each.edge(now.tick, was_high);
        }
    }
    for (each, edges) in all.iter_mut().zip(&edges) {
        each.line = uart::looks_like_a_line(edges);
    }
    all
}
