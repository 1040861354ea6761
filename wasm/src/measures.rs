//! The measures of an axis, as the page shows them.

use crate::{convert::object, simulation::Simulation};
use stepscope_core::{
    inspect::measures::{Measures, within_bounds},
    sim::axes_of,
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
        let requested = axes_of(&self.scenario, self.selected).get(usize::from(axis));
        object(&self.plan(axis).map(|plan| Measures::of(plan, &self.pulses_of(axis), requested)))
    }
}
