//! What the steps themselves ask of a motor, where no plan is known: of a list of segments, of packets, of a recording.
//!
//! A staircase has no acceleration. What a rotor makes of it depends on the rotor: what comes and goes faster than it swings
//! in the field of its currents moves it little. So the steps are looked at through its natural period T, position being
//! straight from each step to the next:
//!
//! ```text
//! speed        = (x(t + h) - x(t - h))/(2*h)
//! acceleration = (x(t + h) - 2*x(t) + x(t - h))/h^2          h = T/2
//!
//! T = 2*pi*sqrt(J/(p*k*I))      rotor and load in the field of the regulated peak
//! ```
//!
//! These are the mean speed over T, and the mean speed of the half after t less that of the half before it. Both are straight
//! from one of the instants t_i - h, t_i, t_i + h of all steps i to the next, so at these the greatest acceleration is found
//! exactly. J*step/h^2 does not depend on J: with 16 microsteps, positions that are off by a step ask for at most
//! 4*(pi/2)/(16*pi^2) of the motor's torque, 4 %, whatever the load; and a start by a hundred steps within h asks for all of
//! it. So the window makes no shortage of jitter, and hides none.
//!
//! A jump of speed is taken within T here, which is about what a rotor does; its start-stop rate says more.
//!
//! ```
//! use stepscope_inspect::motion::torque::{Demand, Machine};
//! use stepscope_motion::{motor::Motor, moves::Axis};
//! use stepscope_peripheral::trace::Step;
//!
//! let axis = Axis { motor: Some(Motor::default()), ..Axis::default() };
//! let machine = Machine::of(&axis).expect("it has a motor");
//! // 1000 steps/s at once, and 60 000.
//! let asked = |interval: u64| {
//!     let steps = (1..1000).map(|k: i32| Step { cycle: k.unsigned_abs() as u64 * interval, position: k });
//!     Demand::of_steps(&machine, &steps.collect::<Vec<_>>(), 16_000_000)
//! };
//! assert!(asked(16_000).is_met());
//! assert!(!asked(266).is_met());
//! ```

use super::{Demand, MAX_SHORTAGES, Machine, Moment, Shortage};
use alloc::vec::Vec;
use stepscope_peripheral::trace::Step;

impl Demand {
    /// What the steps of a channel, in cycles of `clock_hz`, ask of `machine`. Times are those of the steps, from cycle 0;
    /// the jump is the greatest rate that is taken up, or left, beside a rest or a turn.
    #[must_use]
    pub fn of_steps(machine: &Machine, steps: &[Step], clock_hz: u32) -> Self {
        let mut looked = Looked {
            demand: Self {
                shortages: Vec::new(),
                total: 0,
                least: None,
                greatest_rate: 0.0,
                over_working_rate: None,
                jump: jump(machine, steps, clock_hz),
            },
            last: None,
            open: None,
        };
        moments(machine, steps, clock_hz, &mut |moment| looked.take(moment));
        looked.close();
        let Looked { mut demand, .. } = looked;
        let rate = demand.greatest_rate;
        demand.over_working_rate = machine.working_rate().filter(|most| rate > *most).map(|_| rate);
        demand
    }
}

/// The most torque in mN*m that steps need at each rate, as [`needed_over_rate`](super::needed_over_rate) has it of a plan.
#[must_use]
pub fn steps_needed_over_rate(
    machine: &Machine,
    steps: &[Step],
    clock_hz: u32,
    most_rate: f64,
    bins: usize,
) -> Vec<f64> {
    let mut needed = alloc::vec![f64::NAN; bins];
    moments(machine, steps, clock_hz, &mut |moment| {
        // At rest there is nothing to need.
        let moves = moment.rate > 0.0 || moment.needed_mn_m != 0.0;
        let bin = (moment.rate / most_rate * bins as f64) as usize;
        if let Some(most) = needed.get_mut(bin).filter(|_| moves) {
            *most = libm::fmax(*most, libm::fabs(moment.needed_mn_m));
        }
    });
    needed
}

/// Every instant at which the acceleration of the steps bends, in order.
fn moments(machine: &Machine, steps: &[Step], clock_hz: u32, each: &mut impl FnMut(Moment)) {
    let hz = f64::from(clock_hz);
    let half_s = machine.natural_period_s() / 2.0;
    let seconds = |index: usize| steps.get(index).map(|step| step.cycle as f64 / hz);
    let mut positions = [half_s, 0.0, -half_s].map(|ahead_s| (ahead_s, Position { steps, hz, next: 0 }));
    let mut next = [0; 3];
    let mut before = f64::NEG_INFINITY;
    loop {
        // Of the three lists t_i - h, t_i, t_i + h the one whose turn it is.
        let mut first: Option<(usize, f64)> = None;
        for (list, index) in next.iter().enumerate() {
            let ahead_s = positions.get(list).map_or(0.0, |(ahead_s, _)| *ahead_s);
            if let Some(at_s) = seconds(*index).map(|at_s| at_s - ahead_s)
                && first.is_none_or(|(_, least)| at_s < least)
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

/// The position over times that never go back, straight from step to step.
#[derive(Clone, Copy)]
struct Position<'a> {
    steps: &'a [Step],
    hz: f64,
    /// The first step after the last time.
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
            // Before the first step it stands where that leads: how long it took to get there is not known.
            (at, None) | (None, at) => at.map_or(0.0, |step| f64::from(step.position)),
        }
    }
}

/// The greatest rate that is taken up or left at once: beside a turn, a rest, or the end.
///
/// It is that of the next step, or of the next half a full step, whichever is lower: less than that moves the rotor little,
/// however fast it comes. A rest is an interval of more than a natural period, or one in which half a full step, and four
/// steps, would have come at that rate: a late step is none.
fn jump(machine: &Machine, steps: &[Step], clock_hz: u32) -> f64 {
    let swing_s = machine.natural_period_s();
    let half = machine.microsteps_of_half_a_step();
    let rest = half.max(4) as f64;
    let mut greatest = 0.0;
    for at in 0..steps.len() {
        let side = |next, end| Side::of(steps, at, [next, end], f64::from(clock_hz));
        let before = side(at.checked_sub(1), at.checked_sub(half));
        let after = side(at.checked_add(1), at.checked_add(half));
        let turns = before.direction * after.direction < 0.0;
        for (leaves, takes) in [(&before, &after), (&after, &before)] {
            let rests = leaves.interval_s > swing_s || leaves.interval_s * takes.rate > rest;
            if turns || rests {
                greatest = libm::fmax(greatest, takes.rate);
            }
        }
    }
    greatest
}

/// What stands on one side of a step.
struct Side {
    /// To the next step; without end where there is none.
    interval_s: f64,
    /// Direction in which time goes by; 0 where there is none.
    direction: f64,
    /// Of the next step, or of the next half a full step, whichever is lower, in steps/s; 0 where there is not as much.
    rate: f64,
}

impl Side {
    /// Beside the step `at`: the next one, and the last one of half a full step.
    fn of(steps: &[Step], at: usize, ends: [Option<usize>; 2], hz: f64) -> Self {
        let span = |to: Option<usize>| {
            let (from, to) = (steps.get(at)?, steps.get(to?)?);
            let way = f64::from(to.position.wrapping_sub(from.position));
            Some((to.cycle.abs_diff(from.cycle) as f64 / hz, if to.cycle < from.cycle { -way } else { way }))
        };
        let [next, all] = ends.map(span);
        let rate = |span: Option<(f64, f64)>| {
            span.map_or(0.0, |(time_s, way)| libm::fabs(way) / libm::fmax(time_s, 1.0 / hz))
        };
        let (interval_s, direction) = next.unwrap_or((f64::INFINITY, 0.0));
        Self { interval_s, direction, rate: libm::fmin(rate(next), rate(all)) }
    }
}

/// Moments one after the other.
struct Looked {
    demand: Demand,
    last: Option<Moment>,
    /// The shortage that has not ended yet.
    open: Option<Shortage>,
}

impl Looked {
    fn take(&mut self, moment: Moment) {
        let margin = moment.margin_mn_m();
        self.demand.greatest_rate = libm::fmax(self.demand.greatest_rate, moment.rate);
        if self.demand.least.is_none_or(|least| margin < least.margin_mn_m()) {
            self.demand.least = Some(moment);
        }
        // Where the margin is 0 on the straight line from the moment before.
        let border_s = || match self.last {
            Some(last) => {
                let before = last.margin_mn_m();
                last.at_s + (moment.at_s - last.at_s) * before / (before - margin)
            }
            None => moment.at_s,
        };
        match (&mut self.open, margin < 0.0) {
            (None, false) => {}
            (None, true) => {
                self.open =
                    Some(Shortage { from_s: border_s(), to_s: moment.at_s, times: 1.0, worst: moment });
            }
            (Some(open), true) => {
                open.to_s = moment.at_s;
                if margin < open.worst.margin_mn_m() {
                    open.worst = moment;
                }
            }
            (Some(open), false) => {
                open.to_s = border_s();
                self.close();
            }
        }
        self.last = Some(moment);
    }

    fn close(&mut self) {
        let Some(shortage) = self.open.take() else { return };
        self.demand.total += 1;
        if self.demand.shortages.len() < MAX_SHORTAGES {
            self.demand.shortages.push(shortage);
        }
    }
}
