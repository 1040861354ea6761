//! Torque against rate of an axis' motor, what its plan needs, and which ramps it can follow.

use crate::{
    convert::{field, numbers, object},
    judged::Judged,
};
use js_sys::Object;
use serde::Serialize;
use stepscope_core::{
    inspect::torque::{Demand, Machine, Moment, Ramps, Shortage, needed_over_rate},
    motion::Curve,
    sim::SelectedAxis,
};
use wasm_bindgen::prelude::*;

/// Points of the curves.
const POINTS: u32 = 241;
/// Shortages that are listed.
const MAX_SHOWN: usize = 50;

#[derive(Serialize)]
struct Told {
    standing_mn_m: f64,
    load_mn_m: f64,
    corner_rate: Option<f64>,
    torque_rate: Option<f64>,
    working_rate: Option<f64>,
    over_working_rate: Option<f64>,
    jump: f64,
    least: Option<ToldMoment>,
    total: u64,
    shortages: Vec<ToldShortage>,
    ramps: Vec<ToldRamps>,
}

#[derive(Serialize)]
struct ToldMoment {
    at_s: f64,
    rate: f64,
    needed_mn_m: f64,
    available_mn_m: f64,
}

#[derive(Serialize)]
struct ToldShortage {
    from_s: f64,
    to_s: f64,
    times: f64,
    worst: ToldMoment,
}

/// Of a move whose ramps have a shape.
#[derive(Serialize)]
struct ToldRamps {
    index: usize,
    duration_s: f64,
    longest_s: Option<f64>,
    too_fast: bool,
    room_s: f64,
    enough_s: Option<(f64, f64)>,
    too_fast_s: Option<(f64, f64)>,
    without_ramps: bool,
}

impl From<&Moment> for ToldMoment {
    fn from(&Moment { at_s, rate, needed_mn_m, available_mn_m }: &Moment) -> Self {
        Self { at_s, rate, needed_mn_m, available_mn_m }
    }
}

impl From<&Shortage> for ToldShortage {
    fn from(Shortage { from_s, to_s, times, worst }: &Shortage) -> Self {
        Self { from_s: *from_s, to_s: *to_s, times: *times, worst: worst.into() }
    }
}

impl ToldRamps {
    fn of(index: usize, duration_s: f64, found: Ramps) -> Self {
        let Ramps { longest_s, too_fast, room_s, enough_s, too_fast_s, without_ramps, .. } = found;
        Self { index, duration_s, longest_s, too_fast, room_s, enough_s, too_fast_s, without_ramps }
    }
}

#[wasm_bindgen]
impl Judged {
    /// What an axis' motor has and what its plan asks: `told` with the numbers, `rate`, `available` and `needed` (the most at
    /// each rate, NaN at rates that the plan has not), torques in mN*m; undefined where the axis has no motor.
    ///
    /// # Errors
    /// If the axis has problems, or is not there.
    pub fn torque(&self, controller: usize, axis: usize) -> Result<Option<Object>, JsError> {
        let SelectedAxis { axis, plan, .. } = self.axis(controller, axis)?;
        let Some(machine) = Machine::of(axis) else { return Ok(None) };
        let demand = Demand::of(&machine, plan);
        let ramps = plan.moves().iter().enumerate().filter_map(|(index, planned)| {
            let found = Ramps::of(&machine, &planned.profile)?;
            Some(ToldRamps::of(index, planned.profile.duration_s(), found))
        });
        let told = Told {
            standing_mn_m: machine.available_mn_m(0.0),
            load_mn_m: machine.load_mn_m(),
            corner_rate: machine.corner_rate(),
            torque_rate: machine.torque_rate(),
            working_rate: machine.working_rate(),
            over_working_rate: demand.over_working_rate,
            jump: demand.jump,
            least: demand.least.as_ref().map(ToldMoment::from),
            total: demand.total,
            shortages: demand.shortages.iter().take(MAX_SHOWN).map(ToldShortage::from).collect(),
            ramps: ramps.collect(),
        };
        let made = Object::new();
        field(&made, "told", &object(&told)?);
        let most = machine.shown_rate(plan.peaks().speed);
        let (rates, available): (Vec<f64>, Vec<f64>) = machine.curve(most, POINTS).unzip();
        // A bin around each rate of the curve.
        let width = most / f64::from(POINTS - 1);
        let needed = needed_over_rate(&machine, plan, width * f64::from(POINTS), POINTS as usize);
        numbers(&made, "rate", &rates);
        numbers(&made, "available", &available);
        numbers(&made, "needed", &needed);
        Ok(Some(made))
    }
}
