//! A run held against another one: what a link's sender saw.

use crate::{convert::object, view::simulation::Simulation};
use serde::Serialize;
use stepscope_core::inspect::trace::{
    fingerprint::{Fingerprint, Mark, Shorter},
    run_fingerprint::{RunFingerprint, VERSION, Verification},
};
use stepscope_core::peripheral::signal::Sink;
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
