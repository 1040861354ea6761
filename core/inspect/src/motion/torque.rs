//! Torque over step rate: can a motor follow a plan (Song, Han, Lu 2021, 1.1 and 2.3; DESIGN B4)?
//!
//! The phasor model of a two-phase hybrid motor on a current-regulated bipolar driver (P. Acarnley, *Stepping Motors:
//! a guide to theory and practice*): fundamentals only, without saturation, detent torque, iron losses or resonance.
//! With p = 90/full_step_deg pole pairs, at w rad/s:
//!
//! ```text
//! k = holding torque/(sqrt(2)*rated current)      N*m/A, and V*s/rad; both phases energized hold sqrt(2)*k*I
//! E = k*w,  X = p*w*L                             back-EMF and reactance of a phase, amplitudes
//! i = (V - E)/(R + j*X),  torque = k*Re(i)        the current, E being real
//! ```
//!
//! Available is the maximum torque of all currents with |i| <= the regulated peak and |V| <= the supply: two discs in the
//! plane of i. It is negative if all of these brake.
//!
//! ```text
//! torque |--------.               up to the corner the driver holds the current: k*I
//!        |         \ corner
//!        |          `-.           above it the voltage limits: Acarnley's pull-out torque
//!        |             `--.___    k*V/|Z| - k^2*w*R/|Z|^2, where that current is under I
//!        +--------------------    rate
//! ```
//!
//! Needed is inertia times acceleration plus the load's torque, which opposes the motion. Braking is compared with
//! the same curve, which is on the safe side. Jumps of speed have no finite torque; [`Demand::jump`] reports them.
//!
//! ```
//! use stepscope_inspect::motion::torque::{Demand, Machine};
//! use stepscope_motion::{motor::Motor, moves::Axis, plan_axis};
//!
//! let axis = Axis { motor: Some(Motor::default()), ..Axis::default() }; // one turn in 0.4 s
//! let machine = Machine::of(&axis).expect("it has a motor");
//! let demand = Demand::of(&machine, &plan_axis(&axis, "x").expect("it can be planned"));
//! assert!(demand.is_met() && demand.min_margin.expect("it takes time").margin_mn_m() > 100.0);
//! ```

mod machine;
mod moment;
mod of_steps;
mod ramps;
mod report;

pub use machine::Machine;
pub use moment::Moment;
pub use of_steps::steps_needed_over_rate;
pub use ramps::Ramps;
pub use report::{MoveRamps, TorqueCurve, TorqueReport};

use alloc::{format, string::String, vec::Vec};
use serde::Serialize;
use stepscope_motion::{AxisPlan, Breakpoints, Interval, bisection::border, grouped};

const MAX_SHORTAGES: usize = 1024;
const SAMPLES_PER_MOVE: u32 = 2048;
/// Samples per plan, in addition to both sides of each breakpoint.
const SAMPLES: f64 = 512.0;

/// A time in which a plan needs more torque than is available.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shortage {
    pub from_s: f64,
    pub to_s: f64,
    /// Number of periods of a sine in which it recurs; otherwise 1.
    pub times: f64,
    pub worst: Moment,
}

/// The torque and rate that a plan or a list of steps requires.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Demand {
    pub shortages: Vec<Shortage>,
    /// Also those that are not listed.
    pub shortage_count: u64,
    /// The moment with the minimum margin; `None` if the plan takes no time.
    pub min_margin: Option<Moment>,
    pub max_rate: f64,
    /// The maximum rate, if it exceeds the motor's working rate.
    pub over_working_rate: Option<f64>,
    /// The maximum jump of speed in steps/s.
    pub jump: f64,
}

impl Demand {
    pub fn of(machine: &Machine, plan: &AxisPlan) -> Self {
        let peaks = plan.peaks();
        let mut found = Shortages::new(peaks.speed, peaks.jump);
        let step_s = plan.duration_s() / SAMPLES;
        let mut before: Option<Interval> = None;
        Breakpoints::of(plan).intervals(0.0, plan.duration_s(), &mut |interval| {
            if !before.is_some_and(|before| before.to_s == interval.from_s && before.times == interval.times)
            {
                found.close();
            }
            before = Some(interval);
            sample(&mut found, machine, plan, interval, step_s);
        });
        found.finish(machine)
    }

    /// The problem of the move from `from_s` to `to_s` with `peak_rate` steps/s, and its fix; `None` without one.
    pub fn warning(&self, machine: &Machine, from_s: f64, to_s: f64, peak_rate: f64) -> Option<String> {
        if let Some(max) = machine.working_rate().filter(|max| peak_rate > *max) {
            return Some(format!(
                "{} steps/s exceed the motor's working rate of {}; use more time or shorter ramps",
                grouped(peak_rate),
                grouped(max)
            ));
        }
        let inside = self.shortages.iter().filter(|found| found.from_s < to_s && found.to_s > from_s);
        let worst = inside
            .map(|found| found.worst)
            .reduce(|worst, other| if other.margin_mn_m() < worst.margin_mn_m() { other } else { worst })?;
        Some(format!(
            "too little torque: {:.1} mN*m needed of {:.1} at {:.4} s and {} steps/s; use more time, longer ramps, less load or a higher supply voltage",
            libm::fabs(worst.needed_mn_m),
            worst.available_mn_m,
            worst.at_s,
            grouped(worst.rate)
        ))
    }

    /// Whether the motor can follow, except for jumps.
    pub fn is_met(&self) -> bool {
        self.shortage_count == 0 && self.over_working_rate.is_none()
    }
}

/// Maximum torque in mN*m that a plan needs in each of `bins` ranges of the rate; NaN for unused rates.
pub fn needed_over_rate(machine: &Machine, plan: &AxisPlan, max_rate: f64, bins: usize) -> Vec<f64> {
    let mut needed = alloc::vec![f64::NAN; bins];
    for planned in plan.moves() {
        let part_s = planned.profile.duration_s() / f64::from(SAMPLES_PER_MOVE);
        for sample in 0..SAMPLES_PER_MOVE {
            let moment = machine.at(plan, planned.start_s + (f64::from(sample) + 0.5) * part_s);
            if let Some(max) = needed.get_mut((moment.rate / max_rate * bins as f64) as usize) {
                *max = libm::fmax(*max, libm::fabs(moment.needed_mn_m));
            }
        }
    }
    needed
}

/// Collects shortages from moments in order.
struct Shortages {
    demand: Demand,
    open: Option<Shortage>,
}

impl Shortages {
    fn new(max_rate: f64, jump: f64) -> Self {
        Self { demand: Demand { max_rate, jump, ..Demand::default() }, open: None }
    }

    /// Adds a moment whose interval ends at `to_s`. `border_s` returns the time after the previous moment at which the
    /// margin changed its sign.
    fn add(&mut self, moment: Moment, to_s: f64, times: f64, border_s: impl FnOnce() -> f64) {
        let margin = moment.margin_mn_m();
        if self.demand.min_margin.is_none_or(|min| margin < min.margin_mn_m()) {
            self.demand.min_margin = Some(moment);
        }
        match (&mut self.open, margin < 0.0) {
            (None, false) => {}
            (None, true) => {
                self.open = Some(Shortage { from_s: border_s(), to_s, times, worst: moment });
            }
            (Some(open), true) => {
                open.to_s = to_s;
                if margin < open.worst.margin_mn_m() {
                    open.worst = moment;
                }
            }
            (Some(open), false) => {
                open.to_s = border_s();
                self.close();
            }
        }
    }

    fn close(&mut self) {
        let Some(shortage) = self.open.take() else { return };
        self.demand.shortage_count += 1;
        if self.demand.shortages.len() < MAX_SHORTAGES {
            self.demand.shortages.push(shortage);
        }
    }

    fn finish(mut self, machine: &Machine) -> Demand {
        self.close();
        let rate = self.demand.max_rate;
        self.demand.over_working_rate = machine.working_rate().filter(|max| rate > *max).map(|_| rate);
        self.demand
    }
}

/// Adds the moments of a smooth interval of a plan.
fn sample(found: &mut Shortages, machine: &Machine, plan: &AxisPlan, interval: Interval, step_s: f64) {
    let Interval { from_s, to_s, times, .. } = interval;
    let length = to_s - from_s;
    // Just inside: at a breakpoint itself the value may be that of the other side.
    let inset = length * 1e-9;
    let parts = libm::fmax(1.0, libm::ceil(length / step_s)) as u32;
    let mut last_s = None;
    for part in 0..=parts {
        let at_s = if part == 0 {
            from_s + inset
        } else if part == parts {
            to_s - inset
        } else {
            from_s + length * f64::from(part) / f64::from(parts)
        };
        found.add(machine.at(plan, at_s), to_s, times, || {
            last_s.map_or(from_s, |last_s| sign_change(machine, plan, last_s, at_s))
        });
        last_s = Some(at_s);
    }
}

/// The time at which the margin changes its sign.
fn sign_change(machine: &Machine, plan: &AxisPlan, from_s: f64, to_s: f64) -> f64 {
    let short = |t: f64| machine.at(plan, t).margin_mn_m() < 0.0;
    let begins = short(to_s);
    border(from_s, to_s, |t| short(t) != begins).1
}

#[cfg(test)]
mod tests;
