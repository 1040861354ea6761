//! Replays a run's line as a scenario with the same traces, without host, noise and motion (DESIGN A9).

use crate::{Experiment, Run};
use stepscope_scenario::{Glitch, Hex, LineScript, Noise, Scenario, ScriptedSend, Source};

/// The scenario with the sent bytes and forced levels as its source, or with its segment lists. Stand-alone controllers
/// keep their source. The result may have more forced levels than are valid.
pub fn scripted(mut scenario: Scenario, experiment: &Experiment, run: &Run) -> Scenario {
    if run.stand_alone().is_some() {
        return scenario;
    }
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
    scenario.line.glitches = run
        .forced()
        .iter()
        .map(|forced| Glitch {
            start_cycle: forced.start.0,
            length_cycles: forced.end.0 - forced.start.0,
            level: u8::from(forced.level),
        })
        .collect();
    replayed(scenario, LineScript { sends })
}

/// Replaces the source with the script and clears the noise, because the bytes already contain its effect.
pub fn replayed(mut scenario: Scenario, script: LineScript) -> Scenario {
    scenario.source = Source::Line(script);
    scenario.line.noise = Noise::default();
    for controller in &mut scenario.controllers {
        controller.axes.clear();
        controller.packets.clear();
    }
    scenario
}
