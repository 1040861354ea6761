//! G4: a move, its decisions, its stops; step 1 of G1 drives STEP and DIR by it.
//!
//! ```text
//! begin c: next = (c+1) << 16, DIR at max(c+1, last fall + H), decision
//! rise at next >> 16: position, rem - 1, decision (next += interval)        fall W later; the last one ends the move
//! ```

use super::parameters::{Home, Input, ShortMove, Until};
use super::room::{Room, State};

/// Owner of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Group,
    Return,
    Jog,
    /// A leg of homing, or its return.
    Homing,
}

/// A move.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    pub(super) order: Order,
    /// Remaining steps, including the one that is due.
    pub(super) rem: i128,
    pub(super) right: bool,
    /// u.
    pub(super) height: i128,
    pub(super) top: i128,
    /// r.
    pub(super) plateau_hz: i64,
    /// Level of the table.
    pub(super) level: i64,
    pub(super) until: Option<Until>,
    pub(super) until_met: bool,
    /// Intervals of a profile that are not decided yet, the next one last.
    pub(super) profile: Option<Vec<u64>>,
    /// The first interval is Lm (jog).
    pub(super) first_is_least: bool,
    pub(super) braking: bool,
    /// It waits for the memory.
    pub(super) waiting: bool,
    /// 48.16 cycles.
    next: u128,
    /// Rate interval of the step that is due.
    pub(super) due: Option<u128>,
    /// Rate interval of the last step.
    pub(super) made: Option<u128>,
    /// A limit switch stopped it.
    pub(super) at_limit: bool,
    /// It ends in this cycle.
    pub(super) over: bool,
}

impl Motion {
    /// `rem` steps at a constant rate.
    pub(super) fn constant(order: Order, rem: i128, right: bool, plateau_hz: i64) -> Self {
        Self {
            order,
            rem,
            right,
            height: 0,
            top: 0,
            plateau_hz,
            level: 1,
            until: None,
            until_met: false,
            profile: None,
            first_is_least: false,
            braking: false,
            waiting: false,
            next: 0,
            due: None,
            made: None,
            at_limit: false,
            over: false,
        }
    }

    /// Cycle of the step that is due.
    pub(super) fn due_cycle(&self) -> Option<u64> {
        self.due.map(|_| u64::try_from(self.next >> 16).unwrap_or(u64::MAX))
    }

    /// A step is due or the move waits.
    pub(super) fn is_heeding(&self) -> bool {
        self.due.is_some() || self.waiting
    }
}

impl Room {
    /// G3: a move of n steps at r.
    pub(super) fn ramped(&self, order: Order, rem: i128, right: bool, rate_hz: i64, level: i64) -> Motion {
        let controller = &self.plan.controller;
        let mut motion = Motion::constant(order, rem, right, rate_hz);
        motion.level = level;
        motion.top = self.plan.table(level).steps_to(rate_hz);
        if 2 * motion.top > rem && controller.short_move == ShortMove::Document {
            motion.top = 0;
            motion.plateau_hz = controller.start_speed_hz;
        }
        motion
    }

    /// Whether the limit switch of a direction stops a move.
    pub(super) fn limit_is_active(&self, right: bool) -> bool {
        let input = if right { Input::LimitMax } else { Input::LimitMin };
        // With `switch` a limit does not stop the move before the return.
        let is_switch = match (&self.s.homing, &self.plan.controller.home) {
            (Some(homing), Some(Home { switch, .. })) => !homing.is_return() && *switch == input,
            _ => false,
        };
        self.level(input) && !is_switch
    }

    fn until_is_met(&self, motion: &Motion) -> bool {
        motion.until.is_some_and(|until| self.level(until.input) == until.level)
    }

    /// A move begins in c.
    pub(super) fn begin(&mut self, mut motion: Motion) {
        if motion.rem == 0 {
            motion.over = true;
        } else if self.limit_is_active(motion.right) {
            motion.at_limit = true;
            motion.over = true;
        } else if self.until_is_met(&motion) {
            motion.until_met = true;
            motion.over = true;
        } else {
            motion.waiting = true;
        }
        self.s.motion = Some(motion);
        self.waiting_move();
    }

    /// A waiting move begins in the cycle in which the memory is open.
    pub(super) fn waiting_move(&mut self) {
        if !self.s.motion.as_ref().is_some_and(|motion| motion.waiting) || !self.memory_is_open() {
            return;
        }
        let Some(motion) = &mut self.s.motion else { return };
        motion.waiting = false;
        motion.next = u128::from(self.now + 1) << 16;
        if motion.right != self.s.dir {
            let held = self.s.last_fall.map_or(0, |fall| fall + self.plan.h);
            self.s.dir_at = Some(held.max(self.now + 1));
        }
        self.decide();
    }

    /// The next step is decided.
    fn decide(&mut self) {
        let Some(motion) = self.s.motion.as_mut() else { return };
        let plan = &self.plan;
        motion.due = None;
        if motion.rem == 0 || (motion.braking && motion.height == 0) {
            return;
        }
        let table = plan.table(motion.level);
        let rate_interval = if let Some(intervals) = &mut motion.profile {
            u128::from(intervals.pop().unwrap_or_default())
        } else if motion.braking || motion.rem <= motion.height {
            let rate = table.rate_of_step(motion.height);
            motion.height -= 1;
            plan.interval(rate)
        } else if motion.height < motion.top && motion.rem >= motion.height + 2 {
            motion.height += 1;
            plan.interval(table.rate_of_step(motion.height))
        } else if motion.height == motion.top {
            plan.interval(motion.plateau_hz)
        } else {
            plan.interval(table.rate_of_step(motion.height + 1))
        };
        let first = std::mem::take(&mut motion.first_is_least);
        motion.next += if first { plan.least_interval() } else { rate_interval };
        motion.due = Some(rate_interval);
    }

    /// STEP falls, DIR changes, STEP rises.
    pub(super) fn engine(&mut self) {
        if self.s.fall_at == Some(self.now) {
            self.s.fall_at = None;
            self.s.step = false;
            self.s.last_fall = Some(self.now);
            if let Some(motion) = &mut self.s.motion
                && motion.due.is_none()
            {
                motion.over = true;
            }
        }
        if self.s.dir_at == Some(self.now) {
            self.s.dir_at = None;
            self.s.dir = !self.s.dir;
        }
        let due = self.s.motion.as_ref().and_then(Motion::due_cycle);
        if due == Some(self.now) {
            self.rise();
        }
    }

    fn rise(&mut self) {
        self.s.step = true;
        self.s.fall_at = Some(self.now + self.plan.w);
        self.s.position = self.s.position.wrapping_add(if self.s.dir { 1 } else { -1 });
        self.axis_follows();
        let beyond = self.plan.interval(self.plan.controller.start_speed_hz);
        if let Some(motion) = &mut self.s.motion {
            motion.rem -= 1;
            // Reading: the first step of a move costs trust in the cycle in which it rises.
            if motion.made.is_none() && motion.due.is_some_and(|interval| interval < beyond) {
                self.s.trust = 0;
            }
            motion.made = motion.due;
        }
        self.decide();
    }

    /// The due step does not rise, a high pulse continues, a pending change of DIR is dropped.
    pub(super) fn stop_at_once(&mut self) {
        self.s.dir_at = None;
        let step = self.s.step;
        if let Some(motion) = &mut self.s.motion {
            motion.due = None;
            motion.waiting = false;
            motion.over |= !step;
        }
    }

    /// The move starts to brake, if it does not brake yet.
    pub(super) fn brake(&mut self) {
        let Some(motion) = &mut self.s.motion else { return };
        // A `profile` does not brake.
        // Reading: not even while it waits for the memory.
        if motion.braking || motion.profile.is_some() {
            return;
        }
        motion.braking = true;
        if motion.height == 0 || motion.waiting {
            self.stop_at_once();
        }
    }

    /// Limits, while a step is due or the move waits.
    pub(super) fn limits(&mut self) {
        let Some(motion) = &self.s.motion else { return };
        if motion.is_heeding() && self.limit_is_active(motion.right) {
            if let Some(motion) = &mut self.s.motion {
                motion.at_limit = true;
            }
            self.stop_at_once();
        }
    }

    /// `until`, while a step is due or the move waits, and it does not brake yet.
    pub(super) fn until(&mut self) {
        let Some(motion) = &self.s.motion else { return };
        if motion.is_heeding() && !motion.braking && self.until_is_met(motion) {
            if let Some(motion) = &mut self.s.motion {
                motion.until_met = true;
            }
            self.brake();
        }
    }

    /// `start` in PAUSING: it stops braking, unless `until` was met before or is met now.
    pub(super) fn brakes_no_longer(&mut self) {
        let Some(motion) = &self.s.motion else { return };
        // Reading: "now" requires a due step; after a stop, `until` is checked again when the rest of the move begins.
        let now = motion.is_heeding() && self.until_is_met(motion);
        if let Some(motion) = &mut self.s.motion {
            // Reading: if it is met now, braking continues unchanged: the due step and u more.
            motion.until_met |= now;
            motion.braking &= motion.until_met;
        }
    }

    /// G2's trust, when a move ends or is cut.
    pub(super) fn jump_costs_trust(&mut self) {
        let beyond = self.plan.interval(self.plan.controller.start_speed_hz);
        // Reading: "cut" is any move that ESTOP or the loss of power drops, with STEP high or low.
        let made = self.s.motion.as_ref().and_then(|motion| motion.made);
        if made.is_some_and(|interval| interval < beyond) {
            self.s.trust = 0;
        }
    }

    /// A group or return that would end outside of the limits is not begun.
    pub(super) fn is_outside(&self, target: i128) -> bool {
        self.plan.controller.soft_limits.as_ref().is_some_and(|limits| {
            target < i128::from(limits.min_steps) || target > i128::from(limits.max_steps)
        })
    }

    /// To position 0 by G3 at `return.speed_hz`, `return.level`; `false`: it would end outside, which is an alarm.
    pub(super) fn begin_return(&mut self, order: Order) {
        let position = i128::from(self.s.position);
        // Reading: the return of homing, too, raises the alarm SOFT_LIMIT, not HOMING.
        if position != 0 && self.is_outside(0) {
            self.alarm(super::room::Alarm::SoftLimit);
            return;
        }
        let [rate_hz, level] = self.s.numbers.return_to_zero();
        let motion = self.ramped(order, position.abs(), position < 0, rate_hz, level);
        if order == Order::Return {
            self.s.state = State::Returning;
        }
        self.begin(motion);
    }
}
