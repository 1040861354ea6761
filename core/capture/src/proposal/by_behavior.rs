//! Finds encoders, serial lines and STEP among channels whose names are unknown.

use super::{
    behavior::MIN_STEPS,
    draft::Draft,
    motor::{Motor, Source},
    timing::has_steps_between,
};
use crate::{
    channel_map::Entry,
    names::{Kind, Meaning},
};
use stepscope_peripheral::signal::Levels;

const MIN_ENCODER_EDGES: usize = 16;
const MAX_ENCODER_EDGES: usize = 4096;
/// Maximum ratio of the pulse widths of two motors.
const MAX_WIDTH_RATIO: u64 = 4;

const LINES: [u32; 2] = [Levels::RX.trailing_zeros(), Levels::TX.trailing_zeros()];

impl Draft<'_> {
    pub(super) fn lines_by_behavior(&mut self) {
        let lines = self.free().into_iter().filter(|channel| self.is_line(*channel));
        for (bit, channel) in LINES.into_iter().zip(lines.collect::<Vec<_>>()) {
            if self.others.iter().all(|entry| entry.bit != bit) {
                let inverted = self.behavior(channel).line == Some(true);
                self.others.push(Entry { bit, channel, inverted });
            }
        }
    }

    pub(super) fn encoders_by_behavior(&mut self) {
        let busy = |channel: &usize| self.behavior(*channel).changes() >= MIN_ENCODER_EDGES as u64 / 2;
        let free: Vec<usize> = self.free().into_iter().filter(busy).collect();
        let edges: Vec<Vec<u64>> = free
            .iter()
            .map(|channel| {
                let mut edges = self.edges(*channel);
                edges.truncate(MAX_ENCODER_EDGES);
                edges
            })
            .collect();
        let mut used: Vec<usize> = Vec::new();
        for (at, (one, one_edges)) in free.iter().zip(&edges).enumerate() {
            for (other, other_edges) in free.iter().zip(&edges).skip(at + 1) {
                let (a, b) = (self.behavior(*one).changes(), self.behavior(*other).changes());
                let is_free = !used.contains(one) && !used.contains(other);
                if is_free && a.abs_diff(b) * 20 <= a + b && alternate(one_edges, other_edges) {
                    used.extend([*one, *other]);
                    self.motors.push(Motor::new("", "", Source::Encoder(*one, *other)));
                }
            }
        }
    }

    pub(super) fn steps_by_behavior(&mut self) {
        if self.motors.iter().any(|motor| matches!(motor.source, Source::Step(_) | Source::CwCcw(..))) {
            return;
        }
        let busy = |channel: &usize| self.behavior(*channel).changes() >= 2 * MIN_STEPS;
        let free: Vec<usize> = self.free_of_lines().into_iter().filter(busy).collect();
        let busiest = free
            .iter()
            .copied()
            .max_by_key(|channel| (self.behavior(*channel).changes(), usize::MAX - channel));
        let Some(first) = busiest else { return };
        let first_edges = self.edges(first);
        let widest = self.behavior(first).longest_pulse().saturating_mul(MAX_WIDTH_RATIO);
        for channel in free {
            let own = self.behavior(channel);
            let is_slow = || has_steps_between(&self.edges(channel), &first_edges, 80);
            if channel != first && (own.longest_pulse() > widest || is_slow()) {
                continue;
            }
            let source = Source::Step(channel);
            // A named DIR may belong to the only motor.
            match self.motors.iter_mut().find(|motor| motor.source == Source::None) {
                Some(motor) => motor.source = source,
                None => self.motors.push(Motor::new("", "", source)),
            }
        }
    }

    /// STEP is active low if its name says so, or if it idles high and the name says nothing.
    pub(super) fn polarity(&mut self) {
        let low = |motor: &Motor| {
            let channel = motor.step()?;
            let is_stated = match self.meanings.get(channel) {
                Some(Meaning::Signal(named)) if named.kind == Kind::Step => !named.negative,
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
fn alternate(one: &[u64], other: &[u64]) -> bool {
    // Only the time for which both are known.
    let end = one.last().min(other.last()).copied().unwrap_or(0);
    let until = |edges: &&u64| **edges <= end;
    let first = one.iter().take_while(until).map(|at| (*at, false));
    let mut all: Vec<(u64, bool)> =
        first.chain(other.iter().take_while(until).map(|at| (*at, true))).collect();
    all.sort_unstable();
    let pairs = || all.iter().zip(all.iter().skip(1));
    let (count, same) = (all.len(), pairs().filter(|(edge, next)| edge.1 == next.1).count());
    let at_once = pairs().filter(|(edge, next)| edge.0 == next.0).count();
    let intervals: Vec<u64> = pairs().map(|(edge, next)| next.0 - edge.0).collect();
    let is_even = |pair: &&[u64]| matches!(pair, [one, next] if one.saturating_mul(4) >= *next && next.saturating_mul(4) >= *one);
    let even = intervals.windows(2).filter(is_even).count();
    count >= MIN_ENCODER_EDGES
        && same * 20 <= count
        && at_once * 50 <= count
        && even * 10 >= intervals.len().saturating_sub(1) * 7
}
