//! The first difference of two lists of steps, edges or times.
//!
//! ```
//! use stepscope_core::{first_difference, peripheral::units::Cycles};
//!
//! let expected = [1000, 2000, 3000_u64];
//! assert_eq!(first_difference(&expected, &[1016, 2000, 3000], Cycles(16)), None);
//! assert_eq!(first_difference(&expected, &[1017, 2000, 3000], Cycles(16)), Some(0));
//! assert_eq!(first_difference(&expected, &[1000, 2000], Cycles(16)), Some(2));
//! ```

#[cfg(feature = "motion")]
use stepscope_motion::ScheduledStep;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::{signal::Record, trace::Step};

/// The first index at which two lists differ: cycles more than `within` apart, another direction (of records: other levels), or
/// the end of one list. `None` if they agree. A difference of exactly `within` is none.
pub fn first_difference<T: Timed>(expected: &[T], found: &[T], within: Cycles) -> Option<usize> {
    let is_different = |(index, (expected_one, found_one)): (usize, (&T, &T))| {
        let apart = expected_one.cycle().abs_diff(found_one.cycle());
        let differs = apart > within.0 || T::state(expected, index) != T::state(found, index);
        differs.then_some(index)
    };
    let different = expected.iter().zip(found).enumerate().find_map(is_different);
    different.or_else(|| (expected.len() != found.len()).then(|| expected.len().min(found.len())))
}

/// An entry of a list for [`first_difference`]: `u64`, [`Instant`], [`Step`], `ScheduledStep` or [`Record`].
pub trait Timed: sealed::Sealed {}

mod sealed {
    pub trait Sealed: Sized {
        fn cycle(&self) -> u64;

        /// What must be equal besides the cycle: a direction, or levels.
        fn state(_list: &[Self], _index: usize) -> u64 {
            0
        }
    }
}

impl Timed for u64 {}

impl sealed::Sealed for u64 {
    fn cycle(&self) -> u64 {
        *self
    }
}

impl Timed for Instant {}

impl sealed::Sealed for Instant {
    fn cycle(&self) -> u64 {
        self.0
    }
}

impl Timed for Record {}

impl sealed::Sealed for Record {
    fn cycle(&self) -> u64 {
        self.cycle.0
    }

    fn state(list: &[Self], index: usize) -> u64 {
        list.get(index).map_or(0, |record| record.levels.0)
    }
}

impl Timed for Step {}

impl sealed::Sealed for Step {
    fn cycle(&self) -> u64 {
        self.cycle
    }

    fn state(list: &[Self], index: usize) -> u64 {
        u64::from(Self::direction(list, index) > 0)
    }
}

#[cfg(feature = "motion")]
impl Timed for ScheduledStep {}

#[cfg(feature = "motion")]
impl sealed::Sealed for ScheduledStep {
    fn cycle(&self) -> u64 {
        self.cycle
    }

    fn state(list: &[Self], index: usize) -> u64 {
        u64::from(list.get(index).is_some_and(|step| step.right))
    }
}
