//! Compares a recording with a scenario's run.

use super::arguments::Arguments;
use crate::{failure::Failure, run_recording};
use std::{path::Path, rc::Rc};
use stepscope_core::{
    inspect::recording::{
        events::{self, Events},
        loaded_capture::LoadedCapture,
        tolerance::Tolerance,
    },
    scenario::Scenario,
    sim::Experiment,
};

pub(super) struct Beside {
    pub(super) recorded: Events,
    pub(super) model: Events,
    pub(super) found: events::EventComparison,
    pub(super) within: Tolerance,
}

impl Beside {
    pub(super) fn of(
        arguments: &Arguments,
        recording: &LoadedCapture,
        path: &Path,
        (scenario, experiment): &(Rc<Scenario>, Rc<Experiment>),
    ) -> Result<Self, Failure> {
        let run = run_recording::of(path, experiment)?;
        let recorded = recording.events(arguments.channel);
        let baud = recording
            .report
            .rx()
            .map(|line| line.baud)
            .filter(|baud| *baud > 0)
            .unwrap_or(scenario.line.baud);
        let (kind, clock_hz) = (recorded.kind, experiment.config().clock_hz());
        let model = Events::of_records(&run.trace, clock_hz, kind, arguments.channel, baud);
        let cycle = Tolerance::cycle(recorded.clock_hz, clock_hz);
        let within = arguments.within_us.map_or(cycle, |given| given.0);
        let found = recorded.compare(&model, arguments.align, within).ok_or_else(|| {
            let (what, one) = (kind.plural(), kind.singular());
            let (channel, own, planned) = (arguments.channel, recorded.len(), model.len());
            arguments.wrong(match arguments.align {
                Some(step) if own > 0 && planned > 0 => format!(
                    "--align: {step} is out of range; the plan has {planned} {what}, from 0, and the recording {own}; use a {one} that both have"
                ),
                _ => format!(
                    "channel {channel}: {own} {what} recorded and {planned} planned, so there is nothing to compare; map a channel to STEP{channel}, or use another --channel"
                ),
            })
        })?;
        Ok(Self { recorded, model, found, within })
    }
}
