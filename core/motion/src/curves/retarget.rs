//! The fastest change to another speed or position from any state of motion.
//!
//! ```text
//! q = a^2/(2J) |    .----.         up from (v, a) to (w, 0); the mirror image goes down
//!              |   /      \        jerk J, constant acceleration and jerk -J have the slopes 1, 0 and -1
//!              |  /        \       q <= D^2/(2J) while v < 0, A^2/(2J) while v > 0
//!              +-v----------w--- speed
//! ```
//!
//! A position is reached by a push and a stop. The push is the fastest change to full speed toward the target. During the
//! push, the position where a stop would end moves toward the target, so a stop at exactly one time ends at the target.

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

/// An increase of the speed.
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

    /// Follows the largest q up to `cap` that falls to 0 at speed `end`, up to speed `until`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::{
        Xoshiro256PlusPlus,
        rand_core::{Rng, SeedableRng},
    };

    /// The largest q at speed `v` of a change up from (v0, q0) to w: with slopes between -1 and 1, and within both caps
    /// unless it begins above them.
    fn largest_q(limits: &MoveLimits, (v0, q0): (f64, f64), w: f64, v: f64) -> f64 {
        let [rising, falling] =
            [limits.acceleration, limits.deceleration].map(|limit| limit * limit / (2.0 * limits.jerk));
        let caps = if v < 0.0 { (falling, rising - v) } else { (rising, falling + v) };
        let bounds = [q0 + (v - v0), w - v, caps.0, caps.1];
        bounds.into_iter().fold(f64::INFINITY, f64::min).max(q0 - (v - v0))
    }

    #[test]
    fn a_change_of_speed_always_has_the_largest_acceleration() {
        let mut noise = Xoshiro256PlusPlus::seed_from_u64(3);
        let mut draw =
            |from: f64, to: f64| from + (to - from) * (noise.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        for round in 0..3000 {
            let [acceleration, deceleration] = [draw(1000.0, 20_000.0), draw(1000.0, 20_000.0)];
            let jerk = draw(1e4, 1e6);
            let limits = MoveLimits { speed: 5000.0, acceleration, deceleration, jerk };
            let (speed, target) = (draw(-4000.0, 4000.0), draw(-4000.0, 4000.0));
            let limit = acceleration.min(deceleration);
            let from = State { position: 7.5, speed, acceleration: draw(-limit, limit) };
            let reached = speed + from.acceleration * from.acceleration.abs() / (2.0 * jerk);
            let sign = if target < reached { -1.0 } else { 1.0 };
            let phases = to_speed(&limits, from, target);
            // An acceleration the other way first falls to 0.
            let other_s = if sign * from.acceleration < 0.0 { from.acceleration.abs() / jerk } else { 0.0 };
            let turned = phases.state(other_s);
            let (v0, q0) = (sign * turned.speed, turned.acceleration * turned.acceleration / (2.0 * jerk));
            let mut before = 0.0;
            for part in 1..=200 {
                let t = other_s + (phases.duration_s() - other_s) * f64::from(part) / 200.0;
                let State { speed, acceleration, .. } = phases.state(t);
                let q = acceleration * acceleration / (2.0 * jerk);
                let expected = largest_q(&limits, (v0, q0), sign * target, sign * speed);
                assert!((q - expected).abs() < 1e-4, "{round}: {q} at {speed}, expected {expected}");
                assert!(
                    sign * acceleration >= -1e-6 * limit && sign * (speed - before) >= -1e-6 || part == 1
                );
                before = speed;
            }
            let end = phases.end();
            assert!(
                (end.speed - target).abs() < 1e-6 && end.acceleration.abs() < 1e-6 * limit,
                "{round}: {end:?}"
            );
        }
    }

    #[test]
    fn a_position_is_reached_at_rest_and_mirrored_targets_take_as_long() {
        let mut noise = Xoshiro256PlusPlus::seed_from_u64(4);
        let mut draw =
            |from: f64, to: f64| from + (to - from) * (noise.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        for round in 0..1000 {
            let limits = MoveLimits {
                speed: draw(500.0, 4000.0),
                acceleration: draw(1000.0, 20_000.0),
                deceleration: draw(1000.0, 20_000.0),
                jerk: if round % 5 == 0 { f64::INFINITY } else { draw(1e4, 1e6) },
            };
            let from =
                State { position: 0.25, speed: draw(-500.0, 500.0), acceleration: draw(-1000.0, 1000.0) };
            let target = draw(-2000.0, 2000.0);
            let phases = to_position(&limits, from, target);
            assert_eq!(
                phases.end(),
                State { position: target, speed: 0.0, acceleration: phases.end().acceleration }
            );
            let mirrored =
                State { position: -from.position, speed: -from.speed, acceleration: -from.acceleration };
            let other_s = to_position(&limits, mirrored, -target).duration_s();
            assert!(
                (phases.duration_s() - other_s).abs() < 1e-9,
                "{round}: {} {other_s}",
                phases.duration_s()
            );
            // The curve is continuous, keeps the maximum speed, and passes no phase twice.
            let mut before = from.position;
            for part in 1..=500 {
                let dt = phases.duration_s() / 500.0;
                let State { position, speed, .. } = phases.state(dt * f64::from(part));
                assert!(speed.abs() <= limits.speed * (1.0 + 1e-9), "{round}: {speed}");
                assert!(
                    (position - before).abs() <= limits.speed * dt + 1e-6,
                    "{round}: {before} {position}"
                );
                before = position;
            }
        }
    }

    #[test]
    fn without_a_limit_of_the_jerk_the_speed_falls_by_the_deceleration_and_rises_by_the_acceleration() {
        let limits =
            MoveLimits { speed: 4000.0, acceleration: 1000.0, deceleration: 2000.0, jerk: f64::INFINITY };
        // Speed and target; duration and travel.
        let rows = [
            (500.0, -300.0, 0.25 + 0.3, 62.5 - 45.0),
            (-500.0, 300.0, 0.25 + 0.3, 45.0 - 62.5),
            (500.0, 800.0, 0.3, 195.0),
            (-800.0, -500.0, 0.15, -97.5),
            (500.0, 0.0, 0.25, 62.5),
            (0.0, -500.0, 0.5, -125.0),
            (500.0, 500.0, 0.0, 0.0),
        ];
        for (speed, target, duration_s, travel) in rows {
            let from = State { position: 10.0, speed, acceleration: 123.0 };
            let phases = to_speed(&limits, from, target);
            let found = (phases.duration_s(), phases.end().position - 10.0, phases.end().speed);
            let expected = (duration_s, travel, target);
            let off = [found.0 - expected.0, found.1 - expected.1, found.2 - expected.2];
            assert!(off.iter().all(|off| off.abs() < 1e-9), "{speed} to {target}: {found:?}, {expected:?}");
        }
    }
}
