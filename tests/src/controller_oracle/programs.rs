//! G5: groups, loops, waits.

use super::arithmetic::{cycles_of_ms, steps_of_length};
use super::engine::{Motion, Order};
use super::parameters::{Group, Input, Profile};
use super::room::{Alarm, Kept, Room, State};

/// A running program.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    /// From 1.
    pub(super) group: usize,
    /// From 1.
    pub(super) of_loop: u32,
    /// b.
    base: i128,
    /// T, in display digits.
    sum: i128,
    /// How often each `repeat` was reached.
    reached: Vec<u32>,
}

impl Room {
    /// `start` in READY.
    pub(super) fn start_program(&mut self) {
        let controller = &self.plan.controller;
        if self.s.trust < controller.least_trust && controller.groups[0] != Group::Home {
            self.alarm(Alarm::Trust);
            return;
        }
        self.s.program = Some(Program {
            group: 1,
            of_loop: 1,
            base: i128::from(self.s.position),
            sum: 0,
            reached: vec![0; controller.groups.len()],
        });
        self.begin_group();
    }

    fn group(&self) -> Option<(usize, Group)> {
        let group = self.s.program.as_ref()?.group;
        Some((group, self.plan.controller.groups[group - 1].clone()))
    }

    /// The program's group begins in c.
    pub(super) fn begin_group(&mut self) {
        let Some((number, group)) = self.group() else { return };
        self.s.groups_begun += 1;
        self.s.state = State::Running;
        match group {
            Group::Move(_) => {
                let [length, _, direction, ..] = self.s.numbers.of_move(&self.plan.controller, number);
                let signed = if direction == 1 { length } else { -length };
                if let Some(program) = &mut self.s.program {
                    program.sum += i128::from(signed);
                }
                self.go_to_sum();
            }
            Group::MoveTo { length, .. } => {
                if let Some(program) = &mut self.s.program {
                    program.base = 0;
                    program.sum = i128::from(length);
                }
                self.go_to_sum();
            }
            Group::Profile(profile) => self.begin_profile(&profile),
            Group::Home => self.begin_homing(),
            Group::Wait { timeout_ms, .. } => {
                self.s.state = State::Wait;
                let cycles = cycles_of_ms(timeout_ms, self.plan.clock_hz);
                self.s.timer = (cycles > 0).then_some(self.now + cycles);
            }
            Group::Set { output, level } => {
                let bit = 1 << output;
                self.s.outputs = if level { self.s.outputs | bit } else { self.s.outputs & !bit };
                self.group_ends(None, 0);
            }
            Group::Repeat { first, times } => {
                let Some(program) = &mut self.s.program else { return };
                let reached = &mut program.reached[number - 1];
                *reached += 1;
                let back = *reached < times;
                if !back {
                    // Repeats nest: the next loop of an outer one counts from 0 again.
                    *reached = 0;
                }
                self.group_ends(back.then_some(first), 0);
            }
            Group::Jump { to, input, level } => {
                let jumps = input.is_none_or(|input| self.level(input) == level);
                self.group_ends(jumps.then_some(to), 0);
            }
        }
    }

    /// The rate and level of a group, and its `until`.
    fn asked(&self, number: usize, group: &Group) -> Option<(i64, i64, Option<super::Until>)> {
        match group {
            Group::Move(order) => {
                let [_, rate_hz, _, level, _] = self.s.numbers.of_move(&self.plan.controller, number);
                Some((rate_hz, level, order.until))
            }
            Group::MoveTo { speed_hz, level, .. } => Some((*speed_hz, *level, None)),
            _ => None,
        }
    }

    /// To b + P(T).
    fn go_to_sum(&mut self) {
        let Some(program) = &self.s.program else { return };
        let numbers = &self.s.numbers;
        let target =
            program.base + steps_of_length(program.sum, numbers.pulses_per_unit(), numbers.decimals());
        // Reading: exact; a position that has wrapped is far away.
        let steps = target - i128::from(self.s.position);
        if steps != 0 && self.is_outside(target) {
            self.alarm(Alarm::SoftLimit);
            return;
        }
        self.begin_rest_of_group(steps.abs(), steps > 0);
    }

    /// A move of `rem` steps by G3, with the group's speed and level.
    pub(super) fn begin_rest_of_group(&mut self, rem: i128, right: bool) {
        let Some((number, group)) = self.group() else { return };
        let Some((rate_hz, level, until)) = self.asked(number, &group) else { return };
        let mut motion = self.ramped(Order::Group, rem, right, rate_hz, level);
        motion.until = until;
        self.begin(motion);
    }

    fn begin_profile(&mut self, profile: &Profile) {
        let steps = profile.intervals_q16.len() as i128;
        let signed = if profile.right { steps } else { -steps };
        let target = i128::from(self.s.position) + signed;
        if steps != 0 && self.is_outside(target) {
            self.alarm(Alarm::SoftLimit);
            return;
        }
        if let Some(program) = &mut self.s.program {
            program.base += signed;
        }
        let mut motion = Motion::constant(Order::Group, steps, profile.right, 10);
        motion.profile = Some(profile.intervals_q16.iter().rev().copied().collect());
        self.begin(motion);
    }

    /// The move of a group ends in c; its remaining steps are dropped if `until` was met.
    pub(super) fn move_of_group_ends(&mut self, until_met: bool) {
        let Some((number, group)) = self.group() else { return };
        if until_met {
            self.base_is_here();
        }
        let delay_ms = match group {
            Group::Move(_) => self.s.numbers.of_move(&self.plan.controller, number)[4],
            Group::MoveTo { delay_ms, .. } => delay_ms,
            Group::Profile(profile) => profile.delay_ms,
            _ => 0,
        };
        self.group_ends(None, delay_ms);
    }

    /// The program's `home` has ended.
    pub(super) fn home_of_group_ends(&mut self) {
        self.base_is_here();
        self.group_ends(None, 0);
    }

    /// b = position, T = 0.
    fn base_is_here(&mut self) {
        let position = i128::from(self.s.position);
        if let Some(program) = &mut self.s.program {
            program.base = position;
            program.sum = 0;
        }
    }

    /// A group ends in c; `to` is the next one, by default the following one.
    fn group_ends(&mut self, to: Option<usize>, delay_ms: i64) {
        let (used, loops) = (self.s.numbers.used(), self.s.numbers.loops());
        let Some(program) = &mut self.s.program else { return };
        program.group = to.unwrap_or(program.group + 1);
        if program.group > used {
            // Group 1 follows the last one.
            program.group = 1;
            program.of_loop += 1;
            program.reached.fill(0);
        }
        if program.of_loop > loops {
            // Reading: in PAUSING, too, because nothing is left that `start` could continue.
            self.drop_program();
            self.s.state = State::Ready;
            return;
        }
        let delay = cycles_of_ms(delay_ms, self.plan.clock_hz);
        let state = if delay > 0 { State::Delay } else { State::Running };
        let left = delay.max(1);
        if self.s.state == State::Pausing {
            self.s.state = State::Paused;
            self.s.kept = Some(Kept { rem: 0, right: false, state, left: Some(left) });
        } else {
            self.s.state = state;
            self.s.timer = Some(self.now + left);
        }
    }

    fn wait(&self) -> Option<(Input, bool, Option<usize>)> {
        match self.group()?.1 {
            Group::Wait { input, level, then, .. } => Some((input, level, then)),
            _ => None,
        }
    }

    /// The time of a wait is over: without its level it ends.
    pub(super) fn time_of_wait_ends(&mut self) {
        let Some((input, level, then)) = self.wait() else { return };
        if self.level(input) == level {
            return;
        }
        self.s.timer = None;
        match then {
            Some(then) => self.group_ends(Some(then), 0),
            None => self.alarm(Alarm::Timeout),
        }
    }

    /// WAIT until the debounced input has the level.
    pub(super) fn condition_of_wait(&mut self) {
        if self.s.state != State::Wait {
            return;
        }
        let Some((input, level, _)) = self.wait() else { return };
        if self.level(input) == level {
            self.s.timer = None;
            self.group_ends(None, 0);
        }
    }
}
