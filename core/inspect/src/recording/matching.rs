//! Matches recorded with planned steps, where steps may be missing or extra.
//!
//! ```text
//! plan       |   |   |   |   |   |        runs: planned 0.. with recorded 0.., then planned 3.. with recorded 2..
//! recorded   |   |       |   | : |              (one missing), then planned 5.. with recorded 5.. (one extra)
//! ```
//!
//! A beam search. Each hypothesis tracks offset and rate of the recording's clock with a filter. A step that is not on
//! time creates additional hypotheses: missing, extra, late or shifted steps. The one with the lowest cost is the result.
//! The search starts from each of the first pairs of steps. Hypotheses and tried gaps are limited, so time and memory are
//! linear in the number of steps.

mod clock;
mod costs;
mod search;

use self::search::Search;
use super::compared_data::Side;
use alloc::vec::Vec;

/// Planned and recorded steps matched one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    pub model: usize,
    pub recorded: usize,
    pub count: usize,
    before: usize,
}

/// All matched steps, as runs without a missing or extra step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Matching {
    runs: Vec<Run>,
}

impl Matching {
    /// Matches the steps of a recording with those of a plan.
    pub fn of(recorded: Side<'_>, model: Side<'_>) -> Self {
        let Some((end, starts)) = Search::new(recorded, model).run() else { return Self::default() };
        let mut found = Self::default();
        let ends = starts.iter().skip(1).copied().chain([end]);
        for ((model, recorded), (next_model, next_recorded)) in starts.iter().copied().zip(ends) {
            let count = (next_model - model).min(next_recorded - recorded);
            if count > 0 {
                found.runs.push(Run { model, recorded, count, before: found.len() });
            }
        }
        found
    }

    /// In ascending order.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Number of matched steps.
    pub fn len(&self) -> usize {
        self.runs.last().map_or(0, |last| last.before + last.count)
    }

    /// Whether no step is matched.
    pub const fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// The planned and the recorded step of match `index`.
    pub fn pair(&self, index: usize) -> Option<(usize, usize)> {
        let after = self.runs.partition_point(|run| run.before <= index);
        let run = self.runs.get(after.checked_sub(1)?)?;
        let within = index - run.before;
        (within < run.count).then_some((run.model + within, run.recorded + within))
    }

    /// The recorded step of a planned one; `None` where it is missing.
    pub fn recorded(&self, model: usize) -> Option<usize> {
        let after = self.runs.partition_point(|run| run.model <= model);
        let run = self.runs.get(after.checked_sub(1)?)?;
        (model - run.model < run.count).then(|| run.recorded + model - run.model)
    }
}

#[cfg(test)]
mod tests;
