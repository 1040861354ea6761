//! Collects the problems of a motion or scenario, each with the path of its value (DESIGN B1).

use crate::problem::{Cause, Problem, ValueError};
use alloc::{string::String, vec::Vec};
use core::{fmt::Write as _, ops::RangeInclusive};

/// Maximum number of listed problems per scenario.
pub const MAX_PROBLEMS: usize = 100;

/// Collects problems with the path of the current value. It lists at most [`MAX_PROBLEMS`], and counts all.
///
/// A `step` of a path is the name of a field, or several with dots between them; empty for the value itself.
#[derive(Clone, Debug)]
pub struct Validator<C = Cause> {
    path: String,
    problems: Vec<Problem<C>>,
    /// Number of problems, including those not listed.
    found: usize,
}

impl<C> Default for Validator<C> {
    fn default() -> Self {
        Self::within(String::new())
    }
}

impl<C> Validator<C> {
    /// For the part at `path`.
    #[must_use]
    pub fn within(path: impl Into<String>) -> Self {
        Self { path: path.into(), problems: Vec::new(), found: 0 }
    }

    /// Enters a step; returns the argument of [`Self::leave`].
    #[must_use = "leave takes it"]
    pub fn enter(&mut self, step: &str) -> usize {
        let outside = self.path.len();
        if outside > 0 && !step.is_empty() {
            self.path.push('.');
        }
        self.path.push_str(step);
        outside
    }

    /// Enters an entry of a list.
    #[must_use = "leave takes it"]
    pub fn enter_entry(&mut self, index: usize) -> usize {
        let outside = self.path.len();
        // Writing to a string cannot fail.
        let _ = write!(self.path, "[{index}]");
        outside
    }

    /// Leaves a step or entry.
    pub fn leave(&mut self, outside: usize) {
        self.path.truncate(outside);
    }

    /// Calls `what` within a step.
    pub fn at<T>(&mut self, step: &str, what: impl FnOnce(&mut Self) -> T) -> T {
        let outside = self.enter(step);
        let result = what(self);
        self.leave(outside);
        result
    }

    /// Calls `what` within an entry of a list.
    pub fn at_entry<T>(&mut self, index: usize, what: impl FnOnce(&mut Self) -> T) -> T {
        let outside = self.enter_entry(index);
        let result = what(self);
        self.leave(outside);
        result
    }

    /// Path of the current value.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Whether the value at `step` has a listed problem.
    #[must_use]
    pub fn has_problem(&mut self, step: &str) -> bool {
        self.at(step, |here| here.problems.iter().any(|problem| problem.path == here.path))
    }
}

impl<C: From<ValueError>> Validator<C> {
    /// Adds a problem of the value at `step`.
    pub fn add(&mut self, step: &str, cause: impl Into<C>) {
        self.found += 1;
        if self.problems.len() < MAX_PROBLEMS {
            let outside = self.enter(step);
            self.problems.push(Problem::new(self.path.as_str(), cause));
            self.leave(outside);
        }
    }

    /// Adds problems with complete paths, such as those of a plan.
    pub fn extend<D: Into<C>>(&mut self, problems: impl IntoIterator<Item = Problem<D>>) {
        for Problem { path, cause } in problems {
            self.found += 1;
            if self.problems.len() < MAX_PROBLEMS {
                self.problems.push(Problem { path, cause: cause.into() });
            }
        }
    }

    /// The value of a result, or adds its problems.
    pub fn take<T, D: Into<C>>(&mut self, result: Result<T, Vec<Problem<D>>>) -> Option<T> {
        result.map_err(|problems| self.extend(problems)).ok()
    }

    /// A number, if it is in its range.
    pub fn range(
        &mut self,
        step: &str,
        given: f64,
        range: RangeInclusive<f64>,
        unit: &'static str,
    ) -> Option<f64> {
        if range.contains(&given) {
            return Some(given);
        }
        let (least, most) = range.into_inner();
        self.add(step, ValueError::Range { given, min: least, max: most, unit });
        None
    }

    /// Checks an integer; problems report it as f64, which is exact for all allowed values.
    pub fn whole(
        &mut self,
        step: &str,
        given: impl Into<u64>,
        range: RangeInclusive<u64>,
        unit: &'static str,
    ) {
        let given = given.into();
        if !range.contains(&given) {
            let (given, least, most) = (given as f64, *range.start() as f64, *range.end() as f64);
            self.add(step, ValueError::Range { given, min: least, max: most, unit });
        }
    }

    /// Checks the number `of` something.
    pub fn length(&mut self, step: &str, given: usize, range: RangeInclusive<usize>, of: &'static str) {
        if !range.contains(&given) {
            let (least, most) = range.into_inner();
            self.add(step, ValueError::Length { given, min: least, max: most, of });
        }
    }

    /// Number of problems so far, including those not listed.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.found
    }

    #[must_use]
    pub const fn is_ok(&self) -> bool {
        self.found == 0
    }

    /// The listed problems.
    #[must_use]
    pub fn problems(self) -> Vec<Problem<C>> {
        self.problems
    }

    /// Returns the value.
    ///
    /// # Errors
    /// The listed problems.
    pub fn end<T>(self, value: T) -> Result<T, Vec<Problem<C>>> {
        if self.is_ok() { Ok(value) } else { Err(self.problems) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_whose_paths_are_whole_are_listed_after_those_before_them() {
        let mut validator = Validator::<Cause>::default();
        validator.add("a", Cause::NoSegmentSteps);
        validator.extend([Problem::<Cause>::new("b.c", Cause::NoSegmentSteps)]);
        assert_eq!(validator.count(), 2);
        let paths: Vec<_> = validator.problems().into_iter().map(|problem| problem.path).collect();
        assert_eq!(paths, ["a", "b.c"]);
    }

    #[test]
    fn what_is_not_listed_any_more_is_wrong_all_the_same() {
        let mut validator = Validator::<Cause>::default();
        for _ in 0..MAX_PROBLEMS {
            validator.add("a", Cause::NoSegmentSteps);
        }
        let before = validator.count();
        validator.add("b", Cause::NoSegmentSteps);
        assert_eq!(validator.count(), before + 1);
        validator.extend([Problem::<Cause>::new("c", Cause::NoSegmentSteps)]);
        assert_eq!((validator.count(), validator.is_ok()), (before + 2, false));
        let problems = validator.problems();
        assert_eq!(problems.len(), MAX_PROBLEMS);
        assert!(problems.iter().all(|problem| problem.path == "a"));
    }
}
