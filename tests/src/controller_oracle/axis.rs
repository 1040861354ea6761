//! G6's axis: the position m, and its switches.

use super::parameters::{Axis, Input};
use super::room::Room;

impl Room {
    /// Without `axis`: one without switches.
    fn axis(&self) -> Axis {
        self.plan.controller.axis.clone().unwrap_or_default()
    }

    /// m follows a rise of STEP.
    pub(super) fn axis_follows(&mut self) {
        let axis = self.axis();
        if !self.s.en {
            return;
        }
        // Reading: a step beyond `hard_min_steps` or `hard_max_steps` is not made; m stays.
        if self.s.dir {
            if axis.hard_max_steps.is_none_or(|most| self.s.place < most) {
                self.s.place += 1;
            }
        } else if axis.hard_min_steps.is_none_or(|least| self.s.place > least) {
            self.s.place -= 1;
        }
    }

    /// A push by hand, possible while EN = 0 in this cycle.
    pub(super) fn push(&mut self, steps: i64) {
        let axis = self.axis();
        if self.s.en {
            return;
        }
        // Reading: a push also ends at `hard_min_steps` and `hard_max_steps`.
        let mut place = self.s.place + steps;
        if let Some(most) = axis.hard_max_steps
            && steps > 0
        {
            place = place.min(most.max(self.s.place));
        }
        if let Some(least) = axis.hard_min_steps
            && steps < 0
        {
            place = place.max(least.min(self.s.place));
        }
        self.s.place = place;
    }

    /// Raw levels of the axis' switches.
    pub(super) fn axis_drives_switches(&mut self) {
        let axis = self.axis();
        let m = self.s.place;
        let home = match (axis.home_from_steps, axis.home_to_steps) {
            (Some(from), Some(to)) => Some(from <= m && m <= to),
            // Reading: with only one of the two there is no switch.
            _ => None,
        };
        let driven = [
            (Input::LimitMin, axis.min_switch_at_steps.map(|at| m <= at)),
            (Input::LimitMax, axis.max_switch_at_steps.map(|at| m >= at)),
            (Input::HomeSwitch, home),
        ];
        for (input, level) in driven {
            if let Some(level) = level {
                self.s.inputs.set(input, level, self.now);
            }
        }
    }

    /// "Reported": m - position minus its value when zero was set, or before that when memory was first read.
    pub(super) fn axis_error(&self) -> i64 {
        // Reading: before both nothing is subtracted.
        self.s.place - i64::from(self.s.position) - self.s.place_of_zero.unwrap_or(0)
    }

    /// Zero is set: by hand, or by homing.
    pub(super) fn zero_is_set(&mut self, position: i32) {
        self.s.position = position;
        self.s.trust = 2;
        self.s.place_of_zero = Some(self.s.place - i64::from(position));
    }
}
