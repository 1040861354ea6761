//! Links: a scenario to a fragment and back. What a fragment holds is one thing, and what scenario that is another: it may be
//! one of a module that links are not in.

use crate::{convert::object, judged::Judged};
use serde::Serialize;
#[cfg(feature = "run")]
use stepscope_core::scenario::link::{Packed, pack, part, unpack, with_part};
use stepscope_core::{
    inspect::judgement::RunCost,
    scenario::{Scenario, link::LinkError},
    sim::Experiment,
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
#[serde(untagged)]
enum Opened {
    Scenario { scenario: String, over_budget: bool, message: String },
    Error { error: String },
}

#[cfg(feature = "run")]
#[derive(Serialize)]
#[serde(untagged)]
enum Unpacked {
    Json { json: String, version: u64 },
    Error { error: String },
}

/// Another part of a fragment, such as `v`, as its writer meant it: percent signs decoded, without what
/// a chat program put behind it.
#[cfg(feature = "run")]
#[wasm_bindgen]
#[must_use]
pub fn link_part(fragment: &str, name: &str) -> Option<String> {
    part(fragment, name)
}

/// A link with another part behind it, where it does not become too long to be read.
#[cfg(feature = "run")]
#[wasm_bindgen]
#[must_use]
pub fn link_with(link: String, name: &str, text: &str) -> String {
    with_part(link, name, text)
}

/// The link of a scenario's compact JSON (`Judged::link_json`): what stands behind the `#`.
///
/// # Errors
/// If it is too large for a link.
#[cfg(feature = "run")]
#[wasm_bindgen]
pub fn pack_link(json: &str) -> Result<String, JsError> {
    Ok(pack(json)?)
}

/// What a fragment holds, for `open_link`: `{json, version}`, or `{error}` with what is wrong with the link. Every step is
/// judged before the next: length, version, check, size.
///
/// # Errors
/// Never for any text.
#[cfg(feature = "run")]
#[wasm_bindgen]
pub fn unpack_link(fragment: &str) -> Result<JsValue, JsError> {
    object(&match unpack(fragment) {
        Ok(Packed { json, version }) => Unpacked::Json { json, version },
        Err(error) => Unpacked::Error { error: error.to_string() },
    })
}

/// The scenario of what a link held: `{scenario, over_budget, message}`, or `{error}` with what is wrong with it, after types,
/// ranges and cost.
///
/// # Errors
/// Never for any text.
#[wasm_bindgen]
pub fn open_link(json: &str, version: u32) -> Result<JsValue, JsError> {
    let read = Scenario::from_json_of(json, version.into());
    let opened = read.and_then(|scenario| {
        let cost = RunCost::of(Experiment::new(&scenario)?.cost());
        let (over_budget, message) = (cost.over_budget, cost.message);
        Ok(Opened::Scenario { scenario: scenario.to_json(), over_budget, message })
    });
    let refused = |problems| Opened::Error { error: LinkError::Scenario(problems).to_string() };
    object(&opened.unwrap_or_else(refused))
}

#[wasm_bindgen]
impl Judged {
    /// The scenario as a link has it, for `pack_link`.
    ///
    /// # Errors
    /// If the scenario cannot be read.
    pub fn link_json(&self) -> Result<String, JsError> {
        if self.0.unread().is_empty() {
            Ok(self.0.scenario().to_compact_json())
        } else {
            Err(LinkError::Scenario(self.0.unread().to_vec()).into())
        }
    }
}
