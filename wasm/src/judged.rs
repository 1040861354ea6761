//! Scenarios on their way into the form, the run and the study: presets, and a scenario that was judged.

use crate::{convert::object, simulation::Simulation};
use serde::Serialize;
use stepscope_core::{
    inspect::{judgement::Judgement, remedies::Remedies},
    scenario::{
        Problem, Scenario,
        link::{LinkError, encode},
        presets as core_presets,
    },
    sim::{self, SelectedAxis},
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

/// A scenario that was read, judged and planned, once. A run, a link and the study's questions are made of it.
#[wasm_bindgen]
pub struct Judged(sim::Judged);

#[wasm_bindgen]
impl Judged {
    /// Reads, judges and plans a text, which may be any.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new(json: &str) -> Self {
        Self(sim::Judged::from_json(json))
    }

    /// All problems with their paths, the scenario as far as it could be read, what follows from it, and what a run
    /// will cost: `{problems, scenario, derived, cost}`.
    ///
    /// # Errors
    /// Never for any text: what is wrong with it is in the result.
    pub fn check(&self) -> Result<JsValue, JsError> {
        object(&Judgement::of(&self.0))
    }

    /// What would let a motion run that its bus is too slow for: `{wrong, offers: [{change, scenario}]}`; null where
    /// that is not what is wrong.
    ///
    /// # Errors
    /// Never in practice.
    pub fn remedies(&self) -> Result<JsValue, JsError> {
        object(&Remedies::of(&self.0))
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

impl Judged {
    /// Axis `axis` of controller `controller`.
    ///
    /// # Errors
    /// If the scenario has problems, or no such axis.
    pub(crate) fn axis(&self, controller: usize, axis: usize) -> Result<SelectedAxis<'_>, JsError> {
        self.0.experiment().map_err(listed)?;
        self.0.axis(controller, axis).ok_or_else(|| JsError::new("there is no such axis"))
    }
}

/// All problems, a line each.
pub(crate) fn listed(problems: &[Problem]) -> JsError {
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    JsError::new(&lines.join("\n"))
}
