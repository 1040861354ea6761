//! Scenarios on their way into the form: presets, and what is wrong with what was typed.

use crate::convert::object;
use serde::Serialize;
use std::iter::once;
use stepscope_core::{
    inspect::torque::{Demand, Machine},
    motion::{AxisPlan, Curve, PlannedMove, grouped, moves::Axis},
    scenario::{Problem, Scenario, Source, presets as core_presets},
    sim::{BUDGET_RECORDS, Cost, Experiment},
};
use wasm_bindgen::prelude::*;

/// Version of Stepscope.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").into()
}

/// The default scenario as JSON, every field written.
#[wasm_bindgen]
#[must_use]
pub fn default_scenario() -> String {
    Scenario::default().to_json()
}

#[derive(Serialize)]
struct Preset {
    id: &'static str,
    document: &'static str,
    scenario: String,
}

/// All presets: `{id, document, scenario}`, the scenario as JSON with every field written.
///
/// # Errors
/// Never in practice: the presets are tested.
#[wasm_bindgen]
pub fn presets() -> Result<JsValue, JsError> {
    let all: Vec<Preset> = core_presets::PRESETS
        .iter()
        .map(|preset| Preset {
            id: preset.id,
            document: preset.document,
            scenario: preset.scenario().to_json(),
        })
        .collect();
    object(&all)
}

#[derive(Serialize)]
struct Judgement {
    problems: Vec<Told>,
    scenario: String,
    derived: Option<Derived>,
    cost: Option<Price>,
}

#[derive(Serialize)]
struct Told {
    path: String,
    message: String,
}

#[derive(Serialize)]
struct Derived {
    /// Of the controller that has most.
    ticks: u64,
    sends: u64,
    line_load: Option<f64>,
    duration_s: f64,
    /// In the order of the scenario.
    controllers: Vec<DerivedController>,
}

#[derive(Serialize)]
struct DerivedController {
    tick_s: f64,
    limit_steps_s: f64,
    ticks: u64,
    axes: Vec<DerivedAxis>,
}

#[derive(Serialize)]
struct DerivedAxis {
    steps: i64,
    duration_s: f64,
    peak_speed_steps_s: f64,
    peak_acceleration_steps_s2: f64,
    step_mm: Option<f64>,
    step_deg: Option<f64>,
    moves: Vec<DerivedMove>,
}

#[derive(Serialize)]
struct DerivedMove {
    start_s: f64,
    duration_s: f64,
    steps: i64,
    detail: String,
    /// What the axis' motor cannot do of it; empty where there is enough torque, or no motor.
    warning: String,
}

#[derive(Serialize)]
struct Price {
    edges: u64,
    packets: u64,
    bytes: u64,
    over_budget: bool,
    message: String,
}

/// Judges a scenario: all problems with their paths, the scenario as far as it could be read, what
/// follows from it, and what a run will cost.
///
/// # Errors
/// Never for any text: what is wrong with it is in the result.
#[wasm_bindgen]
pub fn check(json: &str) -> Result<JsValue, JsError> {
    let (scenario, unread) = Scenario::from_json_lenient(json);
    let (experiment, problems) = match Experiment::of_lenient(&scenario, unread) {
        Ok(experiment) => (Some(experiment), Vec::new()),
        Err(problems) => (None, problems),
    };
    object(&Judgement {
        problems: problems.iter().map(told).collect(),
        scenario: scenario.to_json(),
        derived: experiment.as_ref().map(|experiment| derive(&scenario, experiment)),
        cost: experiment.as_ref().map(|experiment| price(experiment.cost())),
    })
}

fn told(problem: &Problem) -> Told {
    Told { path: problem.path.clone(), message: problem.cause.to_string() }
}

/// What a run costs, and whether that is more than runs unasked.
fn price(cost: Cost) -> Price {
    Price {
        edges: cost.records,
        packets: cost.sends,
        bytes: cost.bytes,
        over_budget: cost.is_over_budget(),
        message: cost_message(cost),
    }
}

pub(crate) fn cost_message(cost: Cost) -> String {
    if cost.is_over_budget() {
        format!(
            "up to {} edges and {} packets: more than the {} edges that run unasked",
            grouped(cost.records as f64),
            grouped(cost.sends as f64),
            grouped(BUDGET_RECORDS as f64)
        )
    } else {
        String::new()
    }
}

fn derive(scenario: &Scenario, experiment: &Experiment) -> Derived {
    let clock_hz = f64::from(experiment.config().clock_hz());
    let own_axes = match &scenario.source {
        Source::Motion(motion) => motion.axes.as_slice(),
        _ => &[],
    };
    let axes = once(own_axes).chain(scenario.controllers.iter().map(|further| further.axes.as_slice()));
    let each = experiment.configs().zip(axes).enumerate();
    let controllers: Vec<DerivedController> = each
        .map(|(index, (config, axes))| {
            let tick_s = config.tick().0 as f64 / clock_hz;
            let limit_steps_s = f64::from(config.slots()) / tick_s;
            let ticks = experiment.ticks_of(index).len() / usize::from(config.channels().max(1));
            let plans = experiment.plans_of(index).iter();
            let axes = axes.iter().zip(plans).map(|(axis, plan)| derive_axis(axis, plan, limit_steps_s));
            DerivedController { tick_s, limit_steps_s, ticks: ticks as u64, axes: axes.collect() }
        })
        .collect();
    Derived {
        ticks: controllers.iter().map(|controller| controller.ticks).max().unwrap_or(0),
        sends: experiment.cost().sends,
        line_load: experiment.line_load(),
        duration_s: experiment.cost().end_cycle as f64 / clock_hz,
        controllers,
    }
}

fn derive_axis(axis: &Axis, plan: &AxisPlan, limit_steps_s: f64) -> DerivedAxis {
    DerivedAxis {
        steps: plan.steps(),
        duration_s: plan.duration_s(),
        peak_speed_steps_s: plan.peaks().speed,
        peak_acceleration_steps_s2: plan.peaks().acceleration,
        step_mm: axis.mechanics.step_mm(),
        step_deg: axis.mechanics.step_deg(),
        moves: moves(axis, plan, limit_steps_s),
    }
}

fn moves(axis: &Axis, plan: &AxisPlan, limit_steps_s: f64) -> Vec<DerivedMove> {
    let driven = Machine::of(axis).map(|machine| (Demand::of(&machine, plan), machine));
    let warning = |planned: &PlannedMove| {
        let (demand, machine) = driven.as_ref()?;
        let (from_s, profile) = (planned.start_s, &planned.profile);
        demand.warning(machine, from_s, from_s + profile.duration_s(), profile.peaks().speed)
    };
    plan.moves()
        .iter()
        .map(|planned| DerivedMove {
            start_s: planned.start_s,
            duration_s: planned.profile.duration_s(),
            steps: planned.profile.steps(),
            detail: planned.profile.detail(limit_steps_s),
            warning: warning(planned).unwrap_or_default(),
        })
        .collect()
}
