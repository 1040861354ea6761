//! Finds encoders, serial lines and STEP among channels whose names are unknown.

use super::motor::{Motor, Source};
use super::{behavior::MIN_STEPS, draft::Draft, timing::has_pulses_between};
use crate::names::{Kind, Meaning};
use crate::{channel_map::Entry, uart::IdleLevel};
use stepscope_peripheral::signal::Levels;

const MIN_ENCODER_EDGES: usize = 16;
const MAX_ENCODER_EDGES: usize = 4096;
/// Maximum ratio of the pulse widths of two motors.
const MAX_WIDTH_RATIO: u64 = 4;
/// A channel is too slow for a STEP if at least this percentage of its intervals contain pulses of the busiest channel.
const SLOW_PERCENT: usize = 80;

const LINES: [u32; 2] = [Levels::RX.trailing_zeros(), Levels::TX.trailing_zeros()];

impl Draft<'_> {
    pub(super) fn lines_by_behavior(&mut self) {
        let lines = self.unassigned().into_iter().filter(|channel| self.is_line(*channel));
        for (bit, channel) in LINES.into_iter().zip(lines.collect::<Vec<_>>()) {
            if self.bus_signals.iter().all(|entry| entry.bit != bit) {
                let inverted = self.behavior(channel).line == Some(IdleLevel::Low);
                self.bus_signals.push(Entry { bit, channel, inverted });
            }
        }
    }

    pub(super) fn encoders_by_behavior(&mut self) {
        let has_enough_edges =
            |channel: &usize| self.behavior(*channel).changes() >= MIN_ENCODER_EDGES as u64 / 2;
        let edges = |channel: usize| {
            let mut edges = self.edges(channel);
            edges.truncate(MAX_ENCODER_EDGES);
            (channel, edges)
        };
        let channels: Vec<(usize, Vec<u64>)> =
            self.unassigned().into_iter().filter(has_enough_edges).map(edges).collect();
        let mut used: Vec<usize> = Vec::new();
        for (at, (a, edges_a)) in channels.iter().enumerate() {
            for (b, edges_b) in channels.iter().skip(at + 1) {
                let (count_a, count_b) = (self.behavior(*a).changes(), self.behavior(*b).changes());
                let is_similar = count_a.abs_diff(count_b) * 20 <= count_a + count_b;
                let is_free = !used.contains(a) && !used.contains(b);
                if is_free && is_similar && alternate(edges_a, edges_b) {
                    used.extend([*a, *b]);
                    self.motors.push(Motor::new("", "", Source::Encoder(*a, *b)));
                }
            }
        }
    }

    pub(super) fn steps_by_behavior(&mut self) {
        if self.motors.iter().any(|motor| matches!(motor.source, Source::Step(_) | Source::CwCcw(..))) {
            return;
        }
        // A pulse has two edges.
        let has_enough_edges = |channel: &usize| self.behavior(*channel).changes() >= 2 * MIN_STEPS;
        let channels: Vec<usize> =
            self.unassigned_without_lines().into_iter().filter(has_enough_edges).collect();
        let busiest = channels
            .iter()
            .copied()
            .max_by_key(|channel| (self.behavior(*channel).changes(), usize::MAX - channel));
        let Some(busiest) = busiest else { return };
        let edges = self.edges(busiest);
        let max_width = self.behavior(busiest).longest_pulse().saturating_mul(MAX_WIDTH_RATIO);
        for channel in channels {
            let is_wide = self.behavior(channel).longest_pulse() > max_width;
            let is_slow = || has_pulses_between(&self.edges(channel), &edges, SLOW_PERCENT);
            if channel != busiest && (is_wide || is_slow()) {
                continue;
            }
            let source = Source::Step(channel);
            // The STEP of a motor of which only DIR has a name.
            match self.motors.iter_mut().find(|motor| motor.source == Source::None) {
                Some(motor) => motor.source = source,
                None => self.motors.push(Motor::new("", "", source)),
            }
        }
    }

    /// Inverts a STEP that idles high, unless its name determines the polarity.
    pub(super) fn polarity(&mut self) {
        let low = |motor: &Motor| {
            let channel = motor.step()?;
            let is_stated = match self.meanings.get(channel) {
                Some(Meaning::Signal(named)) if named.kind == Kind::Step => !named.is_negative,
                _ => false,
            };
            (!is_stated).then(|| self.behavior(channel).idles_high())
        };
        let low: Vec<Option<bool>> = self.motors.iter().map(low).collect();
        for (motor, low) in self.motors.iter_mut().zip(low) {
            motor.inverted = low.unwrap_or(motor.inverted);
        }
    }
}

/// Whether the edges of two channels alternate evenly, as an encoder's do.
fn alternate(a: &[u64], b: &[u64]) -> bool {
    // Only the time up to which the edges of both are known.
    let end = a.last().min(b.last()).copied().unwrap_or(0);
    let edges = |ticks: &[u64], is_b: bool| -> Vec<(u64, bool)> {
        ticks.iter().take_while(|tick| **tick <= end).map(|tick| (*tick, is_b)).collect()
    };
    let mut all = [edges(a, false), edges(b, true)].concat();
    all.sort_unstable();
    let pairs = || all.iter().zip(all.iter().skip(1));
    let same_channel = pairs().filter(|(edge, next)| edge.1 == next.1).count();
    let simultaneous = pairs().filter(|(edge, next)| edge.0 == next.0).count();
    let intervals: Vec<u64> = pairs().map(|(edge, next)| next.0 - edge.0).collect();
    let is_even = |pair: &&[u64]| matches!(pair, [first, next] if first.saturating_mul(4) >= *next && next.saturating_mul(4) >= *first);
    let even = intervals.windows(2).filter(is_even).count();
    all.len() >= MIN_ENCODER_EDGES
        && same_channel * 20 <= all.len()
        && simultaneous * 50 <= all.len()
        && even * 10 >= intervals.len().saturating_sub(1) * 7
}
