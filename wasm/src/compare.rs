//! So many steps in so much time, with ramps of every shape side by side (DESIGN B4).

use crate::convert::{field, numbers, object};
use js_sys::{Array, JSON, Object};
use serde::Serialize;
use stepscope_core::{
    inspect::ramp_costs::{Cost, RampRequest, compare},
    motion::{Curve, Peaks, moves::Axis, plan_axis},
    scenario::to_json,
};
use wasm_bindgen::prelude::*;

/// A row without its curves.
#[derive(Serialize)]
struct ShapeCost {
    /// Why it cannot be.
    why: Option<String>,
    /// Peaks in steps and s.
    speed: f64,
    jump: f64,
    acceleration: f64,
    jerk: f64,
    acceleration_jump: f64,
    time_error_s: f64,
    last_step_s: f64,
}

/// Every shape for `steps` in `duration_s` with ramps of `ramp_s`, a row each: its move as a scenario has it, why it
/// cannot be or its peaks, its time error, when its last step falls due, and its curve as columns `at_speed` and
/// `at_acceleration`, at `points` times evenly from 0 to `duration_s`. What only some shapes need is as a scenario
/// has it where it is not given.
///
/// # Errors
/// Never in practice.
#[wasm_bindgen]
pub fn compare_ramps(
    steps: f64,
    duration_s: f64,
    ramp_s: f64,
    slice_s: Option<f64>,
    sigmoid_range: Option<f64>,
    time_constants: Option<f64>,
    points: u32,
) -> Result<Array, JsError> {
    let default = RampRequest::new(steps as i64, duration_s, ramp_s);
    let asked = RampRequest {
        slice_s: slice_s.unwrap_or(default.slice_s),
        sigmoid_range: sigmoid_range.unwrap_or(default.sigmoid_range),
        time_constants: time_constants.unwrap_or(default.time_constants),
        ..default
    };
    let made = Array::new();
    for row in compare(&asked) {
        let wanted = asked.ask(row.candidate);
        let nothing = Cost { peaks: Peaks::default(), time_error_s: 0.0, time_error: 0.0, last_step_s: 0.0 };
        let (cost, why) = match row.cost {
            Ok(cost) => (cost, None),
            Err(problems) => {
                let lines: Vec<String> = problems.iter().map(|problem| problem.cause.to_string()).collect();
                (nothing, Some(lines.join("; ")))
            }
        };
        let axis = Axis { moves: vec![wanted.clone()], ..Axis::default() };
        let plan = if why.is_none() { plan_axis(&axis, "").ok() } else { None };
        let curve = plan.as_ref().and_then(|plan| plan.moves().first()).map(|planned| &planned.profile);
        let Cost { peaks, time_error_s, last_step_s, .. } = cost;
        let cost = ShapeCost {
            why,
            speed: peaks.speed,
            jump: peaks.jump,
            acceleration: peaks.acceleration,
            jerk: peaks.jerk,
            acceleration_jump: peaks.acceleration_jump,
            time_error_s,
            last_step_s,
        };
        let shown: Object = object(&cost)?.into();
        let wanted = JSON::parse(&to_json(&wanted)).map_err(|_| JsError::new("a move is no JSON"))?;
        field(&shown, "move", &wanted);
        let sampled = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let time = |index| duration_s * f64::from(index) / f64::from(points.max(2) - 1);
            (0..points).map(|index| of(time(index))).collect()
        };
        if let Some(curve) = curve {
            numbers(
                &shown,
                "at_speed",
                &sampled(&|t| if t > curve.duration_s() { 0.0 } else { curve.speed(t) }),
            );
            numbers(&shown, "at_acceleration", &sampled(&|t| curve.acceleration(t)));
        }
        made.push(&shown);
    }
    Ok(made)
}
