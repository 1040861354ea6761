//! Sends the packets of a table again.

use stepscope_core::scenario::{LineScript, Scenario};
use stepscope_core::sim::replayed;
use wasm_bindgen::prelude::*;

/// A scenario that sends the packets of an exported table to the controllers of `json`.
/// Errors: with the first invalid line of the table.
#[wasm_bindgen]
pub fn replay(table: &str, json: &str) -> Result<String, JsError> {
    let (scenario, _) = Scenario::from_json_lenient(json);
    let script = LineScript::recorded(table, scenario.clock_hz)?;
    let mut again = replayed(scenario, script);
    // The bytes already contain the effect of glitches.
    again.line.glitches.clear();
    Ok(again.to_json())
}
