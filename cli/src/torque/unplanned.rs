//! Torque of steps without a plan: of packets, line scripts, segment lists.

use super::{arguments::Arguments, axis_demand::AxisDemand};
use crate::failure::{Failure, Numbered};
use crate::run_recording;
use stepscope_core::scenario::{Problem, Scenario, ValueError};
use stepscope_core::{inspect::motion::torque::Machine, peripheral::trace::steps, sim::Experiment};

/// The selected channels with steps, with the plant's motors or the named one: at least one.
pub(super) fn demands(arguments: &Arguments, scenario: &Scenario) -> Result<Vec<AxisDemand>, Failure> {
    let path = &arguments.scenario;
    let wrong = |problems| Failure::Scenario(path.clone(), problems);
    let refused = |field, detail| wrong(Problem::new(field, ValueError::Conflict { detail }).into());
    let channels = scenario.bus.channels;
    if let Some(channel) = arguments.axis.filter(|&channel| channel >= channels.into()) {
        return Err(Failure::index(path, Numbered::AxisChannels, channel, channels.into(), true));
    }
    let named = arguments.named.applied_to(scenario);
    if Machine::of_channel(&named, 0, 0).is_none() {
        let detail =
            "the scenario has no motor; use --motor, or \"plant\": {} for the motor of Song, Han and Lu 2021";
        return Err(refused("plant", detail));
    }
    let experiment = Experiment::new(scenario).map_err(wrong)?;
    let recording = run_recording::of(path, &experiment)?;
    let clock_hz = experiment.config().clock_hz();
    let selected =
        (0..channels).filter(|channel| arguments.axis.is_none_or(|only| only == usize::from(*channel)));
    let found: Vec<AxisDemand> = selected
        .filter_map(|channel| {
            let steps = Some(steps(&recording.trace, channel)).filter(|steps| !steps.is_empty())?;
            let machine = Machine::of_channel(&named, 0, channel.into())?;
            Some(AxisDemand::of_steps(channel, machine, &steps, clock_hz))
        })
        .collect();
    if found.is_empty() {
        let detail = "the selected channels make no step; use another --axis";
        return Err(refused("source", detail));
    }
    Ok(found)
}
