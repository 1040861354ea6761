//! Programs (CONTROLLER G5): groups that begin, end, repeat and jump.

use crate::controller::{Controller, NEVER, Paused, Program};
use crate::motion::{Climb, Motion, Purpose};
use crate::parameters::{Group, Jump, Move, MoveTo, Profile, Set, Wait};
use crate::state::{Alarm, State};
use crate::{input::Signal, numbers::Common};
use alloc::{sync::Arc, vec};

impl Controller {
    pub(crate) fn begin_program(&mut self, now: u64) {
        let repeat_counts = vec![0; self.parameters.groups.len()];
        let base = self.position.into();
        self.program = Some(Program { group: 1, loop_: 1, base, length_sum: 0, repeat_counts });
        self.begin_group(now);
    }

    pub(crate) fn begin_group(&mut self, now: u64) {
        let Some(number) = self.program.as_ref().map(|program| program.group) else { return };
        self.group_counter.group(number);
        self.state = State::Running;
        let parameters = Arc::clone(&self.parameters);
        match parameters.groups.get(number as usize - 1) {
            Some(Group::Move(group)) => self.begin_move_group(now, number, group),
            Some(Group::MoveTo(group)) => self.begin_move_to(now, group),
            Some(Group::Profile(group)) => self.begin_profile(now, number, group),
            Some(Group::Home) => self.home(now),
            Some(Group::Wait(group)) => self.begin_wait(now, group),
            Some(Group::Set(group)) => self.set_output(now, group),
            Some(Group::Repeat(group)) => {
                let should_repeat = self.should_repeat(number, group.times);
                self.end_group(now, 0, should_repeat.then_some(group.first));
            }
            Some(Group::Jump(group)) => {
                let should_jump = self.should_jump(group);
                self.end_group(now, 0, should_jump.then_some(group.to));
            }
            None => {}
        }
    }

    fn begin_move_group(&mut self, now: u64, number: u32, group: &Move) {
        let numbers = self.numbers.of_move(&self.parameters, number);
        let length = i64::from(numbers.length) * if numbers.right { 1 } else { -1 };
        let Some(program) = &mut self.program else { return };
        program.length_sum = program.length_sum.saturating_add(length);
        let until = group.until.as_ref().map(|until| (until.input, until.level));
        self.go_to_sum(now, numbers.speed_hz, numbers.level, until);
    }

    fn begin_move_to(&mut self, now: u64, group: &MoveTo) {
        let Some(program) = &mut self.program else { return };
        (program.base, program.length_sum) = (0, group.length.into());
        self.go_to_sum(now, group.speed_hz, group.level.into(), None);
    }

    /// Moves to the base plus the sum of all lengths.
    fn go_to_sum(&mut self, now: u64, speed_hz: u32, level: u32, until: Option<(Signal, bool)>) {
        let Some(program) = &self.program else { return };
        let target = program.base + self.numbers.steps(program.length_sum);
        let steps = target - i128::from(self.position);
        if self.is_outside(steps) {
            return self.raise(Alarm::SoftLimit);
        }
        let mut motion = self.plan_move(Purpose::Group, steps, speed_hz, level);
        motion.until = until;
        self.begin_move(now, motion);
    }

    fn begin_profile(&mut self, now: u64, number: u32, group: &Profile) {
        let (right, count) = (group.direction != 0, group.intervals.len() as u64);
        let steps = i128::from(count) * if right { 1 } else { -1 };
        if self.is_outside(steps) {
            return self.raise(Alarm::SoftLimit);
        }
        if let Some(program) = &mut self.program {
            program.base += steps;
        }
        let climb = Climb { table: self.table(1), top: 0, plateau_hz: self.parameters.start_speed_hz };
        let mut motion = Motion::new(Purpose::Group, right, count, climb, self.clock_hz);
        motion.profile = Some(number);
        self.begin_move(now, motion);
    }

    fn begin_wait(&mut self, now: u64, group: &Wait) {
        self.state = State::Wait;
        let timeout = self.cycles(group.timeout_ms);
        self.timer = if timeout == 0 { NEVER } else { now.saturating_add(timeout) };
        self.group_counter.progress = self.group_counter.count;
    }

    fn set_output(&mut self, now: u64, group: &Set) {
        let bit = 1_u8.checked_shl(group.output.into()).unwrap_or(0);
        self.outputs = if group.level { self.outputs | bit } else { self.outputs & !bit };
        self.end_group(now, 0, None);
    }

    /// Counts the arrival at a `repeat`.
    fn should_repeat(&mut self, number: u32, times: u32) -> bool {
        let Some(program) = &mut self.program else { return false };
        let Some(count) = program.repeat_counts.get_mut(number as usize - 1) else { return false };
        *count += 1;
        let repeats = *count < times;
        if !repeats {
            *count = 0;
        }
        repeats
    }

    fn should_jump(&self, group: &Jump) -> bool {
        group.input.is_none_or(|input| self.inputs.level(input) == group.level)
    }

    pub(crate) fn group_speed_and_level(&self) -> (u32, u32) {
        let number = self.program.as_ref().map_or(1, |program| program.group);
        match self.parameters.groups.get(number as usize - 1) {
            Some(Group::MoveTo(group)) => (group.speed_hz, group.level.into()),
            _ => {
                let numbers = self.numbers.of_move(&self.parameters, number);
                (numbers.speed_hz, numbers.level)
            }
        }
    }

    pub(crate) fn end_move_group(&mut self, now: u64, motion: &Motion) {
        if motion.until_met {
            self.set_base_to_position();
        }
        let number = self.program.as_ref().map_or(1, |program| program.group);
        let delay_ms = match self.parameters.groups.get(number as usize - 1) {
            Some(Group::MoveTo(group)) => group.delay_ms,
            Some(Group::Profile(group)) => group.delay_ms,
            _ => self.numbers.of_move(&self.parameters, number).delay_ms,
        };
        self.end_group(now, self.cycles(delay_ms), None);
    }

    /// Lengths count from the current position on.
    pub(crate) fn set_base_to_position(&mut self) {
        let position = self.position.into();
        if let Some(program) = &mut self.program {
            (program.base, program.length_sum) = (position, 0);
        }
    }

    /// Ends a group. The next one, by default the following, is current from now on and begins after `delay` cycles.
    pub(crate) fn end_group(&mut self, now: u64, delay: u64, next: Option<u32>) {
        let used = self.numbers.common(Common::UsedGroups);
        let loops = self.numbers.common(Common::Loops);
        let Some(program) = &mut self.program else { return };
        program.group = next.unwrap_or(program.group + 1);
        if program.group > used {
            if program.loop_ >= loops {
                self.cancel_program();
                self.state = State::Ready;
                return;
            }
            (program.group, program.loop_) = (1, program.loop_ + 1);
            program.repeat_counts.fill(0);
        }
        let state = if delay > 0 {
            self.group_counter.progress = self.group_counter.count;
            State::Delay
        } else {
            State::Running
        };
        let wait = delay.max(1);
        if self.state == State::Pausing {
            (self.state, self.timer) = (State::Paused, NEVER);
            self.paused = Some(Paused::Time(state, Some(wait)));
        } else {
            (self.state, self.timer) = (state, now.saturating_add(wait));
        }
    }

    fn current_wait(&self) -> Option<&Wait> {
        let number = self.program.as_ref()?.group;
        match self.parameters.groups.get(number as usize - 1) {
            Some(Group::Wait(group)) => Some(group),
            _ => None,
        }
    }

    /// Whether the input has the level of the current `wait`.
    pub(crate) fn is_wait_met(&self) -> bool {
        self.current_wait().is_some_and(|group| self.inputs.level(group.input) == group.level)
    }

    pub(crate) fn time_out(&mut self, now: u64) {
        match self.current_wait().and_then(|group| group.then) {
            Some(then) => self.end_group(now, 0, Some(then)),
            None => self.raise(Alarm::Timeout),
        }
    }

    /// Ends a `wait` whose input has the level, or that resumed with no time left.
    pub(crate) fn check_wait(&mut self, now: u64) {
        if self.state != State::Wait {
            return;
        }
        if self.is_wait_met() {
            self.end_group(now, 0, None);
        } else if self.timer <= now {
            self.time_out(now);
        }
    }
}
