//! Assigns DIR channels to motors by their levels.

use super::timing::{are_close_to_pulses, has_pulses_between, total_distance};
use super::{behavior::MIN_STEPS, draft::Draft};
use crate::names::shared_words;
use crate::short_sort::ShortSort as _;
use std::collections::BTreeSet;

/// Minimum share of a candidate's intervals that contain pulses, in percent, if it changes during pulses.
const PULSES_BETWEEN_PERCENT: usize = 50;

/// A motor without a DIR.
struct MotorEdges {
    motor: usize,
    channel: usize,
    /// Times of the edges of STEP.
    edges: Vec<u64>,
}

/// How well a channel fits as a motor's DIR; the best is the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Fit {
    fits_another_motor: bool,
    /// All steps are at one level.
    has_one_level: bool,
    changes_during_pulses: bool,
    /// Its order among DIR candidates differs from the order of the motors' STEP.
    is_out_of_order: bool,
    distance: usize,
    /// It is about as close to the pulses of another motor.
    is_shared: bool,
}

/// A possible DIR of a motor; the best is the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Candidate {
    fit: Fit,
    channel: usize,
    motor: usize,
}

impl Draft<'_> {
    pub(super) fn dirs_by_behavior(&mut self) {
        let motors = self.motors_without_dir();
        if motors.is_empty() {
            return;
        }
        let channels = self.unassigned_without_lines();
        let mut candidates: Vec<Candidate> =
            channels.into_iter().flat_map(|channel| self.candidates(channel, &motors)).collect();
        let has_one_each = mark_out_of_order(&mut candidates, &motors);
        candidates.sort_short_by_key(|candidate| *candidate);
        let first = candidates.first().map(|candidate| candidate.channel);
        let is_single = candidates.iter().all(|candidate| Some(candidate.channel) == first);
        let mut used = Vec::new();
        for Candidate { fit, channel, motor } in candidates {
            let is_common = is_single && fit.is_shared && !fit.fits_another_motor;
            if fit.fits_another_motor && !has_one_each || used.contains(&channel) && !is_common {
                continue;
            }
            if let Some(motor) = self.motors.get_mut(motor).filter(|motor| motor.lacks_dir()) {
                motor.dir = Some(channel);
                used.push(channel);
            }
        }
    }

    fn motors_without_dir(&self) -> Vec<MotorEdges> {
        let edges = |(motor, channel)| MotorEdges { motor, channel, edges: self.edges(channel) };
        let motors = self.motors.iter().enumerate().filter(|(_, motor)| motor.lacks_dir());
        let motors = motors.filter_map(|(at, motor)| Some((at, motor.step()?))).map(edges);
        motors.filter(|motor| motor.edges.len() as u64 >= MIN_STEPS).collect()
    }

    /// The motors of which a channel may be the DIR.
    fn candidates(&self, channel: usize, motors: &[MotorEdges]) -> Vec<Candidate> {
        let name = |channel: usize| self.capture.channels.get(channel).map_or("", |channel| &channel.name);
        let changes = self.edges(channel);
        let distances: Vec<u64> = motors.iter().map(|motor| total_distance(&changes, &motor.edges)).collect();
        let words: Vec<usize> =
            motors.iter().map(|motor| shared_words(name(motor.channel), name(channel))).collect();
        let mut candidates = Vec::new();
        for (at, motor) in motors.iter().enumerate() {
            if changes.len() * 2 > motor.edges.len() {
                continue;
            }
            let own = distances.get(at).copied().unwrap_or(u64::MAX);
            let others = || {
                distances
                    .iter()
                    .zip(motors)
                    .enumerate()
                    .filter(|(other, _)| *other != at)
                    .map(|(_, pair)| pair)
            };
            let is_nearer = |distance: u64, other: &MotorEdges| {
                distance.saturating_mul(2) < own && are_close_to_pulses(distance, changes.len(), &other.edges)
            };
            // Names count before levels: X-Foo and X-Bar belong to one motor.
            let fits_another_motor = if words.iter().max() > words.iter().min() {
                words.get(at) < words.iter().max()
            } else {
                others().any(|(distance, other)| is_nearer(*distance, other))
            };
            let nearest = others().map(|(distance, _)| *distance).min().unwrap_or(u64::MAX);
            let fit = Fit {
                fits_another_motor,
                has_one_level: !self.steps_at_both_levels(channel, motor.channel),
                changes_during_pulses: !self.changes_between_pulses(channel, motor.channel),
                is_out_of_order: false,
                distance: motor.channel.abs_diff(channel),
                is_shared: motors.len() > 1 && own.saturating_mul(2) >= nearest,
            };
            if !fit.changes_during_pulses
                || has_pulses_between(&changes, &motor.edges, PULSES_BETWEEN_PERCENT)
            {
                candidates.push(Candidate { fit, channel, motor: motor.motor });
            }
        }
        candidates
    }

    fn steps_at_both_levels(&self, channel: usize, step: usize) -> bool {
        let mut levels = [false; 2];
        for (before, now) in self.changes.iter().zip(self.changes.iter().skip(1)) {
            if (before.levels ^ now.levels) >> step & 1 == 1
                && let Some(level) = levels.get_mut((now.levels >> channel & 1) as usize)
            {
                *level = true;
            }
        }
        levels == [true; 2]
    }

    fn changes_between_pulses(&self, channel: usize, step: usize) -> bool {
        let idle = u64::from(self.behavior(step).idles_high());
        let mut pairs = self.changes.iter().zip(self.changes.iter().skip(1));
        pairs.all(|(before, now)| {
            (before.levels ^ now.levels) >> channel & 1 == 0 || before.levels >> step & 1 == idle
        })
    }
}

/// With one candidate per motor, marks those that are not in the order of the motors, and returns true.
fn mark_out_of_order(candidates: &mut [Candidate], motors: &[MotorEdges]) -> bool {
    let fitting = candidates.iter().filter(|candidate| !candidate.fit.has_one_level);
    let fitting: BTreeSet<usize> = fitting.map(|candidate| candidate.channel).collect();
    if fitting.len() != motors.len() {
        return false;
    }
    let mut steps: Vec<usize> = motors.iter().map(|motor| motor.channel).collect();
    steps.sort_short_by_key(|channel| *channel);
    for Candidate { fit, channel, motor } in candidates {
        let step = motors.iter().find(|other| other.motor == *motor).map(|motor| motor.channel);
        let own = steps.iter().position(|other| Some(*other) == step);
        fit.is_out_of_order = fitting.iter().position(|other| other == channel) != own;
    }
    true
}
