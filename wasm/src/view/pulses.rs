//! The signals of a run for the logic view: pixel columns, edges, and the pulse at a cycle.

use crate::{
    convert::{field, object},
    view::simulation::Simulation,
};
use js_sys::Object;
use stepscope_core::inspect::trace::{changes::Edge, edges::Signals};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Simulation {
    /// The signals over a stretch of cycles, in columns: `{high, low, last}`, two words a column, with `margin`
    /// further columns of the same width at each side. Those before cycle 0 have no levels.
    #[must_use]
    pub fn pulses(&self, start_cycle: f64, end_cycle: f64, columns_asked: u32, margin: u32) -> Object {
        let Signals { trace, changes } = self.signals();
        let found = changes.columns(
            trace,
            start_cycle.max(0.0) as u64,
            end_cycle.max(1.0) as u64,
            columns_asked.clamp(1, 10_000) as usize,
            margin.min(10_000) as usize,
        );
        let result = Object::new();
        words(&result, "high", &found.high);
        words(&result, "low", &found.low);
        words(&result, "last", &found.last);
        result
    }

    /// Cycle of the next edge of signal `bit` after (or the last before) `cycle`; kind is `any`,
    /// `rise` or `fall`.
    #[must_use]
    pub fn next_edge(&self, bit: u8, cycle: f64, forward: bool, kind: &str) -> Option<f64> {
        let edge = match kind {
            "rise" => Edge::Rise,
            "fall" => Edge::Fall,
            _ => Edge::Any,
        };
        self.signals().next(bit, cycle.max(0.0) as u64, forward, edge).map(|cycle| cycle as f64)
    }

    /// The level of signal `bit` in a cycle, the edges that begin and end it, and the one after them: `{high, begin, end,
    /// next}`, cycles, null where there is none.
    ///
    /// # Errors
    /// Never in practice.
    pub fn pulse_at(&self, bit: u8, cycle: f64) -> Result<JsValue, JsError> {
        object(&self.signals().pulse_at(bit, cycle.max(0.0) as u64))
    }

    /// The first edges after `cycle`, or with `forward` false the last ones before it, in the order of time, of signal
    /// `bit` or of all signals: at least `most` of them where there are so many, and with them all of their cycles.
    /// `{rows: [{cycle, bit, high}], more}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn edges(&self, bit: Option<u8>, cycle: f64, forward: bool, most: u32) -> Result<JsValue, JsError> {
        let cycle = (cycle >= 0.0).then_some(cycle as u64);
        object(&self.signals().list(bit, cycle, forward, most as usize))
    }
}

impl Simulation {
    fn signals(&self) -> Signals<'_> {
        let selected = self.selected();
        Signals { trace: &selected.recording.trace, changes: &selected.changes }
    }
}

/// Adds an array of 64-bit words to an object, each as its low and its high half.
fn words(object: &Object, name: &str, values: &[u64]) {
    let halves: Vec<u32> = values.iter().flat_map(|word| [*word as u32, (*word >> 32) as u32]).collect();
    field(object, name, &js_sys::Uint32Array::from(halves.as_slice()));
}
