//! A run in the worker. The views show one controller at a time.

use crate::convert::records;
use crate::scenario::{ValidatedScenario, listed};
use crate::view::advance::{advance, progress};
use crate::view::panel_log::PanelLog;
use std::{mem::take, sync::Arc};
use stepscope_core::{
    inspect::{
        packets::packet_table::Filter,
        plant::log::PlantLog,
        recording::replies,
        trace::{changes::Changes, drivers, run_sink::RunSink, stored_run::StoredRun, timing::TimingCheck},
    },
    peripheral::{
        config::Config,
        signal::{Event, Levels, Record, Sink},
        trace::{Digest, Step, steps},
        units::Instant,
    },
    scenario::Scenario,
    sim::{Experiment, Run},
};
use wasm_bindgen::prelude::*;

/// Maximum timing violations with details.
const MAX_VIOLATIONS: usize = 1000;

/// The run of a scenario.
#[wasm_bindgen]
pub struct Simulation {
    pub(crate) scenario: Arc<Scenario>,
    pub(crate) experiment: Arc<Experiment>,
    pub(crate) run: Run,
    /// One per controller; never empty.
    pub(crate) recordings: Vec<ControllerRecording>,
    /// Index of the visible controller.
    pub(crate) selected: usize,
    pub(crate) filter: Filter,
    /// Records shown instead of the first controller's; empty once they are used.
    pub(crate) recorded: Option<Vec<Record>>,
    processed: usize,
    pub(crate) panels: PanelLog,
    /// Recorded replies for [`replies::replace`]; empty once they are used.
    pub(crate) replies: Option<Vec<u8>>,
    is_simulated: bool,
}

/// Records a run and the inputs of panels.
struct RunRecorder {
    run: RunSink,
    inputs: Vec<(Instant, Event)>,
}

impl Sink for RunRecorder {
    fn record(&mut self, record: Record) {
        self.run.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        if let Event::Input { .. } = event {
            self.inputs.push((at, event));
        } else {
            self.run.event(at, event);
        }
    }
}

#[derive(Default)]
pub(crate) struct ControllerRecording {
    pub(crate) stored: StoredRun,
    pub(crate) changes: Changes,
    pub(crate) timing: Option<TimingCheck>,
    pub(crate) plant: Option<PlantLog>,
    steps: Vec<Option<Vec<Step>>>,
}

impl ControllerRecording {
    pub(crate) fn count_steps(&mut self, channel: u8) {
        if let Some(counted) = self.steps.get_mut(usize::from(channel))
            && counted.is_none()
        {
            *counted = Some(steps(&self.stored.trace, channel));
        }
    }

    /// Final positions, from the steps in the trace.
    pub(crate) fn positions(&self) -> Vec<i32> {
        let mut positions = vec![0_i32; self.steps.len()];
        let mut before = Levels(0);
        for record in &self.stored.trace {
            let mut rises = record.levels.step() & !before.step();
            while rises != 0 {
                let channel = rises.trailing_zeros();
                rises &= rises - 1;
                if let Some(position) = positions.get_mut(channel as usize) {
                    let is_right = record.levels.dir() >> channel & 1 == 1;
                    *position = position.wrapping_add(if is_right { 1 } else { -1 });
                }
            }
            before = record.levels;
        }
        positions
    }

    fn show(&mut self, recorded: Vec<Record>, timing: Option<TimingCheck>) {
        (self.stored.trace, self.stored.digest) = (recorded, Digest::default());
        (self.timing, self.changes) = (timing, Changes::default());
    }

    /// Processes records `from..to` of the recording.
    fn process(&mut self, from: usize, to: usize) {
        let Some(known) = self.stored.trace.get(..to) else { return };
        for record in known.iter().skip(from) {
            self.stored.digest.record(*record);
            self.timing.record(*record);
        }
        self.changes.extend(known);
    }

    pub(crate) fn steps_of(&self, channel: u8) -> &[Step] {
        self.steps.get(usize::from(channel)).and_then(Option::as_deref).unwrap_or_default()
    }
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// A run before its first cycle. Errors: if the scenario has problems; `check` lists them.
    pub fn run(&self) -> Result<Simulation, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        Ok(Simulation::of(self.0.scenario(), experiment))
    }
}

#[wasm_bindgen]
impl Simulation {
    /// Runs for about `max_records` more records (`advance`), then processes as many of a recording. Returns the progress.
    /// Errors: if the run has too many records.
    pub fn advance(&mut self, max_records: u32) -> Result<JsValue, JsError> {
        if self.is_simulated {
            self.process(max_records as usize);
        } else {
            self.run_slice(max_records);
        }
        let done = self.is_simulated && self.processed == self.recorded_count();
        if done {
            self.finish();
        }
        let records = self.recordings.iter().map(|recorded| recorded.stored.digest.records()).sum();
        progress(&self.experiment, &self.run, done, records)
    }

    /// Adds records of 16 bytes (cycle and levels, little-endian) to show instead of the run. `room` is the maximum of all
    /// records, since a growing vector needs twice the memory.
    pub fn record(&mut self, bytes: &[u8], room: u32) {
        let recorded = self.recorded.get_or_insert_default();
        recorded.reserve_exact(room as usize);
        recorded.extend(records(bytes));
    }

    /// Sets recorded replies ([`replies::replace`]) to show instead of the run's replies.
    pub fn set_replies(&mut self, bytes: Vec<u8>) {
        self.replies = Some(bytes);
    }

    /// Selects a controller, if it exists.
    pub fn select(&mut self, controller: u32) {
        if (controller as usize) < self.recordings.len() {
            self.selected = controller as usize;
            self.filter = Filter::default();
        }
    }
}

impl Simulation {
    fn run_slice(&mut self, max_records: u32) {
        self.panels.save_stop(self.run.stand_alone());
        let recorder = |recorded: &mut ControllerRecording| RunRecorder {
            run: RunSink { stored: take(&mut recorded.stored), timing: recorded.timing.take() },
            inputs: Vec::new(),
        };
        let mut recorders: Vec<RunRecorder> = self.recordings.iter_mut().map(recorder).collect();
        let mut logs: Vec<_> = self.recordings.iter_mut().map(|recorded| recorded.plant.as_mut()).collect();
        let done = advance(&self.experiment, &mut self.run, max_records, &mut recorders, &mut logs);
        for (recorded, recorder) in self.recordings.iter_mut().zip(recorders) {
            let RunRecorder { run: RunSink { stored, timing }, inputs } = recorder;
            self.panels.inputs.extend(inputs);
            recorded.changes.extend(&stored.trace);
            (recorded.stored, recorded.timing) = (stored, timing);
        }
        for (index, recorded) in self.recordings.iter_mut().enumerate() {
            if let (Some(log), Some(plant)) = (&mut recorded.plant, self.run.plant(index)) {
                log.snapshot(plant, recorded.stored.trace.len());
            }
        }
        if done && let (Some(recorded), Some(first)) = (&mut self.recorded, self.recordings.first_mut()) {
            first.show(take(recorded), drivers::check(&self.scenario, MAX_VIOLATIONS));
        }
        self.is_simulated = done;
    }

    fn recorded_count(&self) -> usize {
        let first = self.recordings.first().filter(|_| self.recorded.is_some());
        first.map_or(0, |first| first.stored.trace.len())
    }

    /// Processes `count` more records of the recording.
    fn process(&mut self, count: usize) {
        let (from, until) = (self.processed, self.processed.saturating_add(count).min(self.recorded_count()));
        if let Some(first) = self.recordings.first_mut() {
            first.process(from, until);
        }
        self.processed = until;
    }

    /// Sorts packets and sets recorded replies.
    fn finish(&mut self) {
        let recorded_replies = self.replies.as_mut().map(take);
        for (index, recorded) in self.recordings.iter_mut().enumerate() {
            let packets = &mut recorded.stored.packets;
            packets.finish();
            if let Some(bytes) = &recorded_replies {
                replies::replace(bytes, &self.experiment, &self.run, index, packets);
            }
        }
    }

    /// A run before its first cycle.
    pub(crate) fn of(scenario: &Arc<Scenario>, experiment: &Arc<Experiment>) -> Self {
        let run = experiment.start();
        let recording = |(index, config): (usize, &Config)| ControllerRecording {
            stored: StoredRun::default(),
            changes: Changes::default(),
            timing: drivers::check(scenario, MAX_VIOLATIONS),
            plant: run.plant(index).map(PlantLog::new),
            steps: vec![None; usize::from(config.channels())],
        };
        let recordings = experiment.configs().enumerate().map(recording).collect();
        Self {
            scenario: Arc::clone(scenario),
            run,
            recordings,
            experiment: Arc::clone(experiment),
            selected: 0,
            filter: Filter::default(),
            recorded: None,
            processed: 0,
            panels: PanelLog::default(),
            replies: None,
            is_simulated: false,
        }
    }

    pub(crate) fn selected(&self) -> &ControllerRecording {
        &self.recordings[self.selected]
    }
}
