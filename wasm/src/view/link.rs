//! Links.

use crate::{convert::object, scenario::ValidatedScenario};
use serde::Serialize;
use stepscope_core::scenario::Scenario;
use stepscope_core::scenario::link::{LinkError, Packed, pack, part, unpack, with_part};
use stepscope_core::{inspect::validation::RunCost, sim::Experiment};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
#[serde(untagged)]
enum LinkContent {
    Scenario { scenario: String, over_budget: bool, message: String },
    Error { error: String },
}

/// A part of a fragment, such as `v`, decoded and without trailing punctuation.
#[wasm_bindgen]
pub fn link_part(fragment: &str, name: &str) -> Option<String> {
    part(fragment, name)
}

/// A link with an additional part, unless it becomes too long.
#[wasm_bindgen]
pub fn link_with(link: String, name: &str, text: &str) -> String {
    with_part(link, name, text)
}

/// The scenario of a link, or an error.
#[wasm_bindgen]
pub fn open_link(fragment: &str) -> Result<JsValue, JsError> {
    object(&decoded(fragment).unwrap_or_else(|error| LinkContent::Error { error: error.to_string() }))
}

fn decoded(fragment: &str) -> Result<LinkContent, LinkError> {
    let Packed { json, version } = unpack(fragment)?;
    let scenario = Scenario::from_json_of(&json, version).map_err(LinkError::Scenario)?;
    let cost = RunCost::of(Experiment::new(&scenario).map_err(LinkError::Scenario)?.cost());
    let (over_budget, message) = (cost.over_budget, cost.message);
    Ok(LinkContent::Scenario { scenario: scenario.to_json(), over_budget, message })
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// The link of the scenario, without the `#`. Errors: if the scenario is invalid, or too long for a link.
    pub fn link(&self) -> Result<String, JsError> {
        match self.0.unreadable() {
            None => Ok(pack(&self.0.scenario().to_compact_json())?),
            Some(problems) => Err(LinkError::Scenario(problems.clone()).into()),
        }
    }
}
