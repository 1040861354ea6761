//! The measures of an axis, as the page shows them.

use crate::{
    convert::object,
    judged::{Judged, config, listed},
};
use stepscope_core::{
    inspect::{
        actual_motion::Pulses,
        measures::{Measures, within_bounds},
    },
    peripheral::trace::{Recording, steps},
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
        let plan = experiment.plans_of(controller).get(usize::from(axis));
        within_bounds(plan).map_err(|cause| JsError::new(&cause.to_string()))?;
        let mut recordings = vec![Recording::default(); controller + 1];
        experiment.run_each(&mut recordings);
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
        object(&plan.map(|plan| Measures::of(plan, &pulses, requested)))
    }
}
