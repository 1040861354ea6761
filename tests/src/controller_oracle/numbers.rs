//! G8: the numbers that EDIT shows and the two banks contain.

use super::parameters::{Controller, Group};

/// The current numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Numbers {
    values: Vec<i64>,
    /// `ok` has changed one since they were read or saved.
    // Reading: the order of saving is that of `back`, regardless of the time of writing.
    pub(super) changed: bool,
}

/// Numbers before those of the first `move`.
const FIXED: usize = 8;
/// Numbers of a `move`.
const OF_MOVE: usize = 5;

/// Number of a controller's numbers.
pub(super) fn count(controller: &Controller) -> usize {
    Numbers::of_scenario(controller).values.len()
}

impl Numbers {
    pub(super) fn of_scenario(controller: &Controller) -> Self {
        let mut values = vec![
            controller.pulses_per_unit,
            controller.decimals,
            controller.jog.speed_hz,
            controller.jog.fine_hz,
            controller.return_to_zero.speed_hz,
            controller.return_to_zero.level,
            controller.loops,
            controller.groups.len() as i64,
        ];
        for group in &controller.groups {
            if let Group::Move(order) = group {
                values.extend([
                    order.length,
                    order.speed_hz,
                    i64::from(order.right),
                    order.level,
                    order.delay_ms,
                ]);
            }
        }
        Self { values, changed: false }
    }

    /// The numbers of a bank, if all are in range.
    pub(super) fn of_bank(controller: &Controller, values: Vec<i64>) -> Option<Self> {
        let numbers = Self { values, changed: false };
        (0..numbers.values.len())
            .all(|number| numbers.is_in_range(controller, number, numbers.values[number]))
            .then_some(numbers)
    }

    pub(super) fn is_in_range(&self, controller: &Controller, number: usize, value: i64) -> bool {
        let speed = 10..=controller.max_speed_hz;
        let range = match number {
            0 => 1..=999_999,
            1 => 0..=3,
            2..=4 => speed,
            5 => 1..=5,
            6 => 1..=9999,
            7 => 1..=controller.groups.len() as i64,
            _ => match (number - FIXED) % OF_MOVE {
                0 => 0..=999_999,
                1 => speed,
                2 => 0..=1,
                3 => 1..=5,
                _ => 0..=999_999,
            },
        };
        range.contains(&value)
    }

    pub(super) fn count(&self) -> usize {
        self.values.len()
    }

    pub(super) fn value(&self, number: usize) -> i64 {
        self.values[number]
    }

    pub(super) fn values(&self) -> &[i64] {
        &self.values
    }

    pub(super) fn store(&mut self, number: usize, value: i64) {
        // Reading: storing an equal number changes nothing.
        self.changed |= self.values[number] != value;
        self.values[number] = value;
    }

    pub(super) fn pulses_per_unit(&self) -> i64 {
        self.values[0]
    }

    pub(super) fn decimals(&self) -> i64 {
        self.values[1]
    }

    /// `speed_hz`, `fine_hz`.
    pub(super) fn jog(&self) -> [i64; 2] {
        [self.values[2], self.values[3]]
    }

    /// `speed_hz`, `level`.
    pub(super) fn return_to_zero(&self) -> [i64; 2] {
        [self.values[4], self.values[5]]
    }

    pub(super) fn loops(&self) -> u32 {
        self.values[6] as u32
    }

    pub(super) fn used(&self) -> usize {
        self.values[7] as usize
    }

    /// length, speed_hz, direction, level, delay_ms of the `move` in group `group`.
    pub(super) fn of_move(&self, controller: &Controller, group: usize) -> [i64; OF_MOVE] {
        let is_move = |group: &&Group| matches!(group, Group::Move(_));
        let before = controller.groups[..group - 1].iter().filter(is_move).count();
        let at = FIXED + OF_MOVE * before;
        [0, 1, 2, 3, 4].map(|field| self.values[at + field])
    }
}
