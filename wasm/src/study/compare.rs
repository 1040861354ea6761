//! Compares all kinds of motion for the same steps and time (DESIGN B4).

use crate::convert::{field, numbers, object};
use crate::scenario::ValidatedScenario;
use js_sys::{Array, JSON, Object};
use serde::Serialize;
use stepscope_core::inspect::motion::comparison::{Request, Row, compare};
use stepscope_core::inspect::motion::torque::Moment;
use stepscope_core::{motion::PlannedMove, scenario::to_json};
use wasm_bindgen::prelude::*;

/// A row without its curves.
#[derive(Default, Serialize)]
struct ComparedMotion {
    name: &'static str,
    why: Option<String>,
    /// Peaks in steps and s.
    speed: f64,
    jump: f64,
    acceleration: f64,
    jerk: f64,
    acceleration_jump: f64,
    time_error_s: f64,
    last_step_s: f64,
    torque: Option<Torque>,
}

#[derive(Serialize)]
struct Torque {
    is_met: bool,
    least: Option<Moment>,
}

impl ComparedMotion {
    fn of(row: &Row) -> Self {
        let name = row.candidate.name();
        match &row.cost {
            Err(problems) => {
                let lines: Vec<String> = problems.iter().map(|problem| problem.cause.to_string()).collect();
                Self { name, why: Some(lines.join("; ")), ..Self::default() }
            }
            Ok(cost) => Self {
                name,
                why: None,
                speed: cost.peaks.speed,
                jump: cost.peaks.jump,
                acceleration: cost.peaks.acceleration,
                jerk: cost.peaks.jerk,
                acceleration_jump: cost.peaks.acceleration_jump,
                time_error_s: cost.time_error_s,
                last_step_s: cost.last_step_s,
                torque: cost.torque.map(|torque| Torque { is_met: torque.is_met, least: torque.min_margin }),
            },
        }
    }
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// A move of an axis as every kind of motion with ramps of `ramp_s` (`ComparedMotion`), with its `move` in JSON and
    /// its curve as columns `at_speed` and `at_acceleration` at `points` times. Empty for a move without distance.
    /// Errors: if the scenario has problems, or no such axis.
    pub fn compare(
        &self,
        controller: usize,
        axis: usize,
        index: usize,
        ramp_s: f64,
        points: u32,
    ) -> Result<Array, JsError> {
        let selected = self.axis(controller, axis)?;
        let rows = Array::new();
        let Some(request) = Request::of(selected.axis, selected.plan, index, ramp_s) else { return Ok(rows) };
        for row in compare(&request) {
            let shown: Object = object(&ComparedMotion::of(&row))?.into();
            let motion = JSON::parse(&to_json(&row.requested_move))
                .map_err(|_| JsError::new("invalid JSON of a move"))?;
            field(&shown, "move", &motion);
            let sampled = |quantity: &dyn Fn(f64) -> f64| -> Vec<f64> {
                let time = |index| request.duration_s * f64::from(index) / f64::from(points.max(2) - 1);
                (0..points).map(|index| quantity(time(index))).collect()
            };
            if let Some([PlannedMove { profile: curve, .. }]) = row.plan.as_ref().map(|plan| plan.moves()) {
                let within = |t| t <= curve.duration_s();
                numbers(&shown, "at_speed", &sampled(&|t| if within(t) { curve.speed(t) } else { 0.0 }));
                numbers(&shown, "at_acceleration", &sampled(&|t| curve.acceleration(t)));
            }
            rows.push(&shown);
        }
        Ok(rows)
    }
}
