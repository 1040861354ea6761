//! Matches recorded with planned steps, where steps may be missing or extra.
//!
//! ```text
//! plan       |   |   |   |   |   |        runs: planned 0.. with recorded 0.., then planned 3.. with recorded 2..
//! recorded   |   |       |   | : |              (one missing), then planned 5.. with recorded 5.. (one extra)
//! ```
//!
//! A beam search: each hypothesis follows the recording's clock by a filter of offset and rate. A step that is not on
//! time makes additional hypotheses: missing, extra, late, or a shift. The cheapest wins. It starts from each of the
//! first pairs of steps. Hypotheses and tried gaps are bounded, so time and memory are linear.

mod clock;
mod costs;
mod search;

use self::search::Search;
use super::side::Side;
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

    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    pub fn len(&self) -> usize {
        self.runs.last().map_or(0, |last| last.before + last.count)
    }

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
