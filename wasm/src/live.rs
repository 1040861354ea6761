//! Real serial lines (LIVE H1, H3, H4): the host of a device and the device of a host. Times are in ms since the start.

mod device;
mod host;
mod raw;

pub use device::LiveDevice;
pub use host::LiveHost;
pub use raw::LiveRawHost;

use stepscope_core::peripheral::config::Protocol;
use stepscope_core::scenario::{Problem, Scenario};
use wasm_bindgen::prelude::*;

const SEGMENTS: &str = "segments send nothing; choose ticks as the step generation in the form";
const SCRIPT: &str =
    "the replies to a line script are unknown; choose a motion or packets as the source in the form";

/// Whether the host of a scenario sends raw packets, without replies. Errors: if it cannot be read.
#[wasm_bindgen]
pub fn live_is_raw(json: &str) -> Result<bool, JsError> {
    Ok(read(json)?.line.protocol == Protocol::Raw)
}

fn nanos(ms: f64) -> u64 {
    (ms.max(0.0) * 1e6) as u64
}

fn listed(problems: &[Problem]) -> JsError {
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    JsError::new(&lines.join("; "))
}

fn read(json: &str) -> Result<Scenario, JsError> {
    Scenario::from_json(json).map_err(|problems| listed(&problems))
}
