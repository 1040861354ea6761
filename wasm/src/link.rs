//! Links: a scenario to a fragment and back.

use crate::convert::object;
use serde::Serialize;
use stepscope_core::{
    inspect::judgement::RunCost,
    scenario::link::{LinkError, decode, part, with_part},
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

/// A link with another part behind it, where it does not become too long to be read.
#[wasm_bindgen]
#[must_use]
pub fn link_with(link: String, name: &str, text: &str) -> String {
    with_part(link, name, text)
}

/// The scenario of a fragment: `{scenario, over_budget, message}`, or `{error}` with what is wrong
/// with the link. Every step is judged before the next: length, version, check, size, types,
/// ranges, cost.
///
/// # Errors
/// Never for any text.
#[wasm_bindgen]
pub fn decode_link(fragment: &str) -> Result<JsValue, JsError> {
    let opened = decode(fragment).and_then(|scenario| {
        let cost = RunCost::of(Experiment::new(&scenario).map_err(LinkError::Scenario)?.cost());
        Ok(Opened::Scenario {
            scenario: scenario.to_json(),
            over_budget: cost.over_budget,
            message: cost.message,
        })
    });
    object(&opened.unwrap_or_else(|error| Opened::Error { error: error.to_string() }))
}
