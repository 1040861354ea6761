//! Measures each channel: number of edges, pulse widths, and whether it is a serial line.

use crate::capture::Change;
use crate::uart::{self, Edge, IdleLevel};

/// Maximum number of edges per channel that are inspected to detect a serial line.
const MAX_LINE_EDGES: usize = 600;
/// Minimum number of pulses of STEP.
pub(super) const MIN_STEPS: u64 = 4;
/// Minimum number of pulses whose widths are compared.
const MIN_UNIFORM_PULSES: u64 = 8;

/// Measurements of a channel. Times are in ticks, between its first and last edge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Behavior {
    starts_high: bool,
    ends_high: bool,
    rises: u64,
    falls: u64,
    high_ticks: u64,
    low_ticks: u64,
    longest_high: u64,
    longest_low: u64,
    shortest_high: Option<u64>,
    last_edge: Option<u64>,
    /// The idle level if it is a serial line.
    pub(super) line: Option<IdleLevel>,
}

impl Behavior {
    fn edge(&mut self, tick: u64, was_high: bool) {
        let (edges, total, longest) = if was_high {
            (&mut self.falls, &mut self.high_ticks, &mut self.longest_high)
        } else {
            (&mut self.rises, &mut self.low_ticks, &mut self.longest_low)
        };
        *edges += 1;
        if let Some(last) = self.last_edge.replace(tick) {
            let length = tick - last;
            (*total, *longest) = (*total + length, length.max(*longest));
            if was_high {
                self.shortest_high = Some(self.shortest_high.map_or(length, |shortest| shortest.min(length)));
            }
        }
    }

    pub(super) fn changes(&self) -> u64 {
        self.rises + self.falls
    }

    pub(super) const fn idles_high(&self) -> bool {
        self.starts_high && self.high_ticks > self.low_ticks
    }

    pub(super) const fn longest_pulse(&self) -> u64 {
        if self.idles_high() { self.longest_low } else { self.longest_high }
    }

    /// Idles low, with pulses of similar width (at most 2:1). A serial line idles high or has bits of different length.
    pub(super) fn has_uniform_pulses(&self) -> bool {
        !self.starts_high
            && !self.ends_high
            && self.rises >= MIN_UNIFORM_PULSES
            && self.shortest_high.is_none_or(|shortest| self.longest_high <= shortest.saturating_mul(2))
    }
}

pub(super) fn behaviors(changes: &[Change], channels: usize) -> Vec<Behavior> {
    let mut all = vec![Behavior::default(); channels];
    let (Some(first), Some(last)) = (changes.first(), changes.last()) else { return all };
    for (channel, behavior) in all.iter_mut().enumerate() {
        behavior.starts_high = (first.levels >> channel) & 1 == 1;
        behavior.ends_high = (last.levels >> channel) & 1 == 1;
    }
    let mut channel_edges: Vec<Vec<Edge>> = vec![Vec::new(); channels];
    for pair in changes.windows(2) {
        let [before, now] = pair else { continue };
        let mut changed = before.levels ^ now.levels;
        while changed != 0 {
            let channel = changed.trailing_zeros() as usize;
            // Clears the lowest set bit.
            changed &= changed - 1;
            let Some((behavior, edges)) = all.get_mut(channel).zip(channel_edges.get_mut(channel)) else {
                continue;
            };
            let was_high = (before.levels >> channel) & 1 == 1;
            if edges.len() < MAX_LINE_EDGES {
                edges.push(Edge { at: now.tick, high: !was_high });
            }
            behavior.edge(now.tick, was_high);
        }
    }
    for (behavior, edges) in all.iter_mut().zip(&channel_edges) {
        behavior.line = uart::detect_line(edges);
    }
    all
}
