//! Gathers what is wrong with a scenario.

use super::{Cause, Problem};
use alloc::{string::String, vec::Vec};

/// Most problems of one scenario that are listed.
pub(super) const MOST_PROBLEMS: usize = 100;

/// Gathers problems.
#[derive(Default)]
pub(super) struct Judge {
    problems: Vec<Problem>,
}

impl Judge {
    pub(super) fn add(&mut self, path: impl Into<String>, cause: Cause) {
        if self.problems.len() < MOST_PROBLEMS {
            self.problems.push(Problem::new(path, cause));
        }
    }

    /// Judges a whole number; it is told as f64, which is exact for all that is allowed.
    pub(super) fn range(
        &mut self,
        path: &str,
        given: impl Into<u64>,
        least: u64,
        most: u64,
        unit: &'static str,
    ) {
        let given = given.into();
        if !(least..=most).contains(&given) {
            let (given, least, most) = (given as f64, least as f64, most as f64);
            self.add(path, Cause::Range { given, least, most, unit });
        }
    }

    pub(super) fn length(&mut self, path: &str, given: usize, least: usize, most: usize, of: &'static str) {
        if !(least..=most).contains(&given) {
            self.add(path, Cause::Length { given, least, most, of });
        }
    }

    /// Whether something is wrong at `path` already.
    pub(super) fn has(&self, path: &str) -> bool {
        self.problems.iter().any(|problem| problem.path == path)
    }

    pub(super) fn take<T>(&mut self, result: Result<T, Vec<Problem>>) -> Option<T> {
        result.map_err(|problems| self.problems.extend(problems)).ok()
    }

    pub(super) fn problems(self) -> Vec<Problem> {
        self.problems
    }

    pub(super) fn end<T>(self, value: T) -> Result<T, Vec<Problem>> {
        if self.problems.is_empty() { Ok(value) } else { Err(self.problems) }
    }
}
