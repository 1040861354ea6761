//! Real lines, for a worker that has their ports: the host of a device ([`LiveHost`]), and the device of a host
//! ([`LiveDevice`]). Bytes and times come in, bytes and times go out; what is said and when, the core decides (LIVE H1, H3, H4).
//!
//! Times are in ms since the beginning, as `performance.now()` gives them.

mod device;
mod host;

pub use device::LiveDevice;
pub use host::LiveHost;

use stepscope_core::scenario::{Problem, Scenario};
use wasm_bindgen::prelude::*;

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
