//! Torque against step rate: does a motor have what a plan asks of it (Song, Han, Lu 2021, 1.1 and 2.3)?
//!
//! The motor is a two-phase hybrid stepping motor on a bipolar driver that regulates the current, and the
//! model the phasor model of the textbooks (P. Acarnley, *Stepping Motors: a guide to theory and
//! practice*, the chapter on high-speed operation): only the fundamentals of flux, current and voltage; no
//! saturation, no detent torque, no iron losses, no resonance; the driver drops no voltage and gives at
//! most a sine of its supply's amplitude. With p = 90/full_step_deg pole pairs (rotor teeth), at w rad/s of
//! the shaft:
//!
//! ```text
//! k = holding torque/(sqrt(2)*rated current)      N*m/A, and V*s/rad: both phases on hold sqrt(2)*k*I
//! E = k*w,  X = p*w*L                             back-EMF and reactance of a phase, amplitudes
//! i = (V - E)/(R + j*X),  torque = k*Re(i)        the current, E being real
//! ```
//!
//! Available is the most torque of all currents with |i| <= the regulated peak and |V| <= the supply, that is of
//! the points that two discs in the plane of i have in common: one of radius I around 0, one of radius
//! V/|Z| around -E/Z, Z = R + j*X. Where all of these brake, or there is none, it is negative: the motor
//! has no torque of its own at that rate.
//!
//! ```text
//! torque |--------.               up to the corner the driver holds the current: k*I
//!        |         \ corner
//!        |          `-.           above it the voltage limits: Acarnley's pull-out torque
//!        |             `--.___    k*V/|Z| - k^2*w*R/|Z|^2, where that current is under I
//!        +--------------------    rate
//! ```
//!
//! Needed is (rotor + load inertia)*acceleration plus the load's torque, which opposes the motion, so that
//! it helps when slowing down. Braking is compared with the same curve, though the motor's losses help it there:
//! the verdict is on the safe side. Where the speed jumps (a start above rate 0) no torque is finite and the model
//! says nothing: [`Demand::jump`] tells how far. Of steps without a plan the acceleration is taken over the rotor's natural
//! period (`of_steps.rs`).
//!
//! ```
//! use stepscope_inspect::motion::torque::{Demand, Machine};
//! use stepscope_motion::{motor::Motor, moves::Axis, plan_axis};
//!
//! // The default turn, in 0.4 s, with the default motor.
//! let axis = Axis { motor: Some(Motor::default()), ..Axis::default() };
//! let machine = Machine::of(&axis).expect("it has a motor");
//! let demand = Demand::of(&machine, &plan_axis(&axis, "x").expect("it can be planned"));
//! assert!(demand.is_met());
//! // Ten times the load, and it is not.
//! let motor = Motor { load_torque_mn_m: 4000.0, ..Motor::default() };
//! let machine = Machine::of(&Axis { motor: Some(motor), ..axis.clone() }).expect("it has a motor");
//! assert!(!Demand::of(&machine, &plan_axis(&axis, "x").expect("it can be planned")).is_met());
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
use stepscope_motion::{AxisPlan, Breakpoints, Curve, Interval, bisection::border, grouped};

/// Shortages that are listed.
const MAX_SHORTAGES: usize = 1024;
/// Times of each move that a chart's needed torque is taken at.
const LOOKS_A_MOVE: u32 = 2048;
/// A plan is looked at so often, beside both sides of each of its joints.
const LOOKS: f64 = 512.0;

/// A stretch of time in which a plan needs more torque than there is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Shortage {
    /// Its start in s.
    pub from_s: f64,
    /// Its end in s.
    pub to_s: f64,
    /// In how many whole periods of a sine it comes again, itself counted; else 1.
    pub times: f64,
    /// Where most is missing.
    pub worst: Moment,
}

/// What a plan, or a list of steps, asks of a motor.
#[derive(Clone, Debug, PartialEq)]
pub struct Demand {
    /// Where there is too little torque, in order; the first 1024.
    pub shortages: Vec<Shortage>,
    /// How many stretches there are.
    pub total: u64,
    /// The moment with the least margin, the first of several; `None` where the plan takes no time.
    pub least: Option<Moment>,
    /// The greatest rate in steps/s.
    pub greatest_rate: f64,
    /// That rate, if it is above the motor's stated working rate.
    pub over_working_rate: Option<f64>,
    /// The greatest jump of speed in steps/s, which the motor has to follow at once.
    pub jump: f64,
}

impl Demand {
    /// What `plan` asks of `machine`.
    #[must_use]
    pub fn of(machine: &Machine, plan: &AxisPlan) -> Self {
        let peaks = plan.peaks();
        let over = machine.working_rate().filter(|most| peaks.speed > *most);
        let demand = Self {
            shortages: Vec::new(),
            total: 0,
            least: None,
            greatest_rate: peaks.speed,
            over_working_rate: over.map(|_| peaks.speed),
            jump: peaks.jump,
        };
        let mut walk = Walk { machine, plan, demand, open: None, before: None };
        let look_s = plan.duration_s() / LOOKS;
        Breakpoints::of(plan).intervals(0.0, plan.duration_s(), &mut |piece| walk.piece(piece, look_s));
        walk.close();
        walk.demand
    }

    /// What is to be said of the move from `from_s` to `to_s` of `peak_rate` steps/s: too high a rate, or where most
    /// torque is missing, and what to change; `None` where there is enough.
    #[must_use]
    pub fn warning(&self, machine: &Machine, from_s: f64, to_s: f64, peak_rate: f64) -> Option<String> {
        if let Some(most) = machine.working_rate().filter(|most| peak_rate > *most) {
            return Some(format!(
                "{} steps/s are above the motor's working rate of {}; give more time, or shorter ramps",
                grouped(peak_rate),
                grouped(most)
            ));
        }
        let inside = self.shortages.iter().filter(|found| found.from_s < to_s && found.to_s > from_s);
        let worst = inside
            .map(|found| found.worst)
            .reduce(|worst, other| if other.margin_mn_m() < worst.margin_mn_m() { other } else { worst })?;
        Some(format!(
            "too little torque: {:.1} mN*m needed of {:.1} at {:.4} s and {} steps/s; give more time, gentler ramps, less load or a higher supply voltage",
            libm::fabs(worst.needed_mn_m),
            worst.available_mn_m,
            worst.at_s,
            grouped(worst.rate)
        ))
    }

    /// Whether the motor can follow all of it, jumps aside.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.total == 0 && self.over_working_rate.is_none()
    }
}

/// The most torque in mN*m, driving or braking, that a plan needs at each rate, for a chart: of `bins` stretches of the
/// rate from 0 to `most_rate` steps/s; not-a-number where the plan has no such rate.
#[must_use]
pub fn needed_over_rate(machine: &Machine, plan: &AxisPlan, most_rate: f64, bins: usize) -> Vec<f64> {
    let mut needed = alloc::vec![f64::NAN; bins];
    for planned in plan.moves() {
        let part_s = planned.profile.duration_s() / f64::from(LOOKS_A_MOVE);
        for look in 0..LOOKS_A_MOVE {
            let moment = machine.at(plan, planned.start_s + (f64::from(look) + 0.5) * part_s);
            if let Some(most) = needed.get_mut((moment.rate / most_rate * bins as f64) as usize) {
                *most = libm::fmax(*most, libm::fabs(moment.needed_mn_m));
            }
        }
    }
    needed
}

/// A walk along a plan.
struct Walk<'m> {
    machine: &'m Machine,
    plan: &'m AxisPlan,
    demand: Demand,
    /// The shortage that has not ended yet.
    open: Option<Shortage>,
    /// The end of the last piece and how often it stands there.
    before: Option<Interval>,
}

impl Walk<'_> {
    fn piece(&mut self, piece: Interval, look_s: f64) {
        let follows =
            self.before.is_some_and(|before| before.to_s == piece.from_s && before.times == piece.times);
        if !follows {
            self.close();
        }
        self.before = Some(piece);
        let length = piece.to_s - piece.from_s;
        // Just inside: at a joint itself the value may be that of the other side.
        let inset = length * 1e-9;
        let parts = libm::fmax(1.0, libm::ceil(length / look_s)) as u32;
        let mut last: Option<Moment> = None;
        for part in 0..=parts {
            let at_s = if part == 0 {
                piece.from_s + inset
            } else if part == parts {
                piece.to_s - inset
            } else {
                piece.from_s + length * f64::from(part) / f64::from(parts)
            };
            let moment = self.machine.at(self.plan, at_s);
            self.look(moment, last, piece);
            last = Some(moment);
        }
    }

    /// Takes a moment; `last` is the one before in the same piece.
    fn look(&mut self, moment: Moment, last: Option<Moment>, piece: Interval) {
        let border = || last.map_or(piece.from_s, |last| self.border(last.at_s, moment.at_s));
        let short = moment.margin_mn_m() < 0.0;
        let border_s = if short == self.open.is_some() { piece.from_s } else { border() };
        if self.demand.least.is_none_or(|least| moment.margin_mn_m() < least.margin_mn_m()) {
            self.demand.least = Some(moment);
        }
        match (&mut self.open, short) {
            (None, false) => {}
            (None, true) => {
                let Interval { to_s, times, .. } = piece;
                self.open = Some(Shortage { from_s: border_s, to_s, times, worst: moment });
            }
            (Some(open), true) => {
                open.to_s = piece.to_s;
                if moment.margin_mn_m() < open.worst.margin_mn_m() {
                    open.worst = moment;
                }
            }
            (Some(open), false) => {
                open.to_s = border_s;
                self.close();
            }
        }
    }

    /// The time between both at which one is short and the other not.
    fn border(&self, from_s: f64, to_s: f64) -> f64 {
        let short = |t: f64| self.machine.at(self.plan, t).margin_mn_m() < 0.0;
        let begins = short(to_s);
        border(from_s, to_s, |t| short(t) != begins).1
    }

    fn close(&mut self) {
        let Some(shortage) = self.open.take() else { return };
        self.demand.total += 1;
        if self.demand.shortages.len() < MAX_SHORTAGES {
            self.demand.shortages.push(shortage);
        }
    }
}

#[cfg(test)]
mod tests;
