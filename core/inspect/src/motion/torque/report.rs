//! The torque study of an axis: motor, demand and curve.

use super::{Demand, Machine, Moment, Ramps, Shortage, needed_over_rate, steps_needed_over_rate};
use alloc::vec::Vec;
use serde::Serialize;
use stepscope_motion::{AxisPlan, moves::Axis};
use stepscope_peripheral::trace::Step;

const POINTS: u32 = 241;
const MAX_SHORTAGES: usize = 50;

/// Torques in mN*m, rates in steps/s, times in s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TorqueReport {
    pub standing_mn_m: f64,
    pub load_mn_m: f64,
    pub corner_rate: Option<f64>,
    pub torque_rate: Option<f64>,
    pub working_rate: Option<f64>,
    pub over_working_rate: Option<f64>,
    pub jump: f64,
    #[serde(rename = "least")]
    pub min_margin: Option<Moment>,
    pub total: u64,
    pub shortages: Vec<Shortage>,
    /// For steps without a plan: [`Machine::natural_period_s`].
    pub window_s: Option<f64>,
    pub ramps: Vec<MoveRamps>,
    #[serde(skip)]
    pub curve: TorqueCurve,
}

/// The feasible ramps of one move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MoveRamps {
    pub index: usize,
    pub duration_s: f64,
    #[serde(flatten)]
    pub ramps: Ramps,
}

/// Torque over the rate: available, and needed (NaN for unused rates).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TorqueCurve {
    pub rate: Vec<f64>,
    pub available: Vec<f64>,
    pub needed: Vec<f64>,
}

impl TorqueReport {
    /// `None` without a motor.
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

    /// The study of steps without a plan.
    pub fn of_steps(machine: &Machine, steps: &[Step], clock_hz: u32) -> Self {
        let demand = Demand::of_steps(machine, steps, clock_hz);
        let max_rate = machine.shown_rate(demand.max_rate);
        let needed = |max_rate, bins| steps_needed_over_rate(machine, steps, clock_hz, max_rate, bins);
        let curve = TorqueCurve::with(machine, max_rate, needed);
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
            min_margin: demand.min_margin,
            total: demand.shortage_count,
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

    /// The curve up to `max_rate`; without a plan, `needed` is empty.
    pub fn up_to(machine: &Machine, plan: Option<&AxisPlan>, max_rate: f64) -> Self {
        Self::with(machine, max_rate, |max_rate, bins| {
            plan.map_or_else(Vec::new, |plan| needed_over_rate(machine, plan, max_rate, bins))
        })
    }

    fn with(machine: &Machine, max_rate: f64, needed: impl FnOnce(f64, usize) -> Vec<f64>) -> Self {
        let (rate, available) = machine.curve(max_rate, POINTS).unzip();
        let width = max_rate / f64::from(POINTS - 1);
        Self { rate, available, needed: needed(width * f64::from(POINTS), POINTS as usize) }
    }
}
