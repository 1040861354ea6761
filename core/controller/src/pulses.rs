//! The engine (CONTROLLER G1.1) and the inputs (G1.3) of a cycle.

use crate::{
    controller::Controller,
    input::{Change, Signal},
    parameters::{Group, Parameters},
    state::State,
};

/// The intervals of group `group` if it is a `profile`, else none.
pub(crate) fn profile(parameters: &Parameters, group: Option<u32>) -> &[u64] {
    let index = group.and_then(|group| usize::try_from(group).ok()?.checked_sub(1));
    match index.and_then(|index| parameters.groups.get(index)) {
        Some(Group::Profile(profile)) => &profile.intervals,
        _ => &[],
    }
}

impl Controller {
    pub(crate) fn engine(&mut self, now: u64) {
        self.pins.fall_and_turn(now);
        let Some(motion) = &mut self.motion else { return };
        if motion.rise() > now {
            return;
        }
        debug_assert!(self.pins.dir == motion.right && !self.pins.step, "a step rises too soon");
        self.pins.rise(now, self.pulse.width.0);
        let right = self.pins.dir;
        let (is_first, rate_interval) = motion.step(profile(&self.parameters, motion.profile));
        let by = if right { 1 } else { -1 };
        self.position = self.position.wrapping_add(by);
        self.steps = self.steps.wrapping_add(by);
        if self.pins.en {
            self.axis.shift(by.into());
        }
        if is_first && self.is_jump(rate_interval) {
            self.trust = 0;
        }
        self.begun.progress = self.begun.count;
    }

    /// Applies the script, the switches of the axis, and debouncing.
    pub(crate) fn read_inputs(&mut self, now: u64) {
        let debounces = self.state != State::Off;
        while let Some(change) = self.script.take(now) {
            match change {
                Change::Level(signal, level) => self.inputs.set(now, signal, level, debounces),
                Change::Push(steps) if !self.pins.en => self.axis.shift(steps.into()),
                Change::Push(_) => {}
            }
        }
        self.switches(now);
        self.inputs.debounce(now);
    }

    pub(crate) fn switches(&mut self, now: u64) {
        let debounces = self.state != State::Off;
        for (signal, level) in self.axis.switches() {
            if let Some(level) = level {
                self.inputs.set(now, signal, level, debounces);
            }
        }
    }

    pub(crate) const fn limit(&self, right: bool) -> bool {
        self.inputs.level(if right { Signal::LimitMax } else { Signal::LimitMin })
    }
}
