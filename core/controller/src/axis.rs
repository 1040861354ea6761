//! A virtual axis (CONTROLLER G6): its position, and the switches that it drives.

use crate::{input::Signal, parameters::Axis};

#[derive(Clone, Debug)]
pub(crate) struct VirtualAxis {
    axis: Axis,
    position: i64,
    /// Difference to the controller's position when zero was last set, or before that when memory was first read.
    zero: i64,
    has_zero: bool,
}

impl VirtualAxis {
    pub(crate) fn new(axis: Option<&Axis>) -> Self {
        let axis = axis.cloned().unwrap_or_default();
        Self { position: axis.start_steps, axis, zero: 0, has_zero: false }
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

    /// Zero is set: the present difference is no error.
    pub(crate) fn zero_is_set(&mut self, position: i32) {
        self.zero = self.position.saturating_sub(position.into());
        self.has_zero = true;
    }

    /// Memory is read: until zero is set, the first position read is no error.
    pub(crate) fn memory_is_read(&mut self, position: i32) {
        if !self.has_zero {
            self.zero_is_set(position);
        }
    }

    pub(crate) fn error(&self, position: i32) -> i64 {
        self.position.saturating_sub(position.into()).saturating_sub(self.zero)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_into_an_end_are_lost() {
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
    fn the_error_counts_from_the_zero_that_was_set_or_the_first_position_that_was_read() {
        let mut axis = VirtualAxis::new(Some(&Axis { start_steps: 50, ..Axis::default() }));
        assert_eq!(axis.error(0), 50, "before memory is read");
        axis.memory_is_read(20);
        assert_eq!(axis.error(20), 0);
        axis.shift(3);
        assert_eq!((axis.error(23), axis.error(20)), (0, 3));
        axis.memory_is_read(20);
        assert_eq!(axis.error(20), 3, "read again");
        axis.zero_is_set(0);
        axis.memory_is_read(7);
        assert_eq!((axis.error(0), axis.error(7)), (0, -7), "a zero that was set stays");
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
