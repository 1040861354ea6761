//! The pulses (CONTROLLER G1.1) and the inputs (G1.3) of a cycle.

use crate::controller::Controller;
use crate::input::{Change, Signal};
use crate::parameters::{Group, Parameters};
use crate::state::{State, trust};

/// The intervals of group `group` if it is a `profile`; empty otherwise.
pub(crate) fn profile(parameters: &Parameters, group: Option<u32>) -> &[u64] {
    let index = group.and_then(|group| usize::try_from(group).ok()?.checked_sub(1));
    match index.and_then(|index| parameters.groups.get(index)) {
        Some(Group::Profile(profile)) => &profile.intervals,
        _ => &[],
    }
}

impl Controller {
    /// Ends and begins the pulse that is due.
    pub(crate) fn run_engine(&mut self, now: u64) {
        self.pins.fall_and_turn(now);
        let Some(motion) = &mut self.motion else { return };
        if motion.rise() > now {
            return;
        }
        debug_assert!(
            self.pins.dir == motion.right && !self.pins.step,
            "a step came before the last one ended"
        );
        self.pins.rise(now, self.pulse.width.0);
        let step = motion.step(profile(&self.parameters, motion.profile));
        let shift = if self.pins.dir { 1 } else { -1 };
        self.position = self.position.wrapping_add(shift);
        self.step_count = self.step_count.wrapping_add(shift);
        if self.pins.en {
            self.axis.shift(shift.into());
        }
        if step.is_first && self.is_jump(step.rate_interval) {
            self.trust = trust::LOST;
        }
        self.group_counter.progress = self.group_counter.count;
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
        self.update_switches(now);
        self.inputs.debounce(now);
    }

    pub(crate) fn update_switches(&mut self, now: u64) {
        let debounces = self.state != State::Off;
        for (signal, level) in self.axis.switches() {
            if let Some(level) = level {
                self.inputs.set(now, signal, level, debounces);
            }
        }
    }

    pub(crate) const fn is_limit_closed(&self, right: bool) -> bool {
        self.inputs.level(if right { Signal::LimitMax } else { Signal::LimitMin })
    }
}
