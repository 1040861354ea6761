//! Validation of a scenario before it runs: problems, derived numbers and cost.
//!
//! ```
//! use stepscope_inspect::validation::Validation;
//! use stepscope_sim::ValidatedScenario;
//!
//! let validation = Validation::of(&ValidatedScenario::from_json(r#"{ "bus": { "slots": 0 } }"#));
//! assert_eq!(validation.problems[0].path, "bus.slots");
//! ```

pub mod remedies;

use crate::motion::torque::{Demand, Machine};
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use serde::Serialize;
use stepscope_motion::moves::{Axis, Move};
use stepscope_motion::{AxisPlan, PlannedMove, grouped};
use stepscope_peripheral::config::Config;
use stepscope_scenario::{Problem, Scenario};
use stepscope_sim::{BUDGET_MOTOR_GRID_STEPS, BUDGET_RECORDS, Cost, Experiment, ValidatedScenario, axes_of};

/// Problems, warnings, derived values and cost of a scenario, for the page.
#[derive(Clone, Debug, Serialize)]
pub struct Validation {
    pub problems: Vec<ProblemText>,
    pub scenario: String,
    pub warnings: Vec<ProblemText>,
    pub derived: Option<Derived>,
    pub cost: Option<RunCost>,
}

/// A problem with the path of its field.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemText {
    pub path: String,
    pub message: String,
}

/// Numbers that follow from a valid scenario.
#[derive(Clone, Debug, Serialize)]
pub struct Derived {
    pub ticks: u64,
    pub sends: u64,
    /// Fraction of time in which the line is busy while all controllers move.
    pub line_load: Option<f64>,
    pub duration_s: f64,
    pub controllers: Vec<DerivedController>,
}

/// Derived values of one controller.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedController {
    pub tick_s: f64,
    pub limit_steps_s: f64,
    pub ticks: u64,
    pub axes: Vec<DerivedAxis>,
}

/// Derived values of one axis.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedAxis {
    /// From the first to the last position.
    pub steps: i64,
    pub duration_s: f64,
    pub peak_speed_steps_s: f64,
    pub peak_acceleration_steps_s2: f64,
    pub step_mm: Option<f64>,
    pub step_deg: Option<f64>,
    /// Unit of the first distance: `steps`, `mm` or `deg`.
    pub unit: &'static str,
    pub moves: Vec<DerivedMove>,
}

/// Derived values of one move.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedMove {
    pub start_s: f64,
    pub duration_s: f64,
    pub steps: i64,
    pub detail: String,
    /// Empty if the torque suffices.
    pub warning: String,
}

/// Computed cost of a run, before it runs.
#[derive(Clone, Debug, Serialize)]
pub struct RunCost {
    pub edges: u64,
    pub packets: u64,
    pub bytes: u64,
    pub over_budget: bool,
    pub message: String,
}

impl Validation {
    pub fn of(validated: &ValidatedScenario) -> Self {
        let text = |Problem { path, cause, .. }: &Problem| ProblemText {
            path: path.clone(),
            message: cause.to_string(),
        };
        let experiment = validated.experiment().ok();
        Self {
            problems: validated.problems().iter().map(text).collect(),
            scenario: validated.scenario().to_json(),
            warnings: experiment.map_or_else(Vec::new, |experiment| warnings(experiment)),
            derived: experiment.map(|experiment| Derived::of(validated.scenario(), experiment)),
            cost: experiment.map(|experiment| RunCost::of(experiment.cost())),
        }
    }
}

/// Warnings on controllers without a serial line. Those of other controllers are in [`DerivedMove::warning`].
fn warnings(experiment: &Experiment) -> Vec<ProblemText> {
    let all = experiment.stand_alone().into_iter().flat_map(|controllers| controllers.warnings());
    all.map(|warned| ProblemText {
        path: format!("source.standalone[{}].{}", warned.controller, warned.path),
        message: warned.warning.to_string(),
    })
    .collect()
}

impl RunCost {
    pub fn of(cost: Cost) -> Self {
        let message = if cost.motor_grid_steps > BUDGET_MOTOR_GRID_STEPS {
            format!(
                "the motor simulation takes {} time steps; more than {} need confirmation",
                grouped(cost.motor_grid_steps as f64),
                grouped(BUDGET_MOTOR_GRID_STEPS as f64)
            )
        } else if cost.is_over_budget() {
            format!(
                "the run has up to {} edges and {} packets; more than {} edges need confirmation",
                grouped(cost.records as f64),
                grouped(cost.sends as f64),
                grouped(BUDGET_RECORDS as f64)
            )
        } else {
            String::new()
        };
        let (edges, packets, bytes) = (cost.records, cost.sends, cost.bytes);
        Self { edges, packets, bytes, over_budget: cost.is_over_budget(), message }
    }
}

impl Derived {
    fn of(scenario: &Scenario, experiment: &Experiment) -> Self {
        let clock_hz = f64::from(experiment.config().clock_hz());
        let controllers: Vec<DerivedController> = experiment
            .configs()
            .enumerate()
            .map(|(index, config)| DerivedController::of(scenario, experiment, index, config))
            .collect();
        Self {
            ticks: controllers.iter().map(|controller| controller.ticks).max().unwrap_or(0),
            sends: experiment.cost().sends,
            line_load: experiment.line_load(),
            duration_s: experiment.cost().end_cycle as f64 / clock_hz,
            controllers,
        }
    }
}

impl DerivedController {
    fn of(scenario: &Scenario, experiment: &Experiment, index: usize, config: &Config) -> Self {
        let tick_s = config.tick().0 as f64 / f64::from(config.clock_hz());
        let limit_steps_s = f64::from(config.slots()) / tick_s;
        let ticks = experiment.ticks_of(index).len() / usize::from(config.channels().max(1));
        let axes = axes_of(scenario, index).iter().zip(experiment.plans_of(index));
        let axes = axes.map(|(axis, plan)| DerivedAxis::of(axis, plan, limit_steps_s));
        Self { tick_s, limit_steps_s, ticks: ticks as u64, axes: axes.collect() }
    }
}

impl DerivedAxis {
    fn of(axis: &Axis, plan: &AxisPlan, limit_steps_s: f64) -> Self {
        let driven = Machine::of(axis).map(|machine| (Demand::of(&machine, plan), machine));
        let warning = |planned: &PlannedMove| {
            let (demand, machine) = driven.as_ref()?;
            let (from_s, profile) = (planned.start_s, &planned.profile);
            demand.warning(machine, from_s, from_s + profile.duration_s(), profile.peaks().speed)
        };
        let planned = |planned: &PlannedMove| DerivedMove {
            start_s: planned.start_s,
            duration_s: planned.profile.duration_s(),
            steps: planned.profile.steps(),
            detail: planned.profile.detail(limit_steps_s),
            warning: warning(planned).unwrap_or_default(),
        };
        Self {
            steps: plan.steps(),
            duration_s: plan.duration_s(),
            peak_speed_steps_s: plan.peaks().speed,
            peak_acceleration_steps_s2: plan.peaks().acceleration,
            step_mm: axis.mechanics.step_mm(),
            step_deg: axis.mechanics.step_deg(),
            unit: axis.moves.iter().find_map(Move::unit).unwrap_or("steps"),
            moves: plan.moves().iter().map(planned).collect(),
        }
    }
}
