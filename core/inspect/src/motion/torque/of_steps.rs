//! Torque that steps without a plan require: segments, packets, recordings.
//!
//! Steps have no acceleration of their own. A rotor hardly follows changes faster than its natural period T, so
//! positions, linear from step to step, are smoothed over T:
//!
//! ```text
//! speed        = (x(t + h) - x(t - h))/(2*h)
//! acceleration = (x(t + h) - 2*x(t) + x(t - h))/h^2          h = T/2
//!
//! T = 2*pi*sqrt(J/(p*k*I))      rotor and load in the field of the regulated peak
//! ```
//!
//! Both are linear between the times t_i - h, t_i and t_i + h of all steps, so the maximum acceleration is exact. With 16
//! microsteps a position error of one step requires at most 4 % of the motor's torque for any load, so jitter causes no
//! shortage.

use super::{Demand, Machine, Moment, Shortages};
use alloc::vec::Vec;
use stepscope_peripheral::trace::Step;

impl Demand {
    /// The demand of steps in cycles of `clock_hz`. The jump is the maximum rate next to a stop or reversal.
    pub fn of_steps(machine: &Machine, steps: &[Step], clock_hz: u32) -> Self {
        let mut found = Shortages::new(0.0, jump(machine, steps, clock_hz));
        let mut last: Option<Moment> = None;
        moments(machine, steps, clock_hz, &mut |moment| {
            found.demand.max_rate = libm::fmax(found.demand.max_rate, moment.rate);
            // The margin is linear between moments.
            found.add(moment, moment.at_s, 1.0, || match last {
                Some(last) => {
                    let before = last.margin_mn_m();
                    last.at_s + (moment.at_s - last.at_s) * before / (before - moment.margin_mn_m())
                }
                None => moment.at_s,
            });
            last = Some(moment);
        });
        found.finish(machine)
    }
}

/// As [`needed_over_rate`](super::needed_over_rate), for steps.
pub fn steps_needed_over_rate(
    machine: &Machine,
    steps: &[Step],
    clock_hz: u32,
    max_rate: f64,
    bins: usize,
) -> Vec<f64> {
    let mut needed = alloc::vec![f64::NAN; bins];
    moments(machine, steps, clock_hz, &mut |moment| {
        let is_moving = moment.rate > 0.0 || moment.needed_mn_m != 0.0;
        let bin = (moment.rate / max_rate * bins as f64) as usize;
        if let Some(max) = needed.get_mut(bin).filter(|_| is_moving) {
            *max = libm::fmax(*max, libm::fabs(moment.needed_mn_m));
        }
    });
    needed
}

/// Calls `each` at every time at which the slope of the acceleration changes, in order.
fn moments(machine: &Machine, steps: &[Step], clock_hz: u32, each: &mut impl FnMut(Moment)) {
    let hz = f64::from(clock_hz);
    let half_s = machine.natural_period_s() / 2.0;
    let seconds = |index: usize| steps.get(index).map(|step| step.cycle as f64 / hz);
    let mut positions = [half_s, 0.0, -half_s].map(|ahead_s| (ahead_s, Position { steps, hz, next: 0 }));
    let mut next = [0; 3];
    let mut before = f64::NEG_INFINITY;
    loop {
        let mut first: Option<(usize, f64)> = None;
        for (list, index) in next.iter().enumerate() {
            let ahead_s = positions.get(list).map_or(0.0, |(ahead_s, _)| *ahead_s);
            if let Some(at_s) = seconds(*index).map(|at_s| at_s - ahead_s)
                && first.is_none_or(|(_, min)| at_s < min)
            {
                first = Some((list, at_s));
            }
        }
        let Some((list, at_s)) = first else { return };
        if let Some(index) = next.get_mut(list) {
            *index += 1;
        }
        if at_s <= before {
            continue;
        }
        before = at_s;
        let [after, here, earlier] = positions.each_mut().map(|(ahead_s, x)| x.at(at_s + *ahead_s));
        let speed = (after - earlier) / (2.0 * half_s);
        let acceleration = (after - 2.0 * here + earlier) / (half_s * half_s);
        each(machine.moment(at_s, speed, acceleration));
    }
}

#[derive(Clone, Copy)]
struct Position<'a> {
    steps: &'a [Step],
    hz: f64,
    next: usize,
}

impl Position<'_> {
    fn at(&mut self, at_s: f64) -> f64 {
        let seconds = |step: &Step| step.cycle as f64 / self.hz;
        while self.steps.get(self.next).is_some_and(|step| seconds(step) <= at_s) {
            self.next += 1;
        }
        let before = self.next.checked_sub(1).and_then(|last| self.steps.get(last));
        match (before, self.steps.get(self.next)) {
            (Some(from), Some(to)) => {
                let part = (at_s - seconds(from)) / (seconds(to) - seconds(from));
                f64::from(from.position) + part * f64::from(to.position.wrapping_sub(from.position))
            }
            // Before the first step the position is that step's target, because its time is unknown.
            (at, None) | (None, at) => at.map_or(0.0, |step| f64::from(step.position)),
        }
    }
}

/// The maximum rate next to a reversal, a stop, or an end: that of the next step or of the next half full step,
/// whichever is lower, because shorter travel hardly moves the rotor. A stop is an interval longer than the natural
/// period, or than half a full step (at least four steps) takes at that rate.
fn jump(machine: &Machine, steps: &[Step], clock_hz: u32) -> f64 {
    let period_s = machine.natural_period_s();
    let half = machine.microsteps_of_half_a_step();
    let stop_steps = half.max(4) as f64;
    let mut max_jump = 0.0;
    for at in 0..steps.len() {
        let side = |next, end| Side::of(steps, at, [next, end], f64::from(clock_hz));
        let before = side(at.checked_sub(1), at.checked_sub(half));
        let after = side(at.checked_add(1), at.checked_add(half));
        let is_reversal = before.direction * after.direction < 0.0;
        for (idle, moving) in [(&before, &after), (&after, &before)] {
            let is_stop = idle.interval_s > period_s || idle.interval_s * moving.rate > stop_steps;
            if is_reversal || is_stop {
                max_jump = libm::fmax(max_jump, moving.rate);
            }
        }
    }
    max_jump
}

struct Side {
    /// To the next step; infinite where there is none.
    interval_s: f64,
    direction: f64,
    rate: f64,
}

impl Side {
    fn of(steps: &[Step], at: usize, ends: [Option<usize>; 2], hz: f64) -> Self {
        let span = |to: Option<usize>| {
            let (from, to) = (steps.get(at)?, steps.get(to?)?);
            let travel = f64::from(to.position.wrapping_sub(from.position));
            Some((
                to.cycle.abs_diff(from.cycle) as f64 / hz,
                if to.cycle < from.cycle { -travel } else { travel },
            ))
        };
        let [next, half_step] = ends.map(span);
        let rate = |span: Option<(f64, f64)>| {
            span.map_or(0.0, |(time_s, travel)| libm::fabs(travel) / libm::fmax(time_s, 1.0 / hz))
        };
        let (interval_s, direction) = next.unwrap_or((f64::INFINITY, 0.0));
        Self { interval_s, direction, rate: libm::fmin(rate(next), rate(half_step)) }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn recorded_steps_have_a_demand() {
        use crate::motion::torque::{Demand, Machine};
        use stepscope_motion::{motor::Motor, moves::Axis};
        use stepscope_peripheral::trace::Step;

        let axis = Axis { motor: Some(Motor::default()), ..Axis::default() };
        let machine = Machine::of(&axis).expect("it has a motor");
        // 1000 steps/s at once, and 60 000.
        let demand = |interval: u64| {
            let steps =
                (1..1000).map(|k: i32| Step { cycle: k.unsigned_abs() as u64 * interval, position: k });
            Demand::of_steps(&machine, &steps.collect::<Vec<_>>(), 16_000_000)
        };
        assert!(demand(16_000).is_met());
        assert!(!demand(266).is_met());
    }
}
