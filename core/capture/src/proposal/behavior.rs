//! Measures each channel: number of edges, pulse widths, and whether it is a serial line.

use crate::capture::Change;
use crate::uart::{self, Edge, IdleLevel};

/// Edges that are inspected to detect a serial line.
const LINE_EDGES: usize = 600;
/// Minimum number of pulses of STEP.
pub(super) const MIN_STEPS: u64 = 4;

/// Measurements of a channel. Times are in ticks, between its first and last edge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Behavior {
    starts_high: bool,
    ends_high: bool,
    rises: u64,
    falls: u64,
    high: u64,
    low: u64,
    longest_high: u64,
    longest_low: u64,
    shortest_high: u64,
    last_edge: Option<u64>,
    /// The idle level if it is a serial line.
    pub(super) line: Option<IdleLevel>,
}

impl Behavior {
    fn edge(&mut self, tick: u64, was_high: bool) {
        let (edges, total, longest) = if was_high {
            (&mut self.falls, &mut self.high, &mut self.longest_high)
        } else {
            (&mut self.rises, &mut self.low, &mut self.longest_low)
        };
        *edges += 1;
        if let Some(last) = self.last_edge.replace(tick) {
            let length = tick - last;
            (*total, *longest) = (*total + length, length.max(*longest));
            if was_high {
                self.shortest_high = length.min(self.shortest_high);
            }
        }
    }

    pub(super) fn changes(&self) -> u64 {
        self.rises + self.falls
    }

    pub(super) const fn idles_high(&self) -> bool {
        self.starts_high && self.high > self.low
    }

    pub(super) const fn longest_pulse(&self) -> u64 {
        if self.idles_high() { self.longest_low } else { self.longest_high }
    }

    /// Whether it has pulses of similar width and idles low. No serial line does.
    pub(super) const fn has_equal_pulses(&self) -> bool {
        !self.starts_high
            && !self.ends_high
            && self.rises >= 2 * MIN_STEPS
            && self.longest_high <= self.shortest_high.saturating_mul(2)
    }
}

pub(super) fn behaviors(changes: &[Change], channels: usize) -> Vec<Behavior> {
    let none = Behavior { shortest_high: u64::MAX, ..Behavior::default() };
    let mut all = vec![none; channels];
    let (Some(first), Some(last)) = (changes.first(), changes.last()) else { return all };
    for (channel, each) in all.iter_mut().enumerate() {
        each.starts_high = first.levels >> channel & 1 == 1;
        each.ends_high = last.levels >> channel & 1 == 1;
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
        each.line = uart::detect_line(edges);
    }
    all
}
