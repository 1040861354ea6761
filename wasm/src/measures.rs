//! The measures of an axis, as the page shows them.

use crate::{convert::object, simulation::Simulation};
use stepscope_core::{
    inspect::measures::{Measures, within_bounds},
    motion::moves::Axis,
    scenario::Source,
};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Simulation {
    /// All measures of an axis, an object with the core's names; `null` where it has no motion.
    ///
    /// # Errors
    /// More steps than are measured ([`within_bounds`]).
    pub fn measures(&mut self, axis: u8) -> Result<JsValue, JsError> {
        within_bounds(self.plan(axis)).map_err(|cause| JsError::new(&cause.to_string()))?;
        self.count_steps(axis);
        let measures =
            self.plan(axis).map(|plan| Measures::of(plan, &self.pulses_of(axis), self.asked(axis)));
        object(&measures)
    }

    /// The moves of an axis of the controller that the views look at.
    fn asked(&self, axis: u8) -> Option<&Axis> {
        let Source::Motion(motion) = &self.scenario.source else { return None };
        let further = self.selected.checked_sub(1).and_then(|index| self.scenario.controllers.get(index));
        further.map_or(&motion.axes, |controller| &controller.axes).get(usize::from(axis))
    }
}
