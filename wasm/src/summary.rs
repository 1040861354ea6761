//! What a run came to, in short: of each controller, and of the host of a framed line.

use crate::{
    convert::object,
    simulation::{Kept, Simulation},
};
use serde::Serialize;
use stepscope_core::{
    inspect::timing::TimingCheck,
    peripheral::{
        config::{Config, Protocol},
        device::Device,
        signal::{MAX_CHANNELS, Record},
    },
    sim::framed_host::{Counts, FramedHost, Progress},
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Summary {
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
    /// On a framed line.
    state: Option<&'static str>,
    /// Bits of the signals that change at all.
    changing: Vec<u8>,
    /// Of the scenario's driver, if it names one.
    violations: Option<u64>,
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
    /// Index of the controller.
    controller: usize,
    ticks: usize,
    acknowledged: u32,
    progress: &'static str,
    /// Why the host gave up, if it did.
    why: Option<String>,
}

#[wasm_bindgen]
impl Simulation {
    /// What the run came to: `{framed, end_cycle, end_s, clock_hz, line_load, host, controllers}`. The
    /// controllers are in the order of the scenario, each with its address (or null), digest, records, edges,
    /// channels, positions, faults `{bits, names}`, ticks_done, state (null on a raw line), changing (the
    /// bits of the signals that change at all) and violations (null without a driver). The host is null
    /// where nobody waits for replies, else `{frames, repeated, replies, rejected, crashes, jobs}`, with a job
    /// `{controller, ticks, acknowledged, progress, why}` for each controller that has something to do;
    /// progress is `opening`, `filling`, `confirming`, `done` or `given_up`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn summary(&self) -> Result<JsValue, JsError> {
        let config = self.experiment.config();
        let cycles = self.run.cycles().0;
        let each = self.kept.iter().zip(self.run.devices()).zip(self.experiment.configs());
        // Where segments run the scenario there is one controller, and no device moves.
        let alone = self.experiment.segments().map(|_| self.run.positions());
        let each = each.map(|((kept, device), config)| {
            controller(kept, device, config, alone.unwrap_or_else(|| device.positions()))
        });
        object(&Summary {
            framed: config.protocol() == Protocol::Framed,
            end_cycle: cycles,
            end_s: cycles as f64 / f64::from(config.clock_hz()),
            clock_hz: config.clock_hz(),
            line_load: self.experiment.line_load(),
            host: self.run.host().map(|host| self.host(host)),
            controllers: each.collect(),
        })
    }

    fn host(&self, host: &FramedHost) -> Host {
        let Counts { frames, repeated, replies, rejected, refused, crashes } = host.counts();
        let ticks = self.experiment.configs().enumerate().map(|(controller, config)| {
            (controller, self.experiment.ticks_of(controller).len() / usize::from(config.channels().max(1)))
        });
        // The host has a job for each controller that has ticks to do.
        let jobs = ticks.filter(|(_, ticks)| *ticks > 0).zip(host.progress()).zip(host.acknowledged());
        let jobs = jobs.map(|(((controller, ticks), progress), acknowledged)| {
            let (progress, why) = match progress {
                Progress::Opening => ("opening", None),
                Progress::Filling => ("filling", None),
                Progress::Confirming => ("confirming", None),
                Progress::Done => ("done", None),
                Progress::GivenUp(why) => ("given_up", Some(why.to_string())),
            };
            Job { controller, ticks, acknowledged, progress, why }
        });
        Host { frames, repeated, replies, rejected, refused, crashes, jobs: jobs.collect() }
    }
}

fn controller(kept: &Kept, device: &Device, config: &Config, positions: [i32; MAX_CHANNELS]) -> Controller {
    let faults = device.faults();
    Controller {
        address: config.address(),
        digest: format!("{:016x}", kept.recording.digest.value()),
        records: kept.recording.digest.records(),
        edges: edges(&kept.recording.trace),
        channels: config.channels(),
        positions: positions.iter().take(usize::from(config.channels())).copied().collect(),
        faults: Faults { bits: faults.bits(), names: faults.names().collect() },
        ticks_done: device.ticks_done(),
        state: device.status().map(|status| status.state.name()),
        changing: changing(&kept.recording.trace),
        violations: kept.timing.as_ref().map(TimingCheck::total),
    }
}

/// Changes of single signals in a trace.
fn edges(trace: &[Record]) -> u64 {
    trace
        .windows(2)
        .map(|pair| match pair {
            [a, b] => u64::from((a.levels.0 ^ b.levels.0).count_ones()),
            _ => 0,
        })
        .sum()
}

/// Bits of the signals that are not the same in all records.
fn changing(trace: &[Record]) -> Vec<u8> {
    let first = trace.first().map_or(0, |record| record.levels.0);
    let mask = trace.iter().fold(0, |mask, record| mask | (record.levels.0 ^ first));
    (0..64).filter(|bit| mask >> bit & 1 == 1).collect()
}
