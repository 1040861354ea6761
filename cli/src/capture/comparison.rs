//! Compares a recording with a scenario's run.

use super::arguments::Arguments;
use crate::{failure::Failure, run_recording};
use std::{path::Path, sync::Arc};
use stepscope_core::inspect::recording::events::{self, Events};
use stepscope_core::inspect::recording::{loaded_capture::LoadedCapture, tolerance::Tolerance};
use stepscope_core::{scenario::Scenario, sim::Experiment};

/// A recording next to the plan: steps of a channel, or bytes.
pub(super) struct PlanComparison {
    pub(super) recorded: Events,
    pub(super) planned: Events,
    pub(super) result: events::EventComparison,
    pub(super) tolerance: Tolerance,
}

impl PlanComparison {
    pub(super) fn new(
        arguments: &Arguments,
        recording: &LoadedCapture,
        path: &Path,
        (scenario, experiment): &(Arc<Scenario>, Arc<Experiment>),
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
        let planned = Events::of_records(&run.trace, clock_hz, kind, arguments.channel, baud);
        let cycle = Tolerance::cycle(recorded.clock_hz, clock_hz);
        let tolerance = arguments.within_us.map_or(cycle, |given| given.0);
        let result = recorded.compare(&planned, arguments.align, tolerance).ok_or_else(|| {
            let (events, event, channel) = (kind.plural(), kind.singular(), arguments.channel);
            let (recorded, planned) = (recorded.len(), planned.len());
            arguments.invalid(match arguments.align {
                Some(step) if recorded > 0 && planned > 0 => format!(
                    "--align: {step} is out of range; the run has {planned} {events}, from 0, and the recording {recorded}; use a {event} that both have"
                ),
                _ => format!(
                    "channel {channel}: {recorded} {events} recorded and {planned} planned, so there is nothing to compare; map a channel to STEP{channel}, or use another --channel"
                ),
            })
        })?;
        Ok(Self { recorded, planned, result, tolerance })
    }
}
