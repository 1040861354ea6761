//! Collects the problems of a motion or scenario, each with the path of its value (DESIGN B1).

use crate::problem::{Cause, Problem, ValueError};
use crate::problems::{MAX_PROBLEMS, Problems};
use alloc::{string::String, vec::Vec};
use core::{fmt::Write as _, ops::RangeInclusive};

type Range<T> = RangeInclusive<T>;

/// Collects problems with the path of the current value. It lists at most [`MAX_PROBLEMS`], and counts all. A `field` is the
/// name of a field, or several with dots between them; empty for the current value itself.
#[derive(Clone, Debug)]
pub struct Validator<C = Cause> {
    path: String,
    problems: Vec<Problem<C>>,
    count: usize,
}

impl<C> Default for Validator<C> {
    fn default() -> Self {
        Self::within(String::new())
    }
}

impl<C> Validator<C> {
    /// A validator of the value at `path`.
    pub fn within(path: impl Into<String>) -> Self {
        Self { path: path.into(), problems: Vec::new(), count: 0 }
    }

    /// Appends a field to the path; returns the argument of [`Self::leave`].
    #[must_use = "pass it to leave"]
    pub fn enter(&mut self, field: &str) -> usize {
        let outer_len = self.path.len();
        if outer_len > 0 && !field.is_empty() {
            self.path.push('.');
        }
        self.path.push_str(field);
        outer_len
    }

    /// Appends the index of a list's entry to the path; returns the argument of [`Self::leave`].
    #[must_use = "pass it to leave"]
    pub fn enter_entry(&mut self, index: usize) -> usize {
        let outer_len = self.path.len();
        // Writing to a string cannot fail.
        let _ = write!(self.path, "[{index}]");
        outer_len
    }

    /// Shortens the path to `outer_len` bytes.
    pub fn leave(&mut self, outer_len: usize) {
        self.path.truncate(outer_len);
    }

    /// Calls `check` with the path of a field.
    pub fn at<T>(&mut self, field: &str, check: impl FnOnce(&mut Self) -> T) -> T {
        let outer_len = self.enter(field);
        let result = check(self);
        self.leave(outer_len);
        result
    }

    /// Calls `check` with the path of a list's entry.
    pub fn at_entry<T>(&mut self, index: usize, check: impl FnOnce(&mut Self) -> T) -> T {
        let outer_len = self.enter_entry(index);
        let result = check(self);
        self.leave(outer_len);
        result
    }

    pub fn path(&self) -> &str {
        &self.path
    }

    /// Whether `field` has a listed problem.
    pub fn has_problem(&mut self, field: &str) -> bool {
        self.at(field, |here| here.problems.iter().any(|problem| problem.path == here.path))
    }
}

impl<C: From<ValueError>> Validator<C> {
    pub fn add(&mut self, field: &str, cause: impl Into<C>) {
        self.count += 1;
        if self.problems.len() < MAX_PROBLEMS {
            let outer_len = self.enter(field);
            self.problems.push(Problem::new(self.path.as_str(), cause));
            self.leave(outer_len);
        }
    }

    /// Adds problems with complete paths, such as those of a plan.
    pub fn extend<D: Into<C>>(&mut self, problems: impl IntoIterator<Item = Problem<D>>) {
        for Problem { path, cause } in problems {
            self.count += 1;
            if self.problems.len() < MAX_PROBLEMS {
                self.problems.push(Problem { path, cause: cause.into() });
            }
        }
    }

    /// Returns the value of a result, or adds its problems.
    pub fn take<T, D: Into<C>>(&mut self, result: Result<T, Problems<D>>) -> Option<T> {
        result.map_err(|problems| self.extend(problems)).ok()
    }

    /// Returns a number that is in its range, or adds a problem. NaN is in no range.
    pub fn range(&mut self, field: &str, given: f64, range: Range<f64>, unit: &'static str) -> Option<f64> {
        if range.contains(&given) {
            return Some(given);
        }
        let (min, max) = range.into_inner();
        self.add(field, ValueError::Range { given, min, max, unit });
        None
    }

    /// Checks an integer. A problem has it as f64, which is exact for all allowed values.
    pub fn whole(&mut self, field: &str, given: impl Into<u64>, range: Range<u64>, unit: &'static str) {
        let given = given.into();
        if !range.contains(&given) {
            let (given, min, max) = (given as f64, *range.start() as f64, *range.end() as f64);
            self.add(field, ValueError::Range { given, min, max, unit });
        }
    }

    /// Checks the length of a text or list; `of` is what it counts, such as `moves`.
    pub fn length(&mut self, field: &str, given: usize, range: Range<usize>, of: &'static str) {
        if !range.contains(&given) {
            let (min, max) = range.into_inner();
            self.add(field, ValueError::Length { given, min, max, of });
        }
    }

    /// Number of problems so far, including those not listed.
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Whether there are no problems so far.
    pub const fn is_ok(&self) -> bool {
        self.count == 0
    }

    /// The listed problems; `None` if there are none.
    pub fn problems(self) -> Option<Problems<C>> {
        Problems::new(self.problems)
    }

    /// Returns `value`, or the problems if there are any.
    /// Errors: the listed problems.
    pub fn end<T>(self, value: T) -> Result<T, Problems<C>> {
        self.problems().map_or(Ok(value), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_problems_in_the_order_they_are_added() {
        let mut validator = Validator::<Cause>::default();
        validator.add("a", Cause::EmptySegment);
        validator.extend([Problem::<Cause>::new("b.c", Cause::EmptySegment)]);
        assert_eq!(validator.count(), 2);
        let paths: Vec<_> = validator.problems().into_iter().flatten().map(|problem| problem.path).collect();
        assert_eq!(paths, ["a", "b.c"]);
    }

    #[test]
    fn counts_problems_beyond_the_maximum_of_listed_ones() {
        let mut validator = Validator::<Cause>::default();
        for _ in 0..MAX_PROBLEMS {
            validator.add("a", Cause::EmptySegment);
        }
        let before = validator.count();
        validator.add("b", Cause::EmptySegment);
        assert_eq!(validator.count(), before + 1);
        validator.extend([Problem::<Cause>::new("c", Cause::EmptySegment)]);
        assert_eq!((validator.count(), validator.is_ok()), (before + 2, false));
        let problems = validator.problems().expect("there are some");
        assert_eq!(problems.len(), MAX_PROBLEMS);
        assert!(problems.iter().all(|problem| problem.path == "a"));
    }
}
