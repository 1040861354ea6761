//! The fastest change to another speed or position from any state of motion.
//!
//! ```text
//! q = a^2/(2J) |    .----.         up from (v, a) to (w, 0); the mirror image goes down
//!              |   /      \        jerk J, constant acceleration and jerk -J have the slopes 1, 0 and -1
//!              |  /        \       q <= D^2/(2J) while v < 0, A^2/(2J) while v > 0
//!              +-v----------w--- speed
//! ```
//!
//! A position is reached by a push and a stop: the push is the fastest change to full speed toward the target. While it
//! lasts, the end of the stop only moves toward the target, so one instant to stop is right.

use crate::bisection::border;
use crate::curves::between_speeds::MoveLimits;
use crate::curves::curve::{greater, lesser};
use crate::curves::phases::{Phase, Phases, State};
use crate::square_root;
use alloc::vec::Vec;

/// Distance in steps below which a stop ends on its target.
const SAME_POSITION: f64 = 1e-9;

/// The fastest change from a state to a speed, at which the acceleration is 0.
pub(crate) fn to_speed(limits: &MoveLimits, from: State, speed: f64) -> Phases {
    Phases::new(from.position, from.speed, change(limits, from, speed))
}

/// The fastest move from a state to rest at a position; it may overshoot and reverse.
pub(crate) fn to_position(limits: &MoveLimits, from: State, position: f64) -> Phases {
    let stop = to_speed(limits, from, 0.0);
    let end = stop.end().position;
    if libm::fabs(end - position) <= SAME_POSITION {
        return stop.ending_at(position, 0.0);
    }
    let sign = if position < end { -1.0 } else { 1.0 };
    let push = to_speed(limits, from, sign * limits.speed);
    let stop_from = |state: State| to_speed(limits, state, 0.0).end().position;
    let is_before = |at_s: f64| sign * (position - stop_from(push.state(at_s))) > 0.0;
    let stop_s = if is_before(push.duration_s()) {
        push.duration_s() + (position - stop_from(push.end())) / push.end().speed
    } else {
        border(0.0, push.duration_s(), is_before).1
    };
    let mut phases = push.until(stop_s);
    phases.extend(change(limits, phases.end(), 0.0));
    phases.ending_at(position, 0.0)
}

fn change(limits: &MoveLimits, from: State, to: f64) -> Vec<Phase> {
    let State { speed, acceleration, .. } = from;
    if limits.jerk == f64::INFINITY {
        return with_jumps(limits, speed, to).into();
    }
    // The speed at which the acceleration would reach 0 if it fell immediately.
    let reached = speed + acceleration * libm::fabs(acceleration) / (2.0 * limits.jerk);
    if to < reached {
        let mirrored = Climb::new(limits, -speed, -acceleration).to(limits, -to);
        mirrored.into_iter().map(Phase::mirrored).collect()
    } else {
        Climb::new(limits, speed, acceleration).to(limits, to)
    }
}

/// With jumps of the acceleration: the deceleration holds toward 0, the acceleration away from it.
fn with_jumps(limits: &MoveLimits, speed: f64, to: f64) -> [Phase; 2] {
    let middle = if speed * to < 0.0 {
        0.0
    } else if libm::fabs(to) < libm::fabs(speed) {
        to
    } else {
        speed
    };
    let phase = |from: f64, to: f64, limit: f64| Phase {
        time_s: libm::fabs(to - from) / limit,
        acceleration: if to < from { -limit } else { limit },
        jerk: 0.0,
    };
    [phase(speed, middle, limits.deceleration), phase(middle, to, limits.acceleration)]
}

/// A change of speed that goes up.
struct Climb {
    jerk: f64,
    speed: f64,
    /// a^2/(2J), in steps/s.
    q: f64,
    acceleration: f64,
    phases: Vec<Phase>,
}

impl Climb {
    fn new(limits: &MoveLimits, speed: f64, acceleration: f64) -> Self {
        let jerk = limits.jerk;
        let mut climb = Self { jerk, speed, q: 0.0, acceleration: 0.0, phases: Vec::new() };
        if acceleration < 0.0 {
            let time_s = -acceleration / jerk;
            climb.phases.push(Phase { time_s, acceleration, jerk });
            climb.speed += acceleration / 2.0 * time_s;
        } else {
            climb.acceleration = acceleration;
            climb.q = climb.q_of(acceleration);
        }
        climb
    }

    fn q_of(&self, acceleration: f64) -> f64 {
        acceleration * acceleration / (2.0 * self.jerk)
    }

    fn to(mut self, limits: &MoveLimits, to: f64) -> Vec<Phase> {
        let (falling, rising) = (self.q_of(limits.deceleration), self.q_of(limits.acceleration));
        if self.speed < 0.0 {
            // Beyond 0 the other limit holds, so q is within it there.
            self.within(falling, lesser(to, rising), lesser(to, 0.0));
        }
        if self.speed < to || self.q > 0.0 {
            self.within(rising, to, to);
        }
        self.phases
    }

    /// Follows the largest q up to `cap` that falls to 0 at speed `end`, as far as speed `until`.
    fn within(&mut self, cap: f64, end: f64, until: f64) {
        if self.q > cap {
            self.follow(-1.0, self.speed + self.q - cap, until);
        }
        let top = lesser(cap, (self.q + end - self.speed) / 2.0);
        if top > self.q {
            self.follow(1.0, self.speed + top - self.q, until);
        }
        if end - self.q > self.speed {
            self.follow(0.0, end - self.q, until);
        }
        if end == until {
            // The last phase ends without acceleration, whatever the roundings before it.
            let time_s = self.acceleration / self.jerk;
            self.phases.push(Phase { time_s, acceleration: self.acceleration, jerk: -self.jerk });
            (self.speed, self.q, self.acceleration) = (until, 0.0, 0.0);
        } else {
            self.follow(-1.0, until, until);
        }
    }

    /// Follows a line of q to a speed, at most to `until`.
    fn follow(&mut self, slope: f64, to: f64, until: f64) {
        let to = lesser(to, until);
        let change = to - self.speed;
        if change <= 0.0 {
            return;
        }
        let q = greater(0.0, self.q + slope * change);
        let acceleration = if slope == 0.0 { self.acceleration } else { square_root(2.0 * self.jerk * q) };
        let time_s = 2.0 * change / (self.acceleration + acceleration);
        self.phases.push(Phase { time_s, acceleration: self.acceleration, jerk: slope * self.jerk });
        (self.speed, self.q, self.acceleration) = (to, q, acceleration);
    }
}
