//! Scenarios on their way into the form and the run: presets, and what is to be said of a scenario that was judged.

use crate::{
    convert::object,
    judged::{Judged, listed},
    simulation::Simulation,
};
use serde::Serialize;
use stepscope_core::{
    inspect::judgement::Judgement,
    scenario::{
        Scenario,
        link::{LinkError, encode},
        presets as core_presets,
    },
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
        .chain(core_presets::PLANT_PRESETS)
        .map(|preset| Preset {
            id: preset.id,
            document: preset.document,
            scenario: preset.scenario().to_json(),
        })
        .collect();
    object(&all)
}

#[wasm_bindgen]
impl Judged {
    /// All problems with their paths, the scenario as far as it could be read, what follows from it, and what a run
    /// will cost: `{problems, scenario, derived, cost}`.
    ///
    /// # Errors
    /// Never for any text: what is wrong with it is in the result.
    pub fn check(&self) -> Result<JsValue, JsError> {
        object(&Judgement::of(&self.0))
    }

    /// A run before its first cycle.
    ///
    /// # Errors
    /// If the scenario has problems; `check` lists them.
    pub fn run(&self) -> Result<Simulation, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        Ok(Simulation::of(self.0.scenario(), experiment))
    }

    /// The link of the scenario: what stands behind the `#`.
    ///
    /// # Errors
    /// If the scenario cannot be read, or is too large for a link.
    pub fn encode_link(&self) -> Result<String, JsError> {
        if self.0.unread().is_empty() {
            Ok(encode(self.0.scenario())?)
        } else {
            Err(LinkError::Scenario(self.0.unread().to_vec()).into())
        }
    }
}
