//! A run in the worker: made in slices, kept for the views' questions. The views look at one
//! controller at a time.

use crate::convert::{object, records};
use serde::Serialize;
use std::{mem::take, rc::Rc};
use stepscope_core::{
    inspect::{
        changes::Changes, drivers, packet_table::Filter, plant_log::PlantLog, run_sink::RunSink,
        timing::TimingCheck,
    },
    peripheral::{
        config::Config,
        signal::{Record, Sink},
        trace::{Digest, Recording, Step, steps},
        units::Instant,
    },
    scenario::Scenario,
    sim::{Experiment, Run},
};
use wasm_bindgen::prelude::*;

/// Most records that a page keeps of all controllers together; 16 bytes each.
const MAX_RECORDS: u64 = 40_000_000;

/// Violations of the driver's timing that the page gets in full.
const MAX_KEPT: usize = 1000;

/// One scenario's run.
#[wasm_bindgen]
pub struct Simulation {
    pub(crate) scenario: Rc<Scenario>,
    pub(crate) experiment: Rc<Experiment>,
    pub(crate) run: Run,
    /// Of each controller, in the order of the scenario; never empty.
    pub(crate) recordings: Vec<ControllerRecording>,
    /// Index in `recordings` of the controller that the views look at.
    pub(crate) selected: usize,
    /// Which rows of its packets the table shows.
    pub(crate) filter: Filter,
    /// What was recorded, to be looked at in place of what the first controller makes; empty once that is done.
    pub(crate) recorded: Option<Vec<Record>>,
}

/// What is kept of one controller.
#[derive(Default)]
pub(crate) struct ControllerRecording {
    pub(crate) recording: Recording,
    /// Where its signals change.
    pub(crate) changes: Changes,
    /// The pulses against the scenario's driver, if it names one.
    pub(crate) timing: Option<TimingCheck>,
    /// What its motors did, if the scenario has a plant.
    pub(crate) plant: Option<PlantLog>,
    /// Steps of each channel, as far as they were asked for after the end.
    steps: Vec<Option<Vec<Step>>>,
}

impl ControllerRecording {
    pub(crate) fn count_steps(&mut self, channel: u8) {
        if let Some(place) = self.steps.get_mut(usize::from(channel))
            && place.is_none()
        {
            *place = Some(steps(&self.recording.trace, channel));
        }
    }

    /// Shows what was recorded in place of what was made.
    fn show(&mut self, recorded: Vec<Record>, mut timing: Option<TimingCheck>) {
        (self.recording.trace, self.recording.digest) = (recorded, Digest::default());
        for record in &self.recording.trace {
            self.recording.digest.record(*record);
            timing.record(*record);
        }
        (self.timing, self.changes) = (timing, Changes::default());
        self.changes.extend(&self.recording.trace);
    }

    /// Steps of a channel, once they are counted.
    pub(crate) fn steps_of(&self, channel: u8) -> &[Step] {
        self.steps.get(usize::from(channel)).and_then(Option::as_deref).unwrap_or_default()
    }
}

#[derive(Serialize)]
struct Progress {
    done: bool,
    cycle: u64,
    end_cycle: u64,
    records: u64,
}

#[wasm_bindgen]
impl Simulation {
    /// Runs on until one controller has made about `max_records` more records, or its plant as many steps of its grid:
    /// `{done, cycle, end_cycle, records}`, the records those of all controllers.
    ///
    /// # Errors
    /// If the run makes more records than a page can keep.
    pub fn advance(&mut self, max_records: u32) -> Result<JsValue, JsError> {
        let watched = |one: &mut ControllerRecording| RunSink {
            recording: take(&mut one.recording),
            timing: one.timing.take(),
        };
        let mut watched: Vec<RunSink> = self.recordings.iter_mut().map(watched).collect();
        let records = u64::from(max_records.max(1));
        let done = match self.experiment.plants() {
            None => self.run.advance_each(records, &mut watched),
            Some(plants) => {
                let step =
                    plants.setups.iter().map(|setup| u64::from(setup.grid_cycles())).min().unwrap_or(1);
                let target = Instant(self.run.cycles().0.saturating_add(records * step));
                let mut logs: Vec<_> = self.recordings.iter_mut().map(|one| one.plant.as_mut()).collect();
                self.run.advance_observed((target, records), &mut watched, &mut logs)
            }
        };
        for (one, RunSink { recording, timing }) in self.recordings.iter_mut().zip(watched) {
            one.changes.extend(&recording.trace);
            (one.recording, one.timing) = (recording, timing);
        }
        for (index, one) in self.recordings.iter_mut().enumerate() {
            if let (Some(log), Some(plant)) = (&mut one.plant, self.run.plant(index)) {
                log.keep(plant, one.recording.trace.len());
            }
        }
        let records: u64 = self.recordings.iter().map(|one| one.recording.digest.records()).sum();
        if records > MAX_RECORDS {
            return Err(JsError::new(&format!(
                "the run makes more than {MAX_RECORDS} edges, which is more than a page can keep; shorten the motion, or run it with the stepscope command"
            )));
        }
        if done && let (Some(recorded), Some(first)) = (&mut self.recorded, self.recordings.first_mut()) {
            first.show(take(recorded), drivers::check(&self.scenario, MAX_KEPT));
        }
        if done {
            self.recordings.iter_mut().for_each(|one| one.recording.packets.finish());
        }
        let cycle = self.run.cycles().0;
        object(&Progress {
            done,
            cycle,
            end_cycle: if done { cycle } else { self.experiment.cost().end_cycle.max(cycle) },
            records,
        })
    }

    /// Records of a recording, which are looked at in place of what the run makes: 16 bytes each, cycle and levels,
    /// little-endian; piece after piece, before the run.
    pub fn record(&mut self, bytes: &[u8]) {
        self.recorded.get_or_insert_default().extend(records(bytes));
    }

    /// The views look at this controller from now on, 0 the first; one that there is not leaves it as it
    /// is.
    pub fn select(&mut self, controller: u32) {
        if (controller as usize) < self.recordings.len() {
            self.selected = controller as usize;
            self.filter = Filter::default();
        }
    }
}

impl Simulation {
    /// A run of what was judged, before its first cycle.
    pub(crate) fn of(scenario: &Rc<Scenario>, experiment: &Rc<Experiment>) -> Self {
        let run = experiment.start();
        let recording = |(index, config): (usize, &Config)| ControllerRecording {
            recording: Recording::default(),
            changes: Changes::default(),
            timing: drivers::check(scenario, MAX_KEPT),
            plant: run.plant(index).map(PlantLog::new),
            steps: vec![None; usize::from(config.channels())],
        };
        let recordings = experiment.configs().enumerate().map(recording).collect();
        Self {
            scenario: Rc::clone(scenario),
            run,
            recordings,
            experiment: Rc::clone(experiment),
            selected: 0,
            filter: Filter::default(),
            recorded: None,
        }
    }

    /// The controller that the views look at.
    pub(crate) fn selected(&self) -> &ControllerRecording {
        &self.recordings[self.selected]
    }
}
