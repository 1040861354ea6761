//! Real lines, for a worker that has their ports: the host of a device ([`LiveHost`], [`LiveRawHost`]), and the device of a host
//! ([`LiveDevice`]). Bytes and times come in, bytes and times go out; what is said and when, the core decides (LIVE H1, H3, H4).
//!
//! Times are in ms since the beginning, as `performance.now()` gives them.

mod device;
mod host;
mod raw;

pub use device::LiveDevice;
pub use host::LiveHost;
pub use raw::LiveRawHost;

use stepscope_core::{
    peripheral::config::Protocol,
    scenario::{Problem, Scenario},
};
use wasm_bindgen::prelude::*;

/// Why there is nothing to send.
const SEGMENTS: &str = "segments run a controller by itself: there is nothing to send; in the form choose ticks as the engine of the motion";
/// Why a script is not sent.
const SCRIPT: &str = "a line script is sent as it stands, and nobody knows what is to be answered; in the form choose a motion or packets as the source";

/// Whether a scenario's host sends raw packets, which nobody answers.
///
/// # Errors
/// If it cannot be read.
#[wasm_bindgen]
pub fn live_is_raw(json: &str) -> Result<bool, JsError> {
    Ok(read(json)?.line.protocol == Protocol::Raw)
}

fn nanos(ms: f64) -> u64 {
    (ms.max(0.0) * 1e6) as u64
}

/// All problems, in one sentence.
fn listed(problems: &[Problem]) -> JsError {
    let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
    JsError::new(&lines.join("; "))
}

fn read(json: &str) -> Result<Scenario, JsError> {
    Scenario::from_json(json).map_err(|problems| listed(&problems))
}
