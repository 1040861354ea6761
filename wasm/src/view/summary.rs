//! The summary of a run.

use crate::convert::object;
use crate::view::simulation::{ControllerRecording, Simulation};
use serde::Serialize;
use stepscope_core::{
    inspect::trace::{edges, timing::TimingCheck},
    sim::{
        ControllerSummary, JobSummary, Summary as RunSummary,
        framed_host::{Counts, Progress},
    },
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Summary {
    /// Whether records or replies are recorded.
    recorded: bool,
    framed: bool,
    end_cycle: u64,
    end_s: f64,
    clock_hz: u32,
    line_load: Option<f64>,
    host: Option<Host>,
    controllers: Vec<Controller>,
}

#[derive(Serialize)]
struct Controller {
    address: Option<u8>,
    digest: String,
    records: u64,
    edges: u64,
    channels: u8,
    positions: Vec<i32>,
    faults: Faults,
    ticks_done: u32,
    /// Only on a framed line.
    state: Option<&'static str>,
    /// Bits of the signals with edges.
    changing: Vec<u8>,
    /// Timing violations, if the scenario has a driver.
    violations: Option<u64>,
    /// Names of the violated rules.
    violated: Vec<&'static str>,
}

#[derive(Serialize)]
struct Faults {
    bits: u16,
    names: Vec<&'static str>,
}

#[derive(Serialize)]
struct Host {
    frames: u64,
    repeated: u64,
    replies: u64,
    rejected: u64,
    refused: u64,
    crashes: u64,
    jobs: Vec<Job>,
}

#[derive(Serialize)]
struct Job {
    controller: usize,
    ticks: usize,
    acknowledged: u32,
    progress: &'static str,
    /// Why the host gave up.
    why: Option<String>,
}

#[wasm_bindgen]
impl Simulation {
    /// The summary. `host` is null without replies; `progress` is a name of [`Progress`].
    pub fn summary(&self) -> Result<JsValue, JsError> {
        let digests = self.recordings.iter().map(|recorded| &recorded.stored.digest);
        let run = RunSummary::new(&self.experiment, &self.run, digests);
        let host = run.host.map(|counts| host(counts, &run.controllers));
        let mut controllers: Vec<Controller> =
            run.controllers.into_iter().zip(&self.recordings).map(controller).collect();
        if let (Some(_), Some(first), Some(shown)) =
            (&self.recorded, controllers.first_mut(), self.recordings.first())
        {
            first.positions = shown.positions();
        }
        object(&Summary {
            recorded: self.recorded.is_some() || self.replies.is_some(),
            framed: run.framed,
            end_cycle: run.cycles.0,
            end_s: run.cycles.0 as f64 / f64::from(run.clock_hz),
            clock_hz: run.clock_hz,
            line_load: run.line_load,
            host,
            controllers,
        })
    }
}

fn host(counts: Counts, controllers: &[ControllerSummary]) -> Host {
    let Counts { frames, repeated, replies, rejected, refused, crashes } = counts;
    let jobs = controllers.iter().enumerate().filter_map(|(index, controller)| {
        let JobSummary { ticks, acknowledged, progress } = controller.job?;
        let why = if let Progress::GivenUp(why) = progress { Some(why.to_string()) } else { None };
        Some(Job { controller: index, ticks, acknowledged, progress: progress.name(), why })
    });
    Host { frames, repeated, replies, rejected, refused, crashes, jobs: jobs.collect() }
}

fn violated(check: &TimingCheck) -> impl Iterator<Item = &'static str> {
    check.results().iter().filter(|result| result.total() > 0).map(|result| result.rule.name())
}

fn controller((summary, recorded): (ControllerSummary, &ControllerRecording)) -> Controller {
    Controller {
        address: summary.address,
        digest: format!("{:016x}", recorded.stored.digest.value()),
        records: recorded.stored.digest.records(),
        edges: edges::count(&recorded.stored.trace),
        channels: summary.channels,
        positions: summary.positions,
        faults: Faults { bits: summary.faults.bits(), names: summary.faults.names().collect() },
        ticks_done: summary.ticks_done,
        state: summary.status.map(|status| status.state.name()),
        changing: edges::changing(&recorded.stored.trace),
        violations: recorded.timing.as_ref().map(TimingCheck::total),
        violated: recorded.timing.iter().flat_map(violated).collect(),
    }
}
