//! The runs of presets, with all that their views show, and the sample recordings.

use std::io::Cursor;
use stepscope_core::{
    capture::{
        read::{Limits, read},
        samples::Sample,
    },
    inspect::{
        motion::actual_motion::Pulses,
        plant::log::PlantLog,
        recording::{loaded_capture::LoadedCapture, open_options::OpenOptions},
        trace::stored_run::StoredRun,
    },
    peripheral::{
        signal::Record,
        trace::{Step, steps},
        units::Instant,
    },
    scenario::{Scenario, presets::Preset},
    sim::{Experiment, Run, RunLimits},
};

/// Records of one slice of a run, as in the page.
const RECORDS: u64 = 20_000;

/// A run to its end.
pub(crate) struct Shown {
    pub(crate) scenario: Scenario,
    pub(crate) experiment: Experiment,
    pub(crate) run: Run,
    pub(crate) stored: StoredRun,
    pub(crate) plant: Option<PlantLog>,
    steps: Vec<Vec<Step>>,
}

impl Shown {
    pub(crate) fn of(preset: &Preset) -> Self {
        let scenario = preset.scenario();
        let experiment = Experiment::new(&scenario).expect("presets are valid");
        let mut run = experiment.start();
        let mut plants: Vec<Option<PlantLog>> =
            (0..experiment.controllers()).map(|index| run.plant(index).map(PlantLog::new)).collect();
        let mut stored: Vec<StoredRun> =
            (0..experiment.controllers()).map(|_| StoredRun::default()).collect();
        loop {
            let mut logs: Vec<_> = plants.iter_mut().map(Option::as_mut).collect();
            let done = match experiment.plants() {
                None => run.advance_each(RECORDS, &mut stored),
                Some(plants) => {
                    let step = plants.setups.iter().map(|setup| u64::from(setup.grid_cycles())).min();
                    let cycle = Instant(run.cycles().0 + RECORDS * step.unwrap_or(1));
                    run.advance_observed(RunLimits { cycle, records: RECORDS }, &mut stored, &mut logs)
                }
            };
            for (index, (log, stored)) in plants.iter_mut().zip(&stored).enumerate() {
                if let (Some(log), Some(plant)) = (log, run.plant(index)) {
                    log.snapshot(plant, stored.trace.len());
                }
            }
            if done {
                break;
            }
        }
        let mut stored = stored.swap_remove(0);
        stored.packets.finish();
        let channels = experiment.config().channels();
        let steps = (0..channels).map(|channel| steps(&stored.trace, channel)).collect();
        Self { scenario, experiment, run, stored, plant: plants.swap_remove(0), steps }
    }

    pub(crate) fn hz(&self) -> f64 {
        f64::from(self.experiment.config().clock_hz())
    }

    /// Last cycle.
    pub(crate) fn end(&self) -> u64 {
        self.run.cycles().0
    }

    pub(crate) fn channels(&self) -> u8 {
        self.experiment.config().channels()
    }

    /// Time 0 of the motion.
    pub(crate) fn zero_s(&self) -> f64 {
        self.pulses(0).zero() as f64 / self.hz()
    }

    pub(crate) fn pulses(&self, channel: u8) -> Pulses<'_> {
        let steps = &self.steps[usize::from(channel)];
        let config = self.experiment.config();
        if self.experiment.stand_alone().is_some() {
            return Pulses::recorded(channel, steps, config.clock_hz());
        }
        let segments =
            self.experiment.segments().and_then(|segments| segments.lists().get(usize::from(channel)));
        Pulses::of_run(channel, steps, &self.stored.packets, segments, config)
    }
}

/// The signals of a sample.
pub(crate) fn recorded(sample: &Sample) -> Vec<Record> {
    let reading = read(Cursor::new(sample.bytes), &Limits::default(), &mut |_| true);
    let loaded = LoadedCapture::new(reading.capture, &OpenOptions::default()).expect("samples can be loaded");
    loaded.records
}
