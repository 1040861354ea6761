//! Steps that a rotor loses, four full steps at a time: the next place at which the same currents hold it (F8).

use crate::sincos::nearest;

/// A slip of four full steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Slip {
    pub cycle: u64,
    /// Whether the rotor fell behind to the left of its command (it lost steps to the right).
    pub is_behind: bool,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LostSteps {
    pub(crate) lost: i64,
    lost_steps: f64,
}

impl LostSteps {
    /// A point with EN = 1, `error` full steps behind the command.
    #[inline(always)]
    pub(crate) fn look(&mut self, error: f64, cycle: u64) -> Option<Slip> {
        let d = error - self.lost_steps;
        let is_behind = d > 2.5;
        let is_ahead = d < -2.5;
        if !is_behind && !is_ahead {
            return None;
        }
        self.lost += if is_behind { 1 } else { -1 };
        self.lost_steps = 4.0 * self.lost as f64;
        Some(Slip { cycle, is_behind })
    }

    pub(crate) fn power_up(&mut self, error: f64) {
        self.lost_steps = 4.0 * nearest(error / 4.0);
        self.lost = nearest(error / 4.0) as i64;
    }
}
