//! What is said of a scenario before it runs: every problem, what follows from its numbers, and what a run will cost.
//!
//! ```
//! use stepscope_inspect::validation::Judgement;
//! use stepscope_sim::ValidatedScenario;
//!
//! let judgement = Judgement::of(&Judged::from_json("{}"));
//! assert_eq!(judgement.derived.map(|derived| derived.controllers[0].axes[0].steps), Some(3200));
//!
//! let judgement = Judgement::of(&Judged::from_json(r#"{ "bus": { "slots": 0 } }"#));
//! assert_eq!(judgement.problems[0].path, "bus.slots");
//! assert!(judgement.cost.is_none()); // what does not run costs nothing
//! ```

pub mod remedies;

use crate::motion::torque::{Demand, Machine};
use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use serde::Serialize;
use stepscope_motion::{AxisPlan, Curve, PlannedMove, grouped, moves::Axis};
use stepscope_peripheral::config::Config;
use stepscope_scenario::{Problem, Scenario};
use stepscope_sim::{BUDGET_MOTOR_STEPS, BUDGET_RECORDS, Cost, Experiment, ValidatedScenario, axes_of};

/// All that is said of a scenario.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// What is wrong with it.
    pub problems: Vec<ProblemText>,
    /// The scenario as JSON, as far as it could be read, every field written.
    pub scenario: String,
    /// What holds, but may not be meant.
    pub warnings: Vec<ProblemText>,
    /// What follows from it; nothing where it has problems.
    pub derived: Option<Derived>,
    /// What a run costs.
    pub cost: Option<RunCost>,
}

/// A problem in words.
#[derive(Clone, Debug, Serialize)]
pub struct ProblemText {
    /// The field's path.
    pub path: String,
    /// What was given, what is allowed, what to change.
    pub message: String,
}

/// What follows from a scenario's numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Derived {
    /// Of the controller that has most.
    pub ticks: u64,
    /// Sends of the host.
    pub sends: u64,
    /// The part of the line's time that is taken while all controllers move.
    pub line_load: Option<f64>,
    /// How long a run takes.
    pub duration_s: f64,
    /// In the order of the scenario.
    pub controllers: Vec<DerivedController>,
}

/// Of one controller.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedController {
    /// Length of its tick.
    pub tick_s: f64,
    /// The greatest rate that its ticks can order.
    pub limit_steps_s: f64,
    /// Ticks that it is sent.
    pub ticks: u64,
    /// Its axes, where the source is a motion.
    pub axes: Vec<DerivedAxis>,
}

/// Of one axis.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedAxis {
    /// From its first position to its last.
    pub steps: i64,
    /// Time of the ideal curve.
    pub duration_s: f64,
    /// Greatest rate.
    pub peak_speed_steps_s: f64,
    /// Greatest acceleration.
    pub peak_acceleration_steps_s2: f64,
    /// Length of a step, where the mechanics have one.
    pub step_mm: Option<f64>,
    /// Angle of a step, where the mechanics have one.
    pub step_deg: Option<f64>,
    /// Its moves.
    pub moves: Vec<DerivedMove>,
}

/// Of one move.
#[derive(Clone, Debug, Serialize)]
pub struct DerivedMove {
    /// When it begins.
    pub start_s: f64,
    /// How long it takes.
    pub duration_s: f64,
    /// From its first position to its last.
    pub steps: i64,
    /// What else is to be known of its curve, in words.
    pub detail: String,
    /// What the axis' motor cannot do of it; empty where there is enough torque, or no motor.
    pub warning: String,
}

/// What a run costs, and whether that is more than runs unasked.
#[derive(Clone, Debug, Serialize)]
pub struct RunCost {
    /// Records of the trace, at most.
    pub edges: u64,
    /// Sends of the host.
    pub packets: u64,
    /// Bytes that the host sends.
    pub bytes: u64,
    /// Whether it is more than runs unasked.
    pub over_budget: bool,
    /// That it is, in words; else empty.
    pub message: String,
}

impl Judgement {
    /// Of a scenario that was judged.
    #[must_use]
    pub fn of(judged: &ValidatedScenario) -> Self {
        let text = |Problem { path, cause, .. }: &Problem| ProblemText {
            path: path.clone(),
            message: cause.to_string(),
        };
        let experiment = judged.experiment().ok();
        Self {
            problems: judged.problems().iter().map(text).collect(),
            scenario: judged.scenario().to_json(),
            warnings: experiment.map_or_else(Vec::new, |experiment| warnings(experiment)),
            derived: experiment.map(|experiment| Derived::of(judged.scenario(), experiment)),
            cost: experiment.map(|experiment| RunCost::of(experiment.cost())),
        }
    }
}

/// Of stand-alone controllers; the others have theirs where they belong, such as [`DerivedMove::warning`].
fn warnings(experiment: &Experiment) -> Vec<ProblemText> {
    let all = experiment.stand_alone().into_iter().flat_map(|controllers| controllers.warnings());
    all.map(|warned| ProblemText {
        path: format!("source.standalone[{}].{}", warned.controller, warned.path),
        message: warned.warning.to_string(),
    })
    .collect()
}

impl RunCost {
    /// In words.
    #[must_use]
    pub fn of(cost: Cost) -> Self {
        let message = if cost.motor_steps > BUDGET_MOTOR_STEPS {
            format!(
                "{} motor-steps of the plant: more than the {} that run unasked",
                grouped(cost.motor_steps as f64),
                grouped(BUDGET_MOTOR_STEPS as f64)
            )
        } else if cost.is_over_budget() {
            format!(
                "up to {} edges and {} packets: more than the {} edges that run unasked",
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
            moves: plan.moves().iter().map(planned).collect(),
        }
    }
}
