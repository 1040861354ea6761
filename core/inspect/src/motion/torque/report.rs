//! All that the study shows of an axis' motor and of what its plan asks of it.

use super::{Demand, Machine, Moment, Ramps, Shortage, needed_over_rate, steps_needed_over_rate};
use alloc::vec::Vec;
use serde::Serialize;
use stepscope_motion::{AxisPlan, Curve, moves::Axis};
use stepscope_peripheral::trace::Step;

/// Points of the curves.
const POINTS: u32 = 241;
/// Shortages that are listed.
const MAX_SHORTAGES: usize = 50;

/// The numbers; torques in mN*m, rates in steps/s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TorqueReport {
    /// Torque at standstill.
    pub standing_mn_m: f64,
    /// Torque of the load.
    pub load_mn_m: f64,
    /// [`Machine::corner_rate`].
    pub corner_rate: Option<f64>,
    /// [`Machine::torque_rate`].
    pub torque_rate: Option<f64>,
    /// [`Machine::working_rate`].
    pub working_rate: Option<f64>,
    /// [`Demand::over_working_rate`].
    pub over_working_rate: Option<f64>,
    /// [`Demand::jump`].
    pub jump: f64,
    /// [`Demand::least`].
    pub least: Option<Moment>,
    /// How many stretches have too little torque.
    pub total: u64,
    /// The first of them.
    pub shortages: Vec<Shortage>,
    /// Of steps without a plan: what their acceleration is taken over, [`Machine::natural_period_s`].
    pub window_s: Option<f64>,
    /// Of each move whose ramps have a shape.
    pub ramps: Vec<MoveRamps>,
    /// Torque over rate.
    #[serde(skip)]
    pub curve: TorqueCurve,
}

/// Which ramps of a move the motor can follow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MoveRamps {
    /// The move.
    pub index: usize,
    /// How long it takes.
    pub duration_s: f64,
    /// Its ramps.
    #[serde(flatten)]
    pub ramps: Ramps,
}

/// Torque over rate, in columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TorqueCurve {
    /// Rates.
    pub rate: Vec<f64>,
    /// What the motor has.
    pub available: Vec<f64>,
    /// The most that the plan needs there; NaN at rates that it has not.
    pub needed: Vec<f64>,
}

impl TorqueReport {
    /// Of an axis with its plan; `None` without a motor.
    #[must_use]
    pub fn of(axis: &Axis, plan: &AxisPlan) -> Option<Self> {
        let machine = Machine::of(axis)?;
        let demand = Demand::of(&machine, plan);
        let ramps = plan.moves().iter().enumerate().filter_map(|(index, planned)| {
            let ramps = Ramps::of(&machine, &planned.profile)?;
            Some(MoveRamps { index, duration_s: planned.profile.duration_s(), ramps })
        });
        let found = Self::with(&machine, demand, TorqueCurve::of(&machine, plan));
        Some(Self { ramps: ramps.collect(), ..found })
    }

    /// Of steps without a plan, in cycles of `clock_hz`.
    #[must_use]
    pub fn of_steps(machine: &Machine, steps: &[Step], clock_hz: u32) -> Self {
        let demand = Demand::of_steps(machine, steps, clock_hz);
        let most = machine.shown_rate(demand.greatest_rate);
        let needed = |most, bins| steps_needed_over_rate(machine, steps, clock_hz, most, bins);
        let curve = TorqueCurve::with(machine, most, needed);
        Self { window_s: Some(machine.natural_period_s()), ..Self::with(machine, demand, curve) }
    }

    fn with(machine: &Machine, demand: Demand, curve: TorqueCurve) -> Self {
        Self {
            standing_mn_m: machine.available_mn_m(0.0),
            load_mn_m: machine.load_mn_m(),
            corner_rate: machine.corner_rate(),
            torque_rate: machine.torque_rate(),
            working_rate: machine.working_rate(),
            over_working_rate: demand.over_working_rate,
            jump: demand.jump,
            least: demand.least,
            total: demand.total,
            window_s: None,
            ramps: Vec::new(),
            shortages: demand.shortages.into_iter().take(MAX_SHORTAGES).collect(),
            curve,
        }
    }
}

impl TorqueCurve {
    fn of(machine: &Machine, plan: &AxisPlan) -> Self {
        Self::up_to(machine, Some(plan), machine.shown_rate(plan.peaks().speed))
    }

    /// Up to a rate in steps/s, above 0; what a plan needs of it where there is one.
    #[must_use]
    pub fn up_to(machine: &Machine, plan: Option<&AxisPlan>, most: f64) -> Self {
        Self::with(machine, most, |most, bins| {
            plan.map_or_else(Vec::new, |plan| needed_over_rate(machine, plan, most, bins))
        })
    }

    /// Up to a rate; `needed` is asked for so many bins up to so many steps/s, one around each rate of the curve.
    fn with(machine: &Machine, most: f64, needed: impl FnOnce(f64, usize) -> Vec<f64>) -> Self {
        let (rate, available) = machine.curve(most, POINTS).unzip();
        let width = most / f64::from(POINTS - 1);
        Self { rate, available, needed: needed(width * f64::from(POINTS), POINTS as usize) }
    }
}
