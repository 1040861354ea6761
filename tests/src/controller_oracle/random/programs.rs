//! Groups of a random controller.

use super::super::arithmetic::{Table, interval, ten_to};
use super::super::parameters::{Case, Controller, Group, Input, Move, Profile, Until};
use super::Dice;

impl Dice {
    /// A program: any groups, nested ones, or a long move with many inputs.
    pub(super) fn program(&mut self, case: &Case, controller: &Controller) -> Vec<Group> {
        let groups = self.pick(&[1, 1, 2, 3, 4, 5, 7, 9]);
        let mut program: Vec<Group> =
            (1..=groups).map(|number| self.group(case, controller, number, groups)).collect();
        match self.below(10) {
            0 => program = self.nest(case, controller),
            1 | 2 => program[0] = self.long_move(controller),
            _ => {}
        }
        program
    }

    /// Nested repeats, and a jump out of them.
    fn nest(&mut self, case: &Case, controller: &Controller) -> Vec<Group> {
        let out = Group::Jump { to: 6, input: Some(Input::In(0)), level: self.chance(80) };
        let set = Group::Set { output: self.below(4) as u8, level: self.chance(50) };
        vec![
            self.group(case, controller, 1, 1),
            if self.chance(50) { out } else { set },
            Group::Repeat { first: self.between(1, 2) as usize, times: self.between(2, 3) as u32 },
            self.group(case, controller, 1, 1),
            Group::Repeat { first: self.between(1, 4) as usize, times: self.between(2, 3) as u32 },
            self.group(case, controller, 6, 6),
        ]
    }

    /// Acceleration with `until`.
    pub(super) fn long_move(&mut self, controller: &Controller) -> Group {
        let (steps, level) = (self.whole(60, 500), self.whole(1, 5));
        let table =
            Table::new(controller.start_speed_hz, level * controller.level_hz_s, controller.max_speed_hz);
        let top = if self.chance(70) { self.whole(1, steps / 2) } else { 10_000 };
        let speed_hz = table.rate_of_step(i128::from(top)).min(controller.max_speed_hz);
        let length = (steps * ten_to(controller.decimals) as i64 / controller.pulses_per_unit).min(999_999);
        Group::Move(Move {
            length,
            right: self.chance(50),
            speed_hz,
            level,
            delay_ms: 0,
            until: self
                .chance(80)
                .then(|| Until { input: Input::In(self.below(2) as u8), level: self.chance(90) }),
        })
    }

    /// A speed, and a number of steps close to twice those of its ramp.
    fn just_fits(&mut self, controller: &Controller, level: i64) -> (i64, i64) {
        let max = controller.max_speed_hz;
        let table = Table::new(controller.start_speed_hz, level * controller.level_hz_s, max);
        let speed_hz = table.rate_of_step(i128::from(self.whole(1, 150))).min(max).max(10);
        let steps = 2 * table.steps_to(speed_hz) as i64 + self.whole(-1, 1);
        (speed_hz, steps.clamp(0, 400))
    }

    fn group(&mut self, case: &Case, controller: &Controller, number: u64, groups: u64) -> Group {
        let steps = self.pick(&[0, 1, 2, 3, 10, 60, 61, 150, 300]);
        let mut steps = if self.chance(50) { steps } else { self.whole(0, 300) };
        let max = controller.max_speed_hz;
        let mut speed_hz =
            if self.chance(80) { self.whole((max / 5).max(10), max) } else { self.whole(10, max) };
        let ramp = self.whole(1, 5);
        if self.chance(25) {
            (speed_hz, steps) = self.just_fits(controller, ramp);
        }
        let digits = steps * ten_to(controller.decimals) as i64 / controller.pulses_per_unit;
        let length = digits.clamp(0, 999_999);
        let delay_ms = if self.chance(60) { 0 } else { self.whole(0, 40) };
        let input = self.any_input();
        let level = self.chance(50);
        match self.below(20) {
            0..=6 => Group::Move(Move {
                length,
                right: self.chance(60),
                speed_hz,
                level: ramp,
                delay_ms,
                until: self.chance(30).then(|| Until {
                    input: self.pick(&[
                        Input::In(0),
                        Input::In(1),
                        Input::In(2),
                        Input::In(3),
                        Input::HomeSwitch,
                    ]),
                    level: !self.chance(30),
                }),
            }),
            7 | 8 => Group::MoveTo {
                length: if self.chance(50) { length } else { -length },
                speed_hz,
                level: ramp,
                delay_ms,
            },
            9 | 10 => self.profile(case, controller, delay_ms),
            11 if controller.home.is_some() => Group::Home,
            11..=13 => Group::Wait {
                input,
                level,
                timeout_ms: if self.chance(25) { 0 } else { self.whole(0, 60) },
                then: self.chance(50).then(|| self.between(1, groups) as usize),
            },
            14 | 15 => Group::Set { output: self.below(4) as u8, level: self.chance(70) },
            16 | 17 if number > 1 => Group::Repeat {
                first: self.between(1, number - 1) as usize,
                times: self.between(1, 4) as u32,
            },
            18 | 19 if number < groups => Group::Jump {
                to: self.between(number, groups) as usize,
                input: self.chance(70).then_some(input),
                level,
            },
            18 => Group::Jump { to: self.between(1, groups) as usize, input: Some(input), level },
            _ => Group::Move(Move { length, right: level, speed_hz, delay_ms, ..Move::default() }),
        }
    }

    fn any_input(&mut self) -> Input {
        let number = self.below(4) as u8;
        self.pick(&[
            Input::In(number),
            Input::In(number),
            Input::In(number),
            Input::HomeSwitch,
            Input::LimitMin,
            Input::LimitMax,
        ])
    }

    fn profile(&mut self, case: &Case, controller: &Controller, delay_ms: i64) -> Group {
        let least = (case.w + (case.h + case.d).max(1)) << 16;
        let slow = interval(case.clock_hz, controller.start_speed_hz) as u64;
        let intervals_q16 = (0..self.between(1, 60))
            .map(|_| if self.chance(10) { least } else { self.between(least, least.max(slow * 3 / 2)) })
            .collect();
        Group::Profile(Profile { intervals_q16, right: self.chance(50), delay_ms })
    }
}
