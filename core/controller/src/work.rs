//! A run without end (CONTROLLER.md, "Refused": WORK).

use crate::limits;
use core::fmt;

/// The run ended because too many groups began.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Work {
    pub controller: usize,
    /// Minimum and maximum number of the groups that began last.
    pub first_group: u32,
    pub last_group: u32,
    /// Whether they repeated without a step, a wait or a delay.
    pub is_endless: bool,
}

impl fmt::Display for Work {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first_group, last_group, is_endless, .. } = self;
        write!(f, "groups {first_group} to {last_group} repeat without end")?;
        if *is_endless {
            return f.write_str("; give one of them a move, a wait or a way out");
        }
        write!(f, "; at most {} groups may begin in a run: end it sooner", limits::MAX_GROUPS_BEGUN)
    }
}
