//! A virtual axis (CONTROLLER G6): its position, and the switches that it drives.

use crate::{input::Signal, parameters::Axis};

#[derive(Clone, Debug)]
pub(crate) struct VirtualAxis {
    axis: Axis,
    position: i64,
    /// Axis position minus controller position when zero was last set; before that, when memory was first read.
    zero_offset: i64,
    is_zero_set: bool,
}

impl VirtualAxis {
    pub(crate) fn new(axis: Option<&Axis>) -> Self {
        let axis = axis.cloned().unwrap_or_default();
        Self { position: axis.start_steps, axis, zero_offset: 0, is_zero_set: false }
    }

    pub(crate) const fn position(&self) -> i64 {
        self.position
    }

    /// Moves by `steps` up to the hard ends. Beyond an end only moves back toward it are possible.
    pub(crate) fn shift(&mut self, steps: i64) {
        let target = self.position.saturating_add(steps);
        self.position = if steps > 0 {
            let end = self.axis.hard_max_steps.unwrap_or(i64::MAX);
            target.min(end).max(self.position)
        } else {
            let end = self.axis.hard_min_steps.unwrap_or(i64::MIN);
            target.max(end).min(self.position)
        };
    }

    /// The level of each switch; `None` where the script drives it.
    pub(crate) fn switches(&self) -> [(Signal, Option<bool>); 3] {
        let position = self.position;
        let home = self.axis.home_from_steps.zip(self.axis.home_to_steps);
        [
            (Signal::LimitMin, self.axis.min_switch_at_steps.map(|at| position <= at)),
            (Signal::LimitMax, self.axis.max_switch_at_steps.map(|at| position >= at)),
            (Signal::HomeSwitch, home.map(|(from, to)| (from..=to).contains(&position))),
        ]
    }

    /// Whether a move in this direction reaches a limit switch.
    pub(crate) fn has_switch_ahead(&self, right: bool) -> bool {
        let Axis { min_switch_at_steps, max_switch_at_steps, hard_min_steps, hard_max_steps, .. } = self.axis;
        if right {
            max_switch_at_steps.is_some_and(|at| hard_max_steps.is_none_or(|end| at <= end))
        } else {
            min_switch_at_steps.is_some_and(|at| hard_min_steps.is_none_or(|end| at >= end))
        }
    }

    /// Declares the current offset correct, because the controller's zero was set.
    pub(crate) fn set_zero(&mut self, position: i32) {
        self.zero_offset = self.position.saturating_sub(position.into());
        self.is_zero_set = true;
    }

    /// Declares the first position read from memory correct, unless zero was set before.
    pub(crate) fn set_initial_zero(&mut self, position: i32) {
        if !self.is_zero_set {
            self.set_zero(position);
        }
    }

    pub(crate) fn position_error(&self, position: i32) -> i64 {
        self.position.saturating_sub(position.into()).saturating_sub(self.zero_offset)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_beyond_a_hard_end_are_lost() {
        // Position, hard_min_steps, hard_max_steps, steps, position after.
        let rows = [
            (0, None, None, 5, 5),
            (0, Some(-3), Some(4), 5, 4),
            (0, Some(-3), Some(4), -5, -3),
            (4, Some(-3), Some(4), 1, 4),
            (9, Some(-3), Some(4), 1, 9),
            (9, Some(-3), Some(4), -1, 8),
            (0, Some(5), Some(-5), 1, 0),
            (0, Some(5), Some(-5), -1, 0),
        ];
        for (start_steps, hard_min_steps, hard_max_steps, steps, expected) in rows {
            let axis = Axis { start_steps, hard_min_steps, hard_max_steps, ..Axis::default() };
            let mut virtual_axis = VirtualAxis::new(Some(&axis));
            virtual_axis.shift(steps);
            assert_eq!(virtual_axis.position(), expected, "{axis:?} {steps}");
        }
    }

    #[test]
    fn error_is_relative_to_the_last_zero_or_the_first_position_read() {
        let mut axis = VirtualAxis::new(Some(&Axis { start_steps: 50, ..Axis::default() }));
        assert_eq!(axis.position_error(0), 50, "before memory is read");
        axis.set_initial_zero(20);
        assert_eq!(axis.position_error(20), 0);
        axis.shift(3);
        assert_eq!((axis.position_error(23), axis.position_error(20)), (0, 3));
        axis.set_initial_zero(20);
        assert_eq!(axis.position_error(20), 3, "read again");
        axis.set_zero(0);
        axis.set_initial_zero(7);
        assert_eq!((axis.position_error(0), axis.position_error(7)), (0, -7), "a later read keeps the zero");
    }

    #[test]
    fn switches_close_at_their_positions() {
        let axis = Axis {
            min_switch_at_steps: Some(-2),
            max_switch_at_steps: Some(2),
            home_from_steps: Some(0),
            home_to_steps: Some(1),
            ..Axis::default()
        };
        for position in -3..=3 {
            let switches = VirtualAxis::new(Some(&Axis { start_steps: position, ..axis.clone() })).switches();
            let expected = [Some(position <= -2), Some(position >= 2), Some(position == 0 || position == 1)];
            assert_eq!(switches.map(|(_, level)| level), expected, "{position}");
        }
        assert!(VirtualAxis::new(None).switches().iter().all(|(_, level)| level.is_none()));
    }
}
