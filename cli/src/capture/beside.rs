//! A recording beside a scenario's run.

use super::arguments::Arguments;
use crate::{failure::Failure, kept_run, scenarios};
use std::path::Path;
use stepscope_core::inspect::recording::{
    events::{self, Events},
    opened::Opened,
    tolerance::Tolerance,
};

/// A recording's steps, or bytes, beside a model's.
pub(super) struct Beside {
    pub(super) recorded: Events,
    pub(super) model: Events,
    pub(super) found: events::Beside,
    pub(super) within: Tolerance,
}

impl Beside {
    /// The recording beside the run of a scenario.
    pub(super) fn of(arguments: &Arguments, recording: &Opened, path: &Path) -> Result<Self, Failure> {
        let (scenario, experiment) = scenarios::judged(path)?;
        let run = kept_run::of(path, &experiment)?;
        let recorded = recording.events(arguments.channel);
        let baud = recording.report.rx().map_or(scenario.line.baud, |line| line.baud);
        let (kind, clock_hz) = (recorded.kind, experiment.config().clock_hz());
        let model = Events::of_records(&run.trace, clock_hz, kind, arguments.channel, baud);
        let cycle = Tolerance::cycle(recorded.clock_hz, clock_hz);
        let within = arguments.within_us.map_or(cycle, |given| given.0);
        let found = recorded.beside(&model, arguments.align, within).ok_or_else(|| {
            arguments.wrong(format!(
                "channel {} has {} {} recorded and {} in the model: there is no {} {} in both; map a channel to STEP{}, or give another --channel or --align",
                arguments.channel,
                recorded.len(),
                kind.plural(),
                model.len(),
                kind.singular(),
                arguments.align,
                arguments.channel,
            ))
        })?;
        Ok(Self { recorded, model, found, within })
    }
}
