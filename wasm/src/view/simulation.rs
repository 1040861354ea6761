//! A run in the worker: made in slices, kept for the views' questions. The views look at one
//! controller at a time.

use crate::{
    convert::records,
    judged::{Judged, listed},
    view::{
        advance::{advance, progress},
        panel_log::PanelLog,
    },
};
use std::{mem::take, rc::Rc};
use stepscope_core::{
    inspect::{
        packets::packet_table::Filter,
        plant::log::PlantLog,
        recording::replies,
        trace::{changes::Changes, drivers, run_sink::RunSink, stored_run::Recording, timing::TimingCheck},
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
    /// How many records of it are taken in.
    taken_in: usize,
    /// The panels of stand-alone controllers.
    pub(crate) panels: PanelLog,
    /// Replies that were recorded, as [`replies::put`] takes them; none of them left once they are in their place.
    pub(crate) replies: Option<Vec<u8>>,
    /// The run is at its end; what was recorded is taken in, or has been.
    is_made: bool,
}

/// Records a run, and what is switched at the panels of stand-alone controllers.
struct Watched {
    run: RunSink,
    inputs: Vec<(Instant, Event)>,
}

impl Sink for Watched {
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

    /// Where its motors stand at the end, by their steps in the trace.
    pub(crate) fn positions(&self) -> Vec<i32> {
        let mut positions = vec![0_i32; self.steps.len()];
        let mut before = Levels(0);
        for record in &self.recording.trace {
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

    /// Shows what was recorded in place of what was made, once it is taken in.
    fn show(&mut self, recorded: Vec<Record>, timing: Option<TimingCheck>) {
        (self.recording.trace, self.recording.digest) = (recorded, Digest::default());
        (self.timing, self.changes) = (timing, Changes::default());
    }

    /// Takes in the records from one place to another of what is shown.
    fn take_in(&mut self, from: usize, to: usize) {
        let Some(known) = self.recording.trace.get(..to) else { return };
        for record in known.iter().skip(from) {
            self.recording.digest.record(*record);
            self.timing.record(*record);
        }
        self.changes.extend(known);
    }

    /// Steps of a channel, once they are counted.
    pub(crate) fn steps_of(&self, channel: u8) -> &[Step] {
        self.steps.get(usize::from(channel)).and_then(Option::as_deref).unwrap_or_default()
    }
}

#[wasm_bindgen]
impl Judged {
    /// A run before its first cycle.
    ///
    /// # Errors
    /// If the scenario has problems; `check` lists them.
    pub fn run(&self) -> Result<Simulation, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        Ok(Simulation::of(self.0.scenario(), experiment))
    }
}

#[wasm_bindgen]
impl Simulation {
    /// Runs on until one controller has made about `max_records` more records, or its plant as many steps of its grid; then takes
    /// in as many of what was recorded: `{done, cycle, end_cycle, records}`, the records those of all controllers.
    ///
    /// # Errors
    /// If the run makes more records than a page can keep.
    pub fn advance(&mut self, max_records: u32) -> Result<JsValue, JsError> {
        if self.is_made {
            self.take_in(max_records as usize);
        } else {
            self.make(max_records);
        }
        let done = self.is_made && self.taken_in == self.to_take_in();
        if done {
            self.finish();
        }
        let records = self.recordings.iter().map(|one| one.recording.digest.records()).sum();
        progress(&self.experiment, &self.run, done, records)
    }

    /// Records of a recording, which are looked at in place of what the run makes: 16 bytes each, cycle and levels,
    /// little-endian; piece after piece, before the run. `room` says how many come at most, these among them: a vector that grows
    /// by itself takes twice the memory.
    pub fn record(&mut self, bytes: &[u8], room: u32) {
        let recorded = self.recorded.get_or_insert_default();
        recorded.reserve_exact(room as usize);
        recorded.extend(records(bytes));
    }

    /// What was recorded on TX, in the place of what the controllers reply ([`replies::put`]), nothing where they were silent;
    /// before the run.
    pub fn answer(&mut self, bytes: Vec<u8>) {
        self.replies = Some(bytes);
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
    /// Runs on.
    fn make(&mut self, max_records: u32) {
        self.panels.save_stop(self.run.stand_alone());
        let watched = |one: &mut ControllerRecording| Watched {
            run: RunSink { recording: take(&mut one.recording), timing: one.timing.take() },
            inputs: Vec::new(),
        };
        let mut watched: Vec<Watched> = self.recordings.iter_mut().map(watched).collect();
        let mut logs: Vec<_> = self.recordings.iter_mut().map(|one| one.plant.as_mut()).collect();
        let done = advance(&self.experiment, &mut self.run, max_records, &mut watched, &mut logs);
        for (one, watched) in self.recordings.iter_mut().zip(watched) {
            let Watched { run: RunSink { recording, timing }, inputs } = watched;
            self.panels.inputs.extend(inputs);
            one.changes.extend(&recording.trace);
            (one.recording, one.timing) = (recording, timing);
        }
        for (index, one) in self.recordings.iter_mut().enumerate() {
            if let (Some(log), Some(plant)) = (&mut one.plant, self.run.plant(index)) {
                log.keep(plant, one.recording.trace.len());
            }
        }
        if done && let (Some(recorded), Some(first)) = (&mut self.recorded, self.recordings.first_mut()) {
            first.show(take(recorded), drivers::check(&self.scenario, MAX_KEPT));
        }
        self.is_made = done;
    }

    /// How many records were recorded.
    fn to_take_in(&self) -> usize {
        let first = self.recordings.first().filter(|_| self.recorded.is_some());
        first.map_or(0, |first| first.recording.trace.len())
    }

    /// Takes in so many more of what was recorded.
    fn take_in(&mut self, count: usize) {
        let (from, until) = (self.taken_in, self.taken_in.saturating_add(count).min(self.to_take_in()));
        if let Some(first) = self.recordings.first_mut() {
            first.take_in(from, until);
        }
        self.taken_in = until;
    }

    /// Everything is there: packets are in their order, and the replies are those that were recorded.
    fn finish(&mut self) {
        let recorded = self.replies.as_mut().map(take);
        for (index, one) in self.recordings.iter_mut().enumerate() {
            let packets = &mut one.recording.packets;
            packets.finish();
            if let Some(bytes) = &recorded {
                replies::put(bytes, &self.experiment, &self.run, index, packets);
            }
        }
    }

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
            taken_in: 0,
            panels: PanelLog::default(),
            replies: None,
            is_made: false,
        }
    }

    /// The controller that the views look at.
    pub(crate) fn selected(&self) -> &ControllerRecording {
        &self.recordings[self.selected]
    }
}
