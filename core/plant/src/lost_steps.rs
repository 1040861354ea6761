//! Lost steps, four full steps at a time: the distance to the next position that the same currents hold (PLANT F8).

use crate::sincos::nearest;

/// A slip of four full steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slip {
    pub cycle: u64,
    /// The rotor is to the left of its command: it lost steps to the right.
    pub is_behind: bool,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LostSteps {
    pub(crate) lost: i64,
    lost_steps: f64,
}

impl LostSteps {
    /// Called at each grid point with EN = 1; `error` is command minus position in full steps.
    pub(crate) fn update(&mut self, error: f64, cycle: u64) -> Option<Slip> {
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
