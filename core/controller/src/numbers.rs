//! The numbers that the panel can change, and their ranges (CONTROLLER G8).
//!
//! | number | content |
//! | --- | --- |
//! | 0 to 7 | pulses_per_unit, decimals, jog.speed_hz, jog.fine_hz, return.speed_hz, return.level, loops, used groups |
//! | 8 + 5*k to 12 + 5*k | length, speed_hz, direction, level, delay_ms of `move` k (from 0) |

use crate::limits;
use crate::parameters::{Group, Move, Parameters};
use alloc::vec::Vec;
use core::ops::RangeInclusive;

/// Numbers that exist once, and per move.
pub(crate) const COMMON: usize = 8;
pub(crate) const PER_MOVE: usize = 5;

/// A number that exists once; the discriminant is its index.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Common {
    PulsesPerUnit,
    Decimals,
    JogSpeedHz,
    JogFineHz,
    ReturnSpeedHz,
    ReturnLevel,
    Loops,
    UsedGroups,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Numbers(Vec<i32>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MoveNumbers {
    pub(crate) length: i32,
    pub(crate) speed_hz: u32,
    pub(crate) right: bool,
    pub(crate) level: u32,
    pub(crate) delay_ms: u32,
}

fn moves(parameters: &Parameters) -> impl Iterator<Item = &Move> {
    parameters.groups.iter().filter_map(|group| match group {
        Group::Move(group) => Some(group),
        _ => None,
    })
}

impl Parameters {
    /// Values that the panel can change: 8, and 5 per `move`.
    pub fn number_count(&self) -> usize {
        COMMON + PER_MOVE * moves(self).count()
    }
}

fn range(parameters: &Parameters, index: usize) -> RangeInclusive<i128> {
    let speed_hz = *limits::SPEED_HZ.start()..=i128::from(parameters.max_speed_hz);
    match index {
        0 => limits::PULSES_PER_UNIT,
        1 => limits::DECIMALS,
        2..=4 => speed_hz,
        5 => limits::LEVEL,
        6 => limits::LOOPS,
        7 => 1..=parameters.groups.len() as i128,
        _ => match (index - COMMON) % PER_MOVE {
            0 => limits::LENGTH,
            1 => speed_hz,
            2 => limits::DIRECTION,
            3 => limits::LEVEL,
            _ => limits::DELAY_MS,
        },
    }
}

impl Numbers {
    pub(crate) fn new(parameters: &Parameters) -> Self {
        let common = [
            parameters.pulses_per_unit,
            parameters.decimals.into(),
            parameters.jog.speed_hz,
            parameters.jog.fine_hz,
            parameters.return_.speed_hz,
            parameters.return_.level.into(),
            parameters.loops,
            parameters.groups.len() as u32,
        ];
        let of_moves = moves(parameters).flat_map(|group| {
            let (direction, level) = (group.direction.into(), group.level.into());
            [group.length, group.speed_hz, direction, level, group.delay_ms]
        });
        Self(common.into_iter().chain(of_moves).map(|number| number as i32).collect())
    }

    pub(crate) fn in_range(parameters: &Parameters, numbers: Vec<i32>) -> Option<Self> {
        let is_in_range = |(index, &number): (usize, &i32)| range(parameters, index).contains(&number.into());
        let all = numbers.len() == parameters.number_count() && numbers.iter().enumerate().all(is_in_range);
        all.then_some(Self(numbers))
    }

    /// Stores an entry; returns whether the number changed, or `None` if the entry is out of range.
    pub(crate) fn store(&mut self, parameters: &Parameters, index: usize, entry: u32) -> Option<bool> {
        let is_in_range = range(parameters, index).contains(&entry.into());
        let number = self.0.get_mut(index).filter(|_| is_in_range)?;
        let entry = entry as i32;
        let has_changed = *number != entry;
        *number = entry;
        Some(has_changed)
    }

    pub(crate) fn all(&self) -> &[i32] {
        &self.0
    }

    pub(crate) fn get(&self, index: usize) -> i32 {
        self.0.get(index).copied().unwrap_or(0)
    }

    pub(crate) fn common(&self, number: Common) -> u32 {
        self.get(number as usize) as u32
    }

    fn pulses_per_unit(&self) -> i64 {
        self.common(Common::PulsesPerUnit).max(1).into()
    }

    /// Displayed lengths are `digits` without a decimal point: 305 is 30.5 at a scale of 10.
    fn scale(&self) -> i64 {
        10_i64.pow(self.common(Common::Decimals).min(3))
    }

    /// The numbers of group `group` (from 1), which is a `move`.
    pub(crate) fn of_move(&self, parameters: &Parameters, group: u32) -> MoveNumbers {
        let before = parameters.groups.iter().take(group.saturating_sub(1) as usize);
        let before = before.filter(|group| matches!(group, Group::Move(_))).count();
        let number = |index| self.get(COMMON + PER_MOVE * before + index);
        MoveNumbers {
            length: number(0),
            speed_hz: number(1) as u32,
            right: number(2) != 0,
            level: number(3) as u32,
            delay_ms: number(4) as u32,
        }
    }

    /// Steps of a displayed length, rounded half up.
    pub(crate) fn steps(&self, digits: i64) -> i128 {
        let scale = i128::from(self.scale());
        (2 * i128::from(digits) * i128::from(self.pulses_per_unit()) + scale).div_euclid(2 * scale)
    }

    /// The displayed position, rounded half away from zero.
    pub(crate) fn digits(&self, position: i32) -> i64 {
        let position = i64::from(position);
        let pulses = self.pulses_per_unit();
        position.signum() * ((2 * position.abs() * self.scale() + pulses) / (2 * pulses))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::MoveTo;
    use alloc::vec;

    fn numbers(pulses_per_unit: u32, decimals: u8) -> Numbers {
        Numbers::new(&Parameters { pulses_per_unit, decimals, ..Parameters::default() })
    }

    #[test]
    fn a_length_is_rounded_half_up_to_steps() {
        // N, d, digits, steps.
        let rows = [
            (565, 1, 305, 17_233), // 17232.5
            (565, 1, -305, -17_232),
            (100, 1, 1000, 10_000),
            (1, 1, 4, 0),
            (1, 1, 5, 1),
            (1, 1, -5, 0),
            (1, 1, -6, -1),
            (999_999, 0, 999_999, 999_998_000_001),
        ];
        for (pulses, decimals, digits, expected) in rows {
            assert_eq!(numbers(pulses, decimals).steps(digits), expected, "{pulses} {decimals} {digits}");
        }
    }

    #[test]
    fn a_position_is_rounded_away_from_zero_to_digits() {
        for (pulses, decimals, position, expected) in [
            (565, 1, 17_233, 305),
            (2, 0, 1, 1),
            (2, 0, -1, -1),
            (2, 0, 0, 0),
            (1, 3, i32::MIN, -2_147_483_648_000),
        ] {
            assert_eq!(
                numbers(pulses, decimals).digits(position),
                expected,
                "{pulses} {decimals} {position}"
            );
        }
    }

    #[test]
    fn the_numbers_of_moves_follow_the_eight_common_ones() {
        let second = Move { length: 7, speed_hz: 60, direction: 0, level: 5, delay_ms: 9, until: None };
        let groups =
            vec![Group::Move(Move::default()), Group::MoveTo(MoveTo::default()), Group::Move(second)];
        let parameters = Parameters { groups, loops: 12, ..Parameters::default() };
        let mut numbers = Numbers::new(&parameters);
        assert_eq!(numbers.all(), [100, 1, 1000, 10, 1000, 3, 12, 3, 1000, 5000, 1, 3, 0, 7, 60, 0, 5, 9]);
        assert_eq!(parameters.number_count(), 18);
        let expected = MoveNumbers { length: 7, speed_hz: 60, right: false, level: 5, delay_ms: 9 };
        assert_eq!(numbers.of_move(&parameters, 3), expected);
        // Index, entry, whether the number changes (`None`: out of range).
        for (index, entry, expected) in [
            (7, 4, None),
            (7, 3, Some(false)),
            (7, 1, Some(true)),
            (2, 9, None),
            (2, 20_000, Some(true)),
            (2, 20_001, None),
            (15, 2, None),
            (15, 1, Some(true)),
            (18, 1, None),
        ] {
            assert_eq!(numbers.store(&parameters, index, entry), expected, "{index} {entry}");
        }
        assert_eq!(Numbers::in_range(&parameters, numbers.all().to_vec()), Some(numbers.clone()));
        assert_eq!(Numbers::in_range(&parameters, vec![0; 18]), None);
        assert_eq!(Numbers::in_range(&parameters, vec![1]), None);
    }
}
