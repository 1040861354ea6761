//! Programs (CONTROLLER G5): groups that begin, end, repeat and jump.

use crate::{
    controller::{Controller, NEVER, Paused, Program},
    input::Signal,
    motion::{Climb, Motion, Purpose},
    parameters::{Group, Jump, Move, MoveTo, Profile, Set, Wait},
    state::{Alarm, State},
};
use alloc::{rc::Rc, vec};

impl Controller {
    pub(crate) fn begin_program(&mut self, now: u64) {
        let reached = vec![0; self.parameters.groups.len()];
        let base = self.position.into();
        self.program = Some(Program { group: 1, loop_: 1, base, sum: 0, reached });
        self.begin_group(now);
    }

    pub(crate) fn begin_group(&mut self, now: u64) {
        let Some(number) = self.program.as_ref().map(|program| program.group) else { return };
        self.begun.group(number);
        self.state = State::Running;
        let parameters = Rc::clone(&self.parameters);
        match parameters.groups.get(number as usize - 1) {
            Some(Group::Move(group)) => self.begin_move_group(now, number, group),
            Some(Group::MoveTo(group)) => self.begin_move_to(now, group),
            Some(Group::Profile(group)) => self.begin_profile(now, number, group),
            Some(Group::Home) => self.home(now),
            Some(Group::Wait(group)) => self.begin_wait(now, group),
            Some(Group::Set(group)) => self.set_output(now, group),
            Some(Group::Repeat(group)) => {
                let goes_back = self.reach(number, group.times);
                self.end_group(now, 0, goes_back.then_some(group.first));
            }
            Some(Group::Jump(group)) => {
                let jumps = self.jumps(group);
                self.end_group(now, 0, jumps.then_some(group.to));
            }
            None => {}
        }
    }

    fn begin_move_group(&mut self, now: u64, number: u32, group: &Move) {
        let numbers = self.numbers.of_move(&self.parameters, number);
        let length = i64::from(numbers.length) * if numbers.right { 1 } else { -1 };
        let Some(program) = &mut self.program else { return };
        program.sum = program.sum.saturating_add(length);
        let until = group.until.as_ref().map(|until| (until.input, until.level));
        self.go_to_sum(now, numbers.speed_hz, numbers.level, until);
    }

    fn begin_move_to(&mut self, now: u64, group: &MoveTo) {
        let Some(program) = &mut self.program else { return };
        (program.base, program.sum) = (0, group.length.into());
        self.go_to_sum(now, group.speed_hz, group.level.into(), None);
    }

    /// Moves to b + P(T).
    fn go_to_sum(&mut self, now: u64, speed_hz: u32, level: u32, until: Option<(Signal, bool)>) {
        let Some(program) = &self.program else { return };
        let target = program.base + self.numbers.steps(program.sum);
        let steps = target - i128::from(self.position);
        if self.is_outside(steps) {
            return self.raise(Alarm::SoftLimit);
        }
        let mut motion = self.planned(Purpose::Group, steps, speed_hz, level);
        motion.until = until;
        self.begin_move(now, motion);
    }

    fn begin_profile(&mut self, now: u64, number: u32, group: &Profile) {
        let (right, rem) = (group.direction != 0, group.intervals.len() as u64);
        let steps = i128::from(rem) * if right { 1 } else { -1 };
        if self.is_outside(steps) {
            return self.raise(Alarm::SoftLimit);
        }
        if let Some(program) = &mut self.program {
            program.base += steps;
        }
        let climb = Climb { table: self.table(1), top: 0, plateau_hz: self.parameters.start_speed_hz };
        let mut motion = Motion::new(Purpose::Group, right, rem, climb, self.clock_hz);
        motion.profile = Some(number);
        self.begin_move(now, motion);
    }

    fn begin_wait(&mut self, now: u64, group: &Wait) {
        self.state = State::Wait;
        let wait = self.cycles(group.timeout_ms);
        self.timer = if wait == 0 { NEVER } else { now.saturating_add(wait) };
        self.begun.progress = self.begun.count;
    }

    fn set_output(&mut self, now: u64, group: &Set) {
        let output = 1_u8.checked_shl(group.output.into()).unwrap_or(0);
        self.outputs = if group.level { self.outputs | output } else { self.outputs & !output };
        self.end_group(now, 0, None);
    }

    fn reach(&mut self, number: u32, times: u32) -> bool {
        let reached = self.program.as_mut().and_then(|program| program.reached.get_mut(number as usize - 1));
        let Some(reached) = reached else { return false };
        *reached += 1;
        let goes_back = *reached < times;
        if !goes_back {
            *reached = 0;
        }
        goes_back
    }

    fn jumps(&self, group: &Jump) -> bool {
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
            self.take_position_as_base();
        }
        let number = self.program.as_ref().map_or(1, |program| program.group);
        let delay_ms = match self.parameters.groups.get(number as usize - 1) {
            Some(Group::MoveTo(group)) => group.delay_ms,
            Some(Group::Profile(group)) => group.delay_ms,
            _ => self.numbers.of_move(&self.parameters, number).delay_ms,
        };
        self.end_group(now, self.cycles(delay_ms), None);
    }

    /// b = position, T = 0.
    pub(crate) fn take_position_as_base(&mut self) {
        let position = self.position.into();
        if let Some(program) = &mut self.program {
            (program.base, program.sum) = (position, 0);
        }
    }

    /// Ends a group in `now`; `next` or the group after it follows, and is the current group from now on.
    pub(crate) fn end_group(&mut self, now: u64, delay: u64, next: Option<u32>) {
        let (used, loops) = (self.numbers.used(), self.numbers.loops());
        let Some(program) = &mut self.program else { return };
        program.group = next.unwrap_or(program.group + 1);
        if program.group > used {
            if program.loop_ >= loops {
                self.drop_program();
                self.state = State::Ready;
                return;
            }
            (program.group, program.loop_) = (1, program.loop_ + 1);
            program.reached.fill(0);
        }
        let state = if delay > 0 {
            self.begun.progress = self.begun.count;
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

    fn wait(&self) -> Option<&Wait> {
        let number = self.program.as_ref()?.group;
        match self.parameters.groups.get(number as usize - 1) {
            Some(Group::Wait(group)) => Some(group),
            _ => None,
        }
    }

    /// Whether the input has the level of the current `wait`.
    pub(crate) fn is_waited(&self) -> bool {
        self.wait().is_some_and(|group| self.inputs.level(group.input) == group.level)
    }

    pub(crate) fn time_out(&mut self, now: u64) {
        match self.wait().and_then(|group| group.then) {
            Some(then) => self.end_group(now, 0, Some(then)),
            None => self.raise(Alarm::Timeout),
        }
    }

    /// Ends a `wait` whose level is there, or that resumed with no time left.
    pub(crate) fn wait_condition(&mut self, now: u64) {
        if self.state != State::Wait {
            return;
        }
        if self.is_waited() {
            self.end_group(now, 0, None);
        } else if self.timer <= now {
            self.time_out(now);
        }
    }
}
