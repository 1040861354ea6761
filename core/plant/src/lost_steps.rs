//! Counts lost steps in slips of four full steps: the distance to the next position that the same currents hold (PLANT F8).

use crate::sincos::nearest;

/// A slip of four full steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slip {
    /// Grid point at which it was detected.
    pub cycle: u64,
    /// The rotor is to the left of its command: it lost steps to the right.
    pub is_behind: bool,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LostSteps {
    /// Slips behind the command minus slips ahead of it.
    slips: i64,
}

impl LostSteps {
    pub(crate) const fn full_steps(&self) -> i64 {
        4 * self.slips
    }

    /// Called at each grid point with EN = 1; `error` is command minus position in full steps.
    pub(crate) fn update(&mut self, error: f64, cycle: u64) -> Option<Slip> {
        let distance = error - 4.0 * self.slips as f64;
        let (is_behind, is_ahead) = (distance > 2.5, distance < -2.5);
        if !is_behind && !is_ahead {
            return None;
        }
        self.slips += if is_behind { 1 } else { -1 };
        Some(Slip { cycle, is_behind })
    }

    /// The rotor is held at the nearest position of its currents when EN rises.
    pub(crate) fn power_up(&mut self, error: f64) {
        self.slips = nearest(error / 4.0) as i64;
    }
}
