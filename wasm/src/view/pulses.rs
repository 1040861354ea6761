//! Signals of a run for the logic view.

use crate::convert::{field, object};
use crate::view::simulation::Simulation;
use js_sys::Object;
use stepscope_core::inspect::trace::{changes::Edge, edges::Signals};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Simulation {
    /// Signals in columns: `{high, low, last}`, two words per column, with `margin` additional columns at each side.
    pub fn pulses(&self, start_cycle: f64, end_cycle: f64, column_count: u32, margin: u32) -> Object {
        let Signals { trace, changes } = self.signals();
        let found = changes.columns(
            trace,
            start_cycle.max(0.0) as u64,
            end_cycle.max(1.0) as u64,
            column_count.clamp(1, 10_000) as usize,
            margin.min(10_000) as usize,
        );
        let result = Object::new();
        words(&result, "high", &found.high);
        words(&result, "low", &found.low);
        words(&result, "last", &found.last);
        result
    }

    /// Cycle of the next or previous edge of signal `bit`; kind is `any`, `rise` or `fall`.
    pub fn next_edge(&self, bit: u8, cycle: f64, forward: bool, kind: &str) -> Option<f64> {
        let edge = match kind {
            "rise" => Edge::Rise,
            "fall" => Edge::Fall,
            _ => Edge::Any,
        };
        self.signals().next(bit, cycle.max(0.0) as u64, forward, edge).map(|cycle| cycle as f64)
    }

    /// The pulse of signal `bit` at a cycle: `{high, begin, end, next}`, with the cycles of its edges and the next one.
    pub fn pulse_at(&self, bit: u8, cycle: f64) -> Result<JsValue, JsError> {
        object(&self.signals().pulse_at(bit, cycle.max(0.0) as u64))
    }

    /// The next or previous edges of signal `bit` or of all signals: at least `most`, with all edges of their cycles.
    pub fn edges(&self, bit: Option<u8>, cycle: f64, forward: bool, most: u32) -> Result<JsValue, JsError> {
        let cycle = (cycle >= 0.0).then_some(cycle as u64);
        object(&self.signals().list(bit, cycle, forward, most as usize))
    }
}

impl Simulation {
    fn signals(&self) -> Signals<'_> {
        let selected = self.selected();
        Signals { trace: &selected.stored.trace, changes: &selected.changes }
    }
}

/// Adds 64-bit words to an object as low and high halves.
fn words(object: &Object, name: &str, values: &[u64]) {
    let halves: Vec<u32> = values.iter().flat_map(|word| [*word as u32, (*word >> 32) as u32]).collect();
    field(object, name, &js_sys::Uint32Array::from(halves.as_slice()));
}
