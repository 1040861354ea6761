//! A virtual axis (G6): its place, and the switches that it drives.

use crate::{input::Signal, parameters::Axis};

#[derive(Clone, Debug)]
pub(crate) struct Place {
    axis: Axis,
    place: i64,
    /// m - position when zero was set last, before that when memory was first read; 0 before both.
    zero: i64,
    has_zero: bool,
}

impl Place {
    pub(crate) fn new(axis: Option<&Axis>) -> Self {
        let axis = axis.cloned().unwrap_or_default();
        Self { place: axis.start_steps, axis, zero: 0, has_zero: false }
    }

    pub(crate) const fn place(&self) -> i64 {
        self.place
    }

    /// Moves by `steps`, as far as the ends let it: who stands beyond one may come back, but goes no additional.
    pub(crate) fn shift(&mut self, steps: i64) {
        let target = self.place.saturating_add(steps);
        self.place = if steps > 0 {
            let end = self.axis.hard_max.unwrap_or(i64::MAX);
            target.min(end).max(self.place)
        } else {
            let end = self.axis.hard_min.unwrap_or(i64::MIN);
            target.max(end).min(self.place)
        };
    }

    /// Levels of the switches that the axis drives by its place.
    pub(crate) fn switches(&self) -> [(Signal, Option<bool>); 3] {
        let place = self.place;
        let home = self.axis.home_from.zip(self.axis.home_to);
        [
            (Signal::LimitMin, self.axis.min_switch_at.map(|at| place <= at)),
            (Signal::LimitMax, self.axis.max_switch_at.map(|at| place >= at)),
            (Signal::HomeSwitch, home.map(|(from, to)| (from..=to).contains(&place))),
        ]
    }

    /// Whether a move in this direction reaches a limit switch.
    pub(crate) fn has_switch_ahead(&self, right: bool) -> bool {
        let Axis { min_switch_at, max_switch_at, hard_min, hard_max, .. } = self.axis;
        if right {
            max_switch_at.is_some_and(|at| hard_max.is_none_or(|end| at <= end))
        } else {
            min_switch_at.is_some_and(|at| hard_min.is_none_or(|end| at >= end))
        }
    }

    /// Zero is set: what place and position differ by now is no error.
    pub(crate) fn zero_is_set(&mut self, position: i32) {
        self.zero = self.place.saturating_sub(position.into());
        self.has_zero = true;
    }

    /// Memory is read: until zero is set, the first position that it holds is no error.
    pub(crate) fn memory_is_read(&mut self, position: i32) {
        if !self.has_zero {
            self.zero_is_set(position);
        }
    }

    /// m - position, less what it was when zero was set, or memory was first read.
    pub(crate) fn error(&self, position: i32) -> i64 {
        self.place.saturating_sub(position.into()).saturating_sub(self.zero)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_into_an_end_are_lost() {
        // Place, hard_min, hard_max, steps, place after.
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
        for (start_steps, hard_min, hard_max, steps, expected) in rows {
            let axis = Axis { start_steps, hard_min, hard_max, ..Axis::default() };
            let mut place = Place::new(Some(&axis));
            place.shift(steps);
            assert_eq!(place.place(), expected, "{axis:?} {steps}");
        }
    }

    #[test]
    fn the_error_counts_from_the_zero_that_was_set_or_the_first_position_that_was_read() {
        let mut place = Place::new(Some(&Axis { start_steps: 50, ..Axis::default() }));
        assert_eq!(place.error(0), 50, "before memory is read");
        place.memory_is_read(20);
        assert_eq!(place.error(20), 0);
        place.shift(3);
        assert_eq!((place.error(23), place.error(20)), (0, 3));
        place.memory_is_read(20);
        assert_eq!(place.error(20), 3, "read again");
        place.zero_is_set(0);
        place.memory_is_read(7);
        assert_eq!((place.error(0), place.error(7)), (0, -7), "a zero that was set stays");
    }

    #[test]
    fn switches_close_at_their_places() {
        let axis = Axis {
            min_switch_at: Some(-2),
            max_switch_at: Some(2),
            home_from: Some(0),
            home_to: Some(1),
            ..Axis::default()
        };
        for place in -3..=3 {
            let switches = Place::new(Some(&Axis { start_steps: place, ..axis.clone() })).switches();
            let expected = [Some(place <= -2), Some(place >= 2), Some(place == 0 || place == 1)];
            assert_eq!(switches.map(|(_, level)| level), expected, "{place}");
        }
        assert!(Place::new(None).switches().iter().all(|(_, level)| level.is_none()));
    }
}
