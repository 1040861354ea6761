//! The signals of a run for the logic view: pixel columns, edges, and the pulse at a cycle. No question looks
//! at more records than its answer needs, however many there are.

use crate::{
    convert::{object, words},
    simulation::Simulation,
};
use js_sys::Object;
use serde::Serialize;
use stepscope_core::{
    inspect::changes::Edge,
    peripheral::{signal::Record, trace::levels_at, units::Instant},
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Pulse {
    high: bool,
    begin: Option<u64>,
    end: Option<u64>,
    next: Option<u64>,
}

#[derive(Serialize)]
struct EdgeRow {
    cycle: u64,
    bit: u32,
    high: bool,
}

#[derive(Serialize)]
struct Edges {
    rows: Vec<EdgeRow>,
    /// Whether there are more in the direction that was asked for.
    more: bool,
}

#[wasm_bindgen]
impl Simulation {
    /// The signals over a stretch of cycles, in columns: `{high, low, last}`, two words a column, with `margin`
    /// further columns of the same width at each side. Those before cycle 0 have no levels.
    #[must_use]
    pub fn pulses(&self, start_cycle: f64, end_cycle: f64, columns_asked: u32, margin: u32) -> Object {
        let kept = self.selected();
        let found = kept.changes.columns(
            &kept.recording.trace,
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
        self.edge(bit, cycle.max(0.0) as u64, forward, edge).map(|cycle| cycle as f64)
    }

    /// The level of signal `bit` in a cycle, the edges that begin and end it, and the one after them: `{high, begin, end,
    /// next}`, cycles, null where there is none.
    ///
    /// # Errors
    /// Never in practice.
    pub fn pulse_at(&self, bit: u8, cycle: f64) -> Result<JsValue, JsError> {
        let at = cycle.max(0.0) as u64;
        let end = self.edge(bit, at, true, Edge::Any);
        object(&Pulse {
            high: self.level(bit, at),
            begin: self.edge(bit, at.saturating_add(1), false, Edge::Any),
            end,
            next: end.and_then(|end| self.edge(bit, end, true, Edge::Any)),
        })
    }

    /// The first edges after `cycle`, or with `forward` false the last ones before it, in the order of time, of signal
    /// `bit` or of all signals: at least `most` of them where there are so many, and with them all of their cycles.
    /// `{rows: [{cycle, bit, high}], more}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn edges(&self, bit: Option<u8>, cycle: f64, forward: bool, most: u32) -> Result<JsValue, JsError> {
        let trace = &self.selected().recording.trace;
        let at = cycle.max(-1.0);
        let mut index = match (forward, at < 0.0) {
            (true, true) => 1,
            (true, false) => trace.partition_point(|record| record.cycle.0 <= at as u64).max(1),
            (false, _) => trace.partition_point(|record| record.cycle.0 < at.max(0.0) as u64),
        };
        let mut rows = Vec::new();
        let mut more = false;
        loop {
            let found = match (bit, forward) {
                (Some(bit), _) => self.edge_at(bit, trace, index, forward),
                (None, true) => (index < trace.len()).then_some(index),
                (None, false) => index.checked_sub(1).filter(|&index| index > 0),
            };
            let Some(found) = found else { break };
            if rows.len() >= most as usize {
                more = true;
                break;
            }
            let (before, now) = (levels(trace, found - 1), levels(trace, found));
            let bits = (0..36).filter(|place| (before ^ now) >> place & 1 == 1);
            let shown = bits.filter(|&place| bit.is_none_or(|bit| u32::from(bit) == place));
            let cycle = trace.get(found).map_or(0, |record| record.cycle.0);
            let edge = |place| EdgeRow { cycle, bit: place, high: now >> place & 1 == 1 };
            // Backwards the rows are turned round in the end, also those of one cycle.
            let edges: Vec<EdgeRow> =
                if forward { shown.map(edge).collect() } else { shown.rev().map(edge).collect() };
            rows.extend(edges);
            index = if forward { found + 1 } else { found };
        }
        if !forward {
            rows.reverse();
        }
        object(&Edges { rows, more })
    }
}

fn levels(trace: &[Record], index: usize) -> u64 {
    trace.get(index).map_or(0, |record| record.levels.0)
}

impl Simulation {
    /// Index of a signal's first edge from record `index` on, or of its last one before.
    fn edge_at(&self, bit: u8, trace: &[Record], index: usize, forward: bool) -> Option<usize> {
        let changes = &self.selected().changes;
        if forward {
            changes.next_edge(trace, bit, trace.get(index.checked_sub(1)?)?.cycle.0, Edge::Any)
        } else {
            let after = trace.get(index).map_or(u64::MAX, |record| record.cycle.0);
            changes.previous_edge(trace, bit, after, Edge::Any)
        }
    }

    fn edge(&self, bit: u8, cycle: u64, forward: bool, edge: Edge) -> Option<u64> {
        let kept = self.selected();
        let trace = &kept.recording.trace;
        let found = if forward {
            kept.changes.next_edge(trace, bit, cycle, edge)
        } else {
            kept.changes.previous_edge(trace, bit, cycle, edge)
        };
        found.and_then(|index| trace.get(index)).map(|record| record.cycle.0)
    }

    /// Level of a signal in a cycle.
    fn level(&self, bit: u8, cycle: u64) -> bool {
        levels_at(&self.selected().recording.trace, Instant(cycle)).has(1 << bit.min(63))
    }
}
