//! A run held against another one: what a link's sender saw, and a trace that was saved.

use crate::{
    convert::object,
    simulation::{Simulation, config},
};
use serde::Serialize;
use stepscope_core::peripheral::signal::Sink;
use stepscope_core::{
    inspect::{
        fingerprint::{Fingerprint, Mark, Shorter},
        run_fingerprint::{RunFingerprint, VERSION, Verification},
        trace_diff::TraceDiff,
    },
    peripheral::signal,
};
use wasm_bindgen::prelude::*;

/// A place in a run.
#[derive(Serialize)]
struct Place {
    edge: u64,
    cycle: u64,
}

impl From<Mark> for Place {
    fn from(mark: Mark) -> Self {
        Self { edge: mark.edges, cycle: mark.cycle.0 }
    }
}

/// How the run stands to the sender's.
#[derive(Serialize, Default)]
struct Judged {
    /// Why it cannot be told.
    error: Option<String>,
    same: bool,
    /// Of all controllers.
    edges: u64,
    /// The sender's version, where it is another.
    version: Option<String>,
    own_version: &'static str,
    /// The controller that differs.
    controller: usize,
    after: Option<Place>,
    until: Option<Place>,
    /// `this` or `other` run ends within the other.
    shorter: Option<&'static str>,
}

/// How the run stands to a file.
#[derive(Serialize)]
struct Held {
    /// Rows that are the run's own.
    same: u64,
    start_cycle: u64,
    end_cycle: u64,
    goes_on: bool,
    difference: Option<Differs>,
}

#[derive(Serialize)]
struct Differs {
    line: u64,
    cycle: u64,
    /// Of each signal that differs its name, and its level in the file and in the run.
    signals: Vec<(String, u8, u8)>,
}

#[wasm_bindgen]
impl Simulation {
    /// The part `d` of a link: the digests of all controllers.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        RunFingerprint::of(
            self.recordings.iter().map(|recorded| Fingerprint::of(&recorded.recording.trace)).collect(),
        )
        .emit()
    }

    /// Holds the run against the part `d` of a link: `{error, same, edges, version, own_version,
    /// controller, after, until, shorter}`. `after` and `until` are places `{edge, cycle}` that the first
    /// difference lies between, `version` is the sender's where it is another than this.
    ///
    /// # Errors
    /// Never for any text.
    pub fn verify(&self, text: &str) -> Result<JsValue, JsError> {
        object(&self.judged(text))
    }

    /// Begins to hold the trace of a controller against a file.
    pub fn diff_begin(&mut self, controller: u32) {
        let index = (controller as usize).min(self.recordings.len() - 1);
        self.trace_diff = Some((index, TraceDiff::new(config(&self.experiment, index).channels())));
    }

    /// Takes a piece of the file; true if the rest is not needed.
    ///
    /// # Errors
    /// With the first line that cannot be read.
    pub fn diff_feed(&mut self, piece: &[u8]) -> Result<bool, JsError> {
        let Some((index, diff)) = &mut self.trace_diff else { return Ok(true) };
        Ok(diff.feed(&self.recordings[*index].recording.trace, piece)?)
    }

    /// The file is over: `{same, start_cycle, end_cycle, goes_on, difference: {line, cycle, signals: [[name,
    /// level in the file, level in the run]]} | null}`; null if none was begun.
    ///
    /// # Errors
    /// If there was nothing in it, or its last line cannot be read.
    pub fn diff_end(&mut self) -> Result<JsValue, JsError> {
        let Some((index, diff)) = self.trace_diff.take() else { return Ok(JsValue::NULL) };
        let outcome = diff.finish(&self.recordings[index].recording.trace)?;
        object(&Held {
            same: outcome.same,
            start_cycle: outcome.range.0.0,
            end_cycle: outcome.range.1.0,
            goes_on: outcome.goes_on,
            difference: outcome.difference.map(|difference| Differs {
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

impl Simulation {
    fn judged(&self, text: &str) -> Judged {
        let proof = match RunFingerprint::parse(text) {
            Ok(proof) => proof,
            Err(error) => return Judged { error: Some(error.to_string()), ..Judged::default() },
        };
        let version = proof.other_version().map(str::to_owned);
        let judged = Judged { version, own_version: VERSION, ..Judged::default() };
        let own = self.recordings.len();
        let mut checks = match proof.checks(own) {
            Ok(checks) => checks,
            Err(sent) => {
                let error = format!(
                    "the sender's digests are of {sent} controllers, this experiment has {own}; they are left out"
                );
                return Judged { same: true, error: Some(error), ..judged };
            }
        };
        for (check, recorded) in checks.iter_mut().zip(&self.recordings) {
            recorded.recording.trace.iter().for_each(|record| check.record(*record));
        }
        match Verification::of(checks) {
            Verification::Same { edges } => Judged { same: true, edges, ..judged },
            Verification::Differs { controller, after, until, shorter } => {
                let shorter = shorter.map(|shorter| match shorter {
                    Shorter::This => "this",
                    Shorter::Other => "other",
                });
                let (after, until) = (Some(after.into()), Some(until.into()));
                Judged { controller, after, until, shorter, ..judged }
            }
        }
    }
}
