//! The axis that a question of the study is about, from the scenario's text alone: so that further workers can
//! answer beside each other, and beside the run.

use stepscope_core::{
    motion::{AxisPlan, moves::Axis, plan_axis},
    peripheral::config::Bus,
    scenario::{Line, Problem, Scenario, Source, of_motion},
};
use wasm_bindgen::prelude::*;

/// An axis, its plan, and what it stands in.
pub(crate) struct Subject {
    pub(crate) title: String,
    pub(crate) clock_hz: u32,
    pub(crate) line: Line,
    /// Of the controller that the axis belongs to.
    pub(crate) bus: Bus,
    pub(crate) axis: Axis,
    pub(crate) plan: AxisPlan,
}

impl Subject {
    /// Axis `axis` of controller `controller`.
    ///
    /// # Errors
    /// If the scenario does not read, the axis has problems, or is not there.
    pub(crate) fn of(json: &str, controller: usize, axis: usize) -> Result<Self, JsError> {
        let Scenario { title, clock_hz, bus, line, source, controllers, .. } =
            Scenario::from_json(json).map_err(listed)?;
        let (bus, axes) = match (controller.checked_sub(1), source) {
            (Some(index), _) => {
                let further = controllers.into_iter().nth(index).unwrap_or_default();
                (further.bus, further.axes)
            }
            (None, Source::Motion(motion)) => (bus, motion.axes),
            _ => (bus, Vec::new()),
        };
        let axis = axes.into_iter().nth(axis).ok_or_else(|| JsError::new("there is no such axis"))?;
        let plan = plan_axis(&axis, "axis").map_err(of_motion).map_err(listed)?;
        Ok(Self { title, clock_hz, line, bus, axis, plan })
    }
}

/// All problems, a line each.
pub(crate) fn listed(problems: Vec<Problem>) -> JsError {
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    JsError::new(&lines.join("\n"))
}
