//! The problems of a refused motion or scenario, as one error.
//!
//! ```
//! use stepscope_motion::{Problem, Problems, ValueError};
//!
//! let cause = ValueError::Conflict { detail: "two sources; use one" };
//! let problems = Problems::from(Problem::<ValueError>::new("source", cause));
//! assert_eq!((problems.len(), problems.to_string()), (1, "source: two sources; use one".into()));
//! ```

use crate::problem::{Cause, Problem};
use alloc::vec::{IntoIter, Vec};
use core::{fmt, ops::Deref, slice::Iter};

/// Maximum number of listed problems per scenario.
pub const MAX_PROBLEMS: usize = 100;

/// Why a motion or scenario is refused: 1 to [`MAX_PROBLEMS`] problems. Its text has a line for each.
#[derive(Clone, PartialEq)]
pub struct Problems<C = Cause>(Vec<Problem<C>>);

impl<C> Problems<C> {
    /// The first [`MAX_PROBLEMS`] of a list; `None` if it is empty.
    pub fn new(mut problems: Vec<Problem<C>>) -> Option<Self> {
        problems.truncate(MAX_PROBLEMS);
        (!problems.is_empty()).then_some(Self(problems))
    }

    /// Fails if there are problems.
    ///
    /// # Errors
    /// The first [`MAX_PROBLEMS`] of the list.
    pub fn check(problems: Vec<Problem<C>>) -> Result<(), Self> {
        Self::new(problems).map_or(Ok(()), Err)
    }

    /// These problems, and the problems of `other` at paths that have none yet.
    #[must_use]
    pub fn with(mut self, other: Option<Self>) -> Self {
        let known = self.0.len();
        for problem in other.into_iter().flatten() {
            let is_new = self.0.iter().take(known).all(|before| before.path != problem.path);
            if is_new && self.0.len() < MAX_PROBLEMS {
                self.0.push(problem);
            }
        }
        self
    }

    /// The same problems with the cause type of a crate that depends on this one, such as a scenario's.
    pub fn widen<D: From<C>>(self) -> Problems<D> {
        Problems(self.0.into_iter().map(Problem::widen).collect())
    }
}

/// A cause of another crate that contains the causes of a plan: `?` converts the plan's [`Problems`] to it.
pub trait WiderCause: From<Cause> {}

impl<C: WiderCause> From<Problems> for Problems<C> {
    fn from(problems: Problems) -> Self {
        problems.widen()
    }
}

impl<C> From<Problem<C>> for Problems<C> {
    fn from(problem: Problem<C>) -> Self {
        Self(alloc::vec![problem])
    }
}

impl<C> Deref for Problems<C> {
    type Target = [Problem<C>];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<C> IntoIterator for Problems<C> {
    type Item = Problem<C>;
    type IntoIter = IntoIter<Problem<C>>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a, C> IntoIterator for &'a Problems<C> {
    type Item = &'a Problem<C>;
    type IntoIter = Iter<'a, Problem<C>>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl<C: fmt::Display> fmt::Display for Problems<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str("\n")?;
            }
            problem.fmt(f)?;
        }
        Ok(())
    }
}

/// As its text, because a `main` that returns an error prints it so.
impl<C: fmt::Display> fmt::Debug for Problems<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl<C: fmt::Display> core::error::Error for Problems<C> {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ValueError;
    use alloc::{format, string::ToString, vec};

    fn problem(path: &str) -> Problem {
        Problem::new(path, ValueError::Conflict { detail: "wrong; use another" })
    }

    #[test]
    fn problems_are_at_least_one_and_at_most_a_hundred() {
        assert_eq!(Problems::<Cause>::new(Vec::new()), None);
        assert_eq!(Problems::<Cause>::check(Vec::new()), Ok(()));
        let many = Problems::new(vec![problem("a"); MAX_PROBLEMS + 1]).expect("there are some");
        assert_eq!(many.len(), MAX_PROBLEMS);
        assert_eq!(many.with(Some(problem("b").into())).len(), MAX_PROBLEMS);
    }

    #[test]
    fn other_problems_are_added_where_a_path_has_none() {
        let other = Problems::new(vec![problem("a"), problem("b"), problem("b")]);
        let all = Problems::from(problem("a")).with(other);
        assert_eq!(all.iter().map(|problem| problem.path.as_str()).collect::<Vec<_>>(), ["a", "b", "b"]);
    }

    #[test]
    fn text_and_debug_text_have_a_line_per_problem() {
        let problems = Problems::new(vec![problem("a"), problem("")]).expect("there are some");
        assert_eq!(problems.to_string(), "a: wrong; use another\nwrong; use another");
        assert_eq!(format!("{problems:?}"), problems.to_string());
    }
}
