//! `stepscope run --line`: what was done to the line in a run, as a scenario of its own.

use crate::{failure::Failure, files};
use std::{io::Write, path::Path};
use stepscope_core::{
    run::{Experiment, Run},
    scenario::{Glitch, Hex, LineScript, Noise, Scenario, ScriptedSend, Source},
};

/// Writes the scenario that gives the same traces without host, noise and motion.
pub(crate) fn write(
    path: &Path,
    scenario: Scenario,
    experiment: &Experiment,
    run: &Run,
) -> Result<(), Failure> {
    let scripted = scripted(scenario, experiment, run);
    // A long noisy run may have more forced levels than a scenario may.
    scripted.check().map_err(|problems| Failure::Scenario(path.to_owned(), problems))?;
    let write = || {
        let mut out = files::create(path)?;
        writeln!(out, "{}", scripted.to_json())?;
        out.flush()
    };
    write().map_err(|error| Failure::File(path.to_owned(), error))
}

/// The scenario with its host's schedule as its source (DESIGN A9), or with its lists of segments.
fn scripted(mut scenario: Scenario, experiment: &Experiment, run: &Run) -> Scenario {
    if let Some(segments) = experiment.segments() {
        scenario.source = Source::Segments(segments.into());
        return scenario;
    }
    let sends = run
        .schedule()
        .iter()
        .filter(|send| !send.bytes.is_empty())
        .map(|send| ScriptedSend { start_cycle: send.start.0, bytes: Hex(send.bytes.to_vec()), frame: None })
        .collect();
    scenario.source = Source::Line(LineScript { sends });
    // What noise did is in the bytes and in the forced levels.
    scenario.line.noise = Noise::default();
    let glitch = |start_cycle, end, level| Glitch { start_cycle, length_cycles: end - start_cycle, level };
    scenario.line.glitches = run
        .forced()
        .iter()
        .map(|forced| glitch(forced.start.0, forced.end.0, u8::from(forced.level)))
        .collect();
    for controller in &mut scenario.controllers {
        controller.axes.clear();
        controller.packets.clear();
    }
    scenario
}
