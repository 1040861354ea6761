//! Links: a scenario as a fragment, and back.

use crate::{convert::object, judged::Judged};
use serde::Serialize;
use stepscope_core::{
    inspect::validation::RunCost,
    scenario::{
        Scenario,
        link::{LinkError, Packed, pack, part, unpack, with_part},
    },
    sim::Experiment,
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
#[serde(untagged)]
enum Opened {
    Scenario { scenario: String, over_budget: bool, message: String },
    Error { error: String },
}

/// Another part of a fragment, such as `v`, as its writer meant it: percent signs decoded, without what
/// a chat program put behind it.
#[wasm_bindgen]
#[must_use]
pub fn link_part(fragment: &str, name: &str) -> Option<String> {
    part(fragment, name)
}

/// A link with an additional part, unless it becomes too long to be read.
#[wasm_bindgen]
#[must_use]
pub fn link_with(link: String, name: &str, text: &str) -> String {
    with_part(link, name, text)
}

/// The scenario of a link: `{scenario, over_budget, message}`, or `{error}`. Length, version, check, size, types, ranges and cost
/// are checked in this order.
///
/// # Errors
/// Never for any text.
#[wasm_bindgen]
pub fn open_link(fragment: &str) -> Result<JsValue, JsError> {
    object(&opened(fragment).unwrap_or_else(|error| Opened::Error { error: error.to_string() }))
}

fn opened(fragment: &str) -> Result<Opened, LinkError> {
    let Packed { json, version } = unpack(fragment)?;
    let scenario = Scenario::from_json_of(&json, version).map_err(LinkError::Scenario)?;
    let cost = RunCost::of(Experiment::new(&scenario).map_err(LinkError::Scenario)?.cost());
    let (over_budget, message) = (cost.over_budget, cost.message);
    Ok(Opened::Scenario { scenario: scenario.to_json(), over_budget, message })
}

#[wasm_bindgen]
impl Judged {
    /// The scenario's link: what stands behind the `#`.
    ///
    /// # Errors
    /// If the scenario cannot be read, or is too large for a link.
    pub fn link(&self) -> Result<String, JsError> {
        if self.0.unread().is_empty() {
            Ok(pack(&self.0.scenario().to_compact_json())?)
        } else {
            Err(LinkError::Scenario(self.0.unread().to_vec()).into())
        }
    }
}
