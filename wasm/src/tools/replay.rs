//! Packets of a table, to be sent again.

use stepscope_core::{
    scenario::{LineScript, Scenario},
    sim::replayed,
};
use wasm_bindgen::prelude::*;

/// The scenario that sends the packets of a table, as a run exports it, to the controllers of the scenario
/// `json`.
///
/// # Errors
/// With the first line of the table that cannot be used.
#[wasm_bindgen]
pub fn replay(table: &str, json: &str) -> Result<String, JsError> {
    let (scenario, _) = Scenario::from_json_lenient(json);
    let script = LineScript::recorded(table, scenario.clock_hz)?;
    let mut again = replayed(scenario, script);
    // The bytes are those that were heard: what struck them faults only once.
    again.line.glitches.clear();
    Ok(again.to_json())
}
