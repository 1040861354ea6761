//! The measures of an axis.

use crate::convert::{object, records};
use crate::scenario::{ValidatedScenario, config, listed};
use stepscope_core::inspect::motion::actual_motion::Pulses;
use stepscope_core::inspect::motion::measures::{Measures, within_bounds};
use stepscope_core::inspect::{recording::figures::StepFigures, trace::stored_run::record_run};
use stepscope_core::peripheral::trace::{steps, steps_in};
use stepscope_core::sim::axes_of;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl ValidatedScenario {
    /// All measures of an axis ([`Measures`]); null without a motion.
    /// Errors: if the scenario has problems, or too many steps ([`within_bounds`]).
    pub fn measures(&self, controller: usize, axis: u8) -> Result<JsValue, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        let Some(plan) = experiment.plans_of(controller).get(usize::from(axis)) else {
            return Ok(JsValue::NULL);
        };
        within_bounds([plan]).map_err(|cause| JsError::new(&cause.to_string()))?;
        let (_, mut recordings) =
            record_run(experiment, controller + 1).map_err(|why| JsError::new(&why.to_string()))?;
        let Some(recording) = recordings.get_mut(controller) else { return Ok(JsValue::NULL) };
        recording.packets.finish();
        let actual = steps(&recording.trace, axis);
        let pulses = Pulses::of_run(
            axis,
            &actual,
            &recording.packets,
            experiment.segments().and_then(|all| all.lists().get(usize::from(axis))),
            config(experiment, controller),
        );
        let requested = axes_of(self.0.scenario(), controller).get(usize::from(axis));
        object(&Measures::of(plan, &pulses, requested))
    }
}

/// Figures of the steps of a channel without a plan ([`StepFigures`]); null without steps. `run` has the records of
/// `Simulation::records_of`, in cycles of `clock_hz`.
#[wasm_bindgen]
pub fn step_figures(run: &[u8], channel: u8, clock_hz: u32) -> Result<JsValue, JsError> {
    let trace: Vec<_> = records(run).collect();
    object(&StepFigures::of(steps_in(&trace, channel), clock_hz))
}
