//! The error of a run without end (CONTROLLER.md, "Refused": WORK).

use crate::limits;
use core::fmt;

/// A run ended because more than [`limits::MAX_GROUPS_BEGUN`] groups began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyGroups {
    /// The controller that began most of them.
    pub controller: usize,
    /// Minimum number of the most recent groups, from 1.
    pub first_group: u32,
    /// Maximum number of the most recent groups.
    pub last_group: u32,
    /// Whether they repeated without a step, a wait or a delay.
    pub is_endless: bool,
}

impl fmt::Display for TooManyGroups {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first_group, last_group, is_endless, .. } = self;
        write!(f, "groups {first_group} to {last_group} repeat without end; ")?;
        if *is_endless {
            return f.write_str("add a move, a wait or a jump out of them");
        }
        write!(f, "use fewer loops or a shorter run: at most {} groups may begin", limits::MAX_GROUPS_BEGUN)
    }
}
