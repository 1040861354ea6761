//! The measures of an axis, as the page shows them.

use crate::{
    convert::{object, records},
    judged::{Judged, config, listed},
};
use stepscope_core::{
    inspect::{
        motion::{
            actual_motion::Pulses,
            measures::{Measures, within_bounds},
        },
        recording::figures::StepFigures,
        trace::stored_run::record_run,
    },
    peripheral::trace::{steps, steps_in},
    sim::axes_of,
};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Judged {
    /// All measures of an axis in a run of the scenario, an object with the core's names; `null` where it has no motion.
    ///
    /// # Errors
    /// If the scenario has problems; more steps than are measured ([`within_bounds`]).
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
        let made = steps(&recording.trace, axis);
        let pulses = Pulses::of_run(
            axis,
            &made,
            &recording.packets,
            experiment.segments().and_then(|all| all.lists().get(usize::from(axis))),
            config(experiment, controller),
        );
        let requested = axes_of(self.0.scenario(), controller).get(usize::from(axis));
        object(&Measures::of(plan, &pulses, requested))
    }
}

/// What the steps of a channel come to by themselves, where no plan is known, an object with the core's names; `null` where it
/// makes none. `run` is what the views show of it: records as `Simulation::records_of` gives them, in cycles of `clock_hz`.
///
/// # Errors
/// Never in practice.
#[wasm_bindgen]
pub fn step_figures(run: &[u8], channel: u8, clock_hz: u32) -> Result<JsValue, JsError> {
    let trace: Vec<_> = records(run).collect();
    object(&StepFigures::of(steps_in(&trace, channel), clock_hz))
}
