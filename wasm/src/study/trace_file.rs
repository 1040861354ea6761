//! Compares a run with a saved trace.

use crate::convert::object;
use crate::scenario::{ValidatedScenario, config, listed};
use serde::Serialize;
use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::inspect::trace::{diff::TraceDiff, stored_run::record_run};
use stepscope_core::peripheral::signal;
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct TraceComparison {
    same: u64,
    start_cycle: u64,
    end_cycle: u64,
    goes_on: bool,
    difference: Option<TraceDifference>,
}

#[derive(Serialize)]
struct TraceDifference {
    line: u64,
    cycle: u64,
    /// Name, level in the file and level in the run of each different signal.
    signals: Vec<(String, u8, u8)>,
}

/// The trace of a controller, compared with a file in pieces.
#[wasm_bindgen]
pub struct TraceFile {
    recording: StoredRun,
    diff: TraceDiff,
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// Runs the scenario for the comparison. Errors: if the scenario has problems.
    pub fn trace_file(&self, controller: usize) -> Result<TraceFile, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        let (_, mut recordings) =
            record_run(experiment, experiment.controllers()).map_err(|why| JsError::new(&why.to_string()))?;
        let index = controller.min(recordings.len() - 1);
        let diff = TraceDiff::new(config(experiment, index).channels());
        Ok(TraceFile { recording: recordings.swap_remove(index), diff })
    }
}

#[wasm_bindgen]
impl TraceFile {
    /// Compares a piece of the file; true if the rest is not needed. Errors: with the first invalid line.
    pub fn feed(&mut self, piece: &[u8]) -> Result<bool, JsError> {
        Ok(self.diff.feed(&self.recording.trace, piece)?)
    }

    /// The result after the last piece. Errors: if the file is empty, or its last line is invalid.
    pub fn end(self) -> Result<JsValue, JsError> {
        let outcome = self.diff.finish(&self.recording.trace)?;
        object(&TraceComparison {
            same: outcome.same,
            start_cycle: outcome.range.0.0,
            end_cycle: outcome.range.1.0,
            goes_on: outcome.run_continues,
            difference: outcome.difference.map(|difference| TraceDifference {
                line: difference.line,
                cycle: difference.cycle.0,
                signals: (0..36)
                    .filter(|bit| difference.signals() >> bit & 1 == 1)
                    .map(|bit| {
                        let level = |levels: signal::Levels| u8::from(levels.has(1 << bit));
                        let name = signal::name(bit).unwrap_or_default();
                        (name, level(difference.file), level(difference.run))
                    })
                    .collect(),
            }),
        })
    }
}
