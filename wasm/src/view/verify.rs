//! Compares a run with the run of a link's sender.

use crate::{convert::object, view::simulation::Simulation};
use serde::Serialize;
use stepscope_core::inspect::trace::fingerprint::{Fingerprint, Mark, Shorter};
use stepscope_core::inspect::trace::run_fingerprint::{RunFingerprint, VERSION, Verification};
use stepscope_core::peripheral::signal::Sink;
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct EdgePosition {
    edge: u64,
    cycle: u64,
}

impl From<Mark> for EdgePosition {
    fn from(mark: Mark) -> Self {
        Self { edge: mark.edges, cycle: mark.cycle.0 }
    }
}

#[derive(Serialize, Default)]
struct RunComparison {
    /// Why it cannot be compared.
    error: Option<String>,
    same: bool,
    edges: u64,
    version: Option<String>,
    own_version: &'static str,
    controller: usize,
    after: Option<EdgePosition>,
    until: Option<EdgePosition>,
    /// `this` or `other` run ends within the other.
    shorter: Option<&'static str>,
}

#[wasm_bindgen]
impl Simulation {
    /// The part `d` of a link: the digests of all controllers.
    pub fn fingerprint(&self) -> String {
        RunFingerprint::of(
            self.recordings.iter().map(|recorded| Fingerprint::of(&recorded.stored.trace)).collect(),
        )
        .emit()
    }

    /// Compares the run with part `d` of a link. The first difference is between `after` and `until`.
    pub fn verify(&self, text: &str) -> Result<JsValue, JsError> {
        object(&self.comparison(text))
    }
}

impl Simulation {
    fn comparison(&self, text: &str) -> RunComparison {
        let sent = match RunFingerprint::parse(text) {
            Ok(fingerprint) => fingerprint,
            Err(error) => return RunComparison { error: Some(error.to_string()), ..Default::default() },
        };
        let version = sent.other_version().map(str::to_owned);
        let comparison = RunComparison { version, own_version: VERSION, ..Default::default() };
        let own = self.recordings.len();
        let mut checks = match sent.checks(own) {
            Ok(checks) => checks,
            Err(controllers) => {
                let error = format!(
                    "the link has digests of {controllers} controllers, but this experiment has {own}; request a new link"
                );
                return RunComparison { error: Some(error), ..comparison };
            }
        };
        for (check, recorded) in checks.iter_mut().zip(&self.recordings) {
            recorded.stored.trace.iter().for_each(|record| check.record(*record));
        }
        match Verification::of(checks) {
            Verification::Same { edges } => RunComparison { same: true, edges, ..comparison },
            Verification::Differs { controller, after, until, shorter } => {
                let shorter = shorter.map(|shorter| match shorter {
                    Shorter::This => "this",
                    Shorter::Other => "other",
                });
                let (after, until) = (Some(after.into()), Some(until.into()));
                RunComparison { controller, after, until, shorter, ..comparison }
            }
        }
    }
}
