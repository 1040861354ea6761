//! Assigns DIR channels to motors by their levels.

use super::{
    behavior::MIN_STEPS,
    draft::Draft,
    timing::{has_steps_between, is_next_to, nearness},
};
use crate::names::shared_words;
use std::collections::BTreeSet;

/// How well a channel fits as a motor's DIR, best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Fit {
    is_others: bool,
    one_level: bool,
    while_high: bool,
    /// Its order among DIR candidates differs from the order of the motors' STEP.
    is_out_of_order: bool,
    distance: usize,
    is_shared: bool,
}

impl Draft<'_> {
    pub(super) fn dirs_by_behavior(&mut self) {
        let steps: Vec<(usize, usize, Vec<u64>)> = self
            .motors
            .iter()
            .enumerate()
            .filter(|(_, motor)| motor.lacks_dir())
            .filter_map(|(at, motor)| Some((at, motor.step()?, self.edges(motor.step()?))))
            .filter(|(.., edges)| edges.len() as u64 >= MIN_STEPS)
            .collect();
        if steps.is_empty() {
            return;
        }
        let free = self.free_of_lines();
        let name =
            |channel: usize| self.capture.channels.get(channel).map_or("", |channel| channel.name.as_str());
        let mut pairs: Vec<(Fit, usize, usize)> = Vec::new();
        for channel in &free {
            let changes = self.edges(*channel);
            let near: Vec<u64> = steps.iter().map(|(.., edges)| nearness(&changes, edges)).collect();
            for (place, (at, step, edges)) in steps.iter().enumerate() {
                if changes.len() * 2 > edges.len() {
                    continue;
                }
                let own = near.get(place).copied().unwrap_or(u64::MAX);
                let others = || near.iter().zip(&steps).enumerate().filter(|(other, _)| *other != place);
                // Names count before levels: X-Foo and X-Bar belong to one motor.
                let shared = |step: usize| shared_words(name(step), name(*channel));
                let by_name = steps.iter().map(|(_, step, _)| shared(*step));
                let (max, min) = (by_name.clone().max(), by_name.min());
                let is_others = if max > min {
                    Some(shared(*step)) < max
                } else {
                    others().any(|(_, (near, (.., edges)))| {
                        near.saturating_mul(2) < own && is_next_to(*near, changes.len(), edges)
                    })
                };
                let others = others().map(|(_, (near, _))| *near).min().unwrap_or(u64::MAX);
                let fit = Fit {
                    is_others,
                    is_shared: steps.len() > 1 && own.saturating_mul(2) >= others,
                    one_level: !self.steps_at_both_levels(*channel, *step),
                    while_high: !self.changes_between_pulses(*channel, *step),
                    is_out_of_order: false,
                    distance: step.abs_diff(*channel),
                };
                if !fit.while_high || has_steps_between(&changes, edges, 50) {
                    pairs.push((fit, *channel, *at));
                }
            }
        }
        // With one candidate per motor, both are paired in order.
        let fitting = pairs.iter().filter(|(fit, ..)| !fit.one_level).map(|(_, channel, _)| *channel);
        let fitting: BTreeSet<usize> = fitting.collect();
        let is_one_each = fitting.len() == steps.len();
        if is_one_each {
            let mut by_channel: Vec<usize> = steps.iter().map(|(_, step, _)| *step).collect();
            by_channel.sort_unstable();
            for (fit, channel, at) in &mut pairs {
                let step = steps.iter().find(|(motor, ..)| motor == at).map(|(_, step, _)| *step);
                let own = by_channel.iter().position(|other| Some(*other) == step);
                fit.is_out_of_order = fitting.iter().position(|other| other == channel) != own;
            }
        }
        pairs.sort_unstable();
        let dirs: Vec<usize> = pairs.iter().map(|(_, channel, _)| *channel).collect();
        let is_sole = dirs.iter().all(|channel| dirs.first() == Some(channel));
        let mut used = Vec::new();
        for (fit, channel, at) in pairs {
            let is_common = is_sole && fit.is_shared && !fit.is_others;
            if fit.is_others && !is_one_each || used.contains(&channel) && !is_common {
                continue;
            }
            if let Some(motor) = self.motors.get_mut(at).filter(|motor| motor.lacks_dir()) {
                motor.dir = Some(channel);
                used.push(channel);
            }
        }
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
