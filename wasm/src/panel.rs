//! Stand-alone controllers, run for the page, and their panels as the view Panel shows them (CONTROLLER.md G8): what each showed
//! when, what was switched, and how it stands in any cycle.

use crate::{
    advance::{advance, progress},
    convert::numbers,
    judged::{Judged, listed},
    plant::Behind,
};
use js_sys::Object;
use std::{mem::take, rc::Rc};
use stepscope_core::{
    controller::{StandAlone, panel::PanelRecord},
    inspect::plant_log::PlantLog,
    peripheral::{
        signal::{Event, Record, Sink},
        units::Instant,
    },
    scenario::{
        END_OF_TIME, Line, Scenario, SegmentLists, Source,
        presets::{CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS},
    },
    sim::{Experiment, Run},
};
use wasm_bindgen::prelude::*;

/// How often the machine is kept on its way at most, so that few questions have to begin at cycle 0.
const STOPS: usize = 64;

/// A preset of stand-alone controllers as JSON with every field written; undefined where there is none of this name.
#[wasm_bindgen]
#[must_use]
pub fn panel_preset(id: &str) -> Option<String> {
    let mut all = CONTROLLER_PRESETS.iter().chain(CONTROLLER_PLANT_PRESETS);
    Some(all.find(|preset| preset.id == id)?.scenario().to_json())
}

/// What a run makes, and what is switched at the panels.
#[derive(Default)]
struct Watched {
    records: Vec<Record>,
    inputs: Vec<(Instant, Event)>,
}

impl Sink for Watched {
    fn record(&mut self, record: Record) {
        self.records.push(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        if let Event::Input { .. } = event {
            self.inputs.push((at, event));
        }
    }
}

/// Nothing is kept.
struct Nowhere;

impl Sink for Nowhere {
    fn record(&mut self, _: Record) {}
}

/// A run of stand-alone controllers, made in slices. What it makes is handed on as records, to be looked at like a recording.
#[wasm_bindgen]
pub struct PanelRun {
    scenario: Rc<Scenario>,
    experiment: Rc<Experiment>,
    run: Run,
    watched: Watched,
    plant: Option<PlantLog>,
    /// The controllers at some cycles on their way, by slices of the run: each is about as much work.
    stops: Vec<StandAlone>,
    /// Slices from one of them to the next, and those since the last one.
    apart: usize,
    since: usize,
}

#[wasm_bindgen]
impl Judged {
    /// A run before its first cycle; undefined where no stand-alone controllers run the scenario.
    ///
    /// # Errors
    /// If the scenario has problems; `check` lists them.
    pub fn panels(&self) -> Result<Option<PanelRun>, JsError> {
        let experiment = self.0.experiment().map_err(listed)?;
        let run = experiment.start();
        Ok(run.stand_alone().is_some().then(|| PanelRun {
            scenario: Rc::clone(self.0.scenario()),
            experiment: Rc::clone(experiment),
            plant: run.plant(0).map(PlantLog::new),
            run,
            watched: Watched::default(),
            stops: Vec::new(),
            apart: 1,
            since: 0,
        }))
    }
}

#[wasm_bindgen]
impl PanelRun {
    /// Runs on until it has made about `max_records` more records, or its plant as many steps of its grid: `{done, cycle,
    /// end_cycle, records}`.
    ///
    /// # Errors
    /// If the run makes more records than a page can keep.
    pub fn advance(&mut self, max_records: u32) -> Result<JsValue, JsError> {
        self.keep_stop();
        let mut watched = [take(&mut self.watched)];
        let mut logs = [self.plant.as_mut()];
        let done = advance(&self.experiment, &mut self.run, max_records, &mut watched, &mut logs);
        [self.watched] = watched;
        if let (Some(log), Some(plant)) = (&mut self.plant, self.run.plant(0)) {
            log.keep(plant, self.watched.records.len());
        }
        progress(&self.experiment, &self.run, done, self.watched.records.len() as u64)
    }

    /// What the records are to be looked at with: the same scenario, run by nobody, as long as the run, and without its plant.
    #[must_use]
    pub fn frame(&self) -> String {
        let mut frame = Scenario::clone(&self.scenario);
        frame.source = Source::Segments(SegmentLists::default());
        // What comes after the last cycle that a scenario may name, nobody looks at.
        frame.run_cycles = Some(self.run.cycles().0.clamp(1, END_OF_TIME));
        frame.line = Line::default();
        frame.plant = None;
        frame.to_json()
    }

    /// Records from one on, 16 bytes each: cycle and levels, little-endian.
    #[must_use]
    pub fn records(&self, from: usize, count: usize) -> Vec<u8> {
        let records = self.watched.records.get(from..).unwrap_or_default();
        let records = &records[..records.len().min(count)];
        let mut bytes = Vec::with_capacity(16 * records.len());
        for record in records {
            bytes.extend_from_slice(&record.cycle.0.to_le_bytes());
            bytes.extend_from_slice(&record.levels.0.to_le_bytes());
        }
        bytes
    }

    /// The records are elsewhere now: here only a plant has further use for them.
    pub fn records_are_taken(&mut self) {
        if self.plant.is_none() {
            self.watched.records = Vec::new();
        }
    }

    /// What became of a panel: `records` (cycle, word, position, display of each), `inputs` (cycle, number, raw level of each
    /// change), `ignored` (cycle, number, state of each press that did nothing), `writes` (of each cell of its memory);
    /// undefined where there is no such controller.
    #[must_use]
    pub fn panel(&self, controller: usize) -> Option<Object> {
        let machine = self.run.stand_alone().filter(|machine| controller < machine.controllers())?;
        let record = |&PanelRecord { cycle, word, position, display }: &PanelRecord| {
            [cycle.0 as f64, word.0 as f64, position as f64, display as f64]
        };
        let result = Object::new();
        numbers(&result, "records", &machine.panel(controller).iter().flat_map(record).collect::<Vec<_>>());
        let ignored = machine.ignored(controller).iter();
        let ignored = ignored
            .flat_map(|press| [press.cycle.0, press.button as u64, press.state as u64].map(|x| x as f64));
        numbers(&result, "ignored", &ignored.collect::<Vec<_>>());
        let writes = machine.writes(controller).iter().copied().map(f64::from);
        numbers(&result, "writes", &writes.collect::<Vec<_>>());
        let mut inputs = Vec::new();
        for &(at, event) in &self.watched.inputs {
            if let Event::Input { controller: whose, input, level } = event
                && usize::from(whose) == controller
            {
                inputs.extend([at.0 as f64, f64::from(input), f64::from(u8::from(level))]);
            }
        }
        numbers(&result, "inputs", &inputs);
        Some(result)
    }

    /// How a controller stands at the beginning of a cycle: word, position, display, place and error
    /// of its axis, pulses a unit, decimals, whether its windings are powered, loops and groups of its program.
    #[must_use]
    pub fn panel_at(&self, controller: usize, cycle: f64) -> Option<Vec<f64>> {
        let cycle = Instant(cycle.max(0.0) as u64);
        let mut machine = self.stops.iter().rfind(|stop| stop.now() <= cycle)?.clone();
        machine.run(cycle, &mut Nowhere);
        let numbers = machine.numbers(controller);
        Some(vec![
            machine.word(controller)?.0 as f64,
            f64::from(machine.position(controller)?),
            machine.display(controller)? as f64,
            machine.axis_place(controller)? as f64,
            machine.axis_error(controller)? as f64,
            f64::from(*numbers.first()?),
            f64::from(*numbers.get(1)?),
            f64::from(u8::from(machine.enabled(controller)?)),
            f64::from(*numbers.get(6)?),
            f64::from(*numbers.get(7)?),
        ])
    }

    /// What the plant came to; null where there is none.
    ///
    /// # Errors
    /// Never in practice.
    pub fn plant(&self) -> Result<JsValue, JsError> {
        self.behind().report()
    }

    /// Values of its supply and of a motor over a stretch of cycles, as those of a simulation.
    #[must_use]
    pub fn plant_curves(&self, channel: usize, from: f64, to: f64, columns: usize) -> Option<Object> {
        self.behind().curves(channel, from, to, columns)
    }

    /// The same values at the last point of the plant's grid up to a cycle.
    #[must_use]
    pub fn plant_at(&self, channel: usize, cycle: f64) -> Option<Object> {
        self.behind().at(channel, cycle)
    }
}

impl PanelRun {
    fn behind(&self) -> Behind<'_> {
        let Self { experiment, run, plant, watched, .. } = self;
        Behind { experiment, run, controller: 0, log: plant.as_ref(), trace: &watched.records }
    }

    /// Keeps the machine as it is now, if it has come far enough since it was kept last.
    fn keep_stop(&mut self) {
        let Some(machine) = self.run.stand_alone() else { return };
        self.since += 1;
        if !self.stops.is_empty() && self.since < self.apart {
            return;
        }
        self.since = 0;
        let mut stop = machine.clone();
        // What its panel has shown, the run has.
        for index in 0..stop.controllers() {
            stop.take_panel(index);
        }
        self.stops.push(stop);
        if self.stops.len() > STOPS {
            // Every other one goes, and the next come half as often.
            let mut index = 0;
            self.stops.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.apart *= 2;
        }
    }
}
