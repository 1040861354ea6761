//! Torque of steps without a plan: of packets, line scripts, segment lists.

use super::{arguments::Arguments, driven::Driven};
use crate::{
    failure::{Failure, Numbered},
    kept_run,
};
use stepscope_core::{
    inspect::motion::torque::Machine,
    peripheral::trace::steps,
    scenario::{Problem, Scenario, ValueError},
    sim::Experiment,
};

/// The selected channels with steps, with the plant's motors or the named one: at least one.
pub(super) fn driven(arguments: &Arguments, scenario: &Scenario) -> Result<Vec<Driven>, Failure> {
    let path = &arguments.scenario;
    let wrong = |problems| Failure::Scenario(path.clone(), problems);
    let refused = |field, detail| wrong(vec![Problem::new(field, ValueError::Conflict { detail })]);
    let channels = scenario.bus.channels;
    if let Some(channel) = arguments.axis.filter(|&channel| channel >= channels.into()) {
        return Err(Failure::index(path, Numbered::AxisChannels, channel, channels.into(), true));
    }
    let named = arguments.named.named(scenario);
    if Machine::of_channel(&named, 0, 0).is_none() {
        let detail = "no motor; give one, such as \"plant\": {} for that of Song, Han and Lu 2021, or --motor (stepscope plant --motors lists them)";
        return Err(refused("plant", detail));
    }
    let experiment = Experiment::new(scenario).map_err(wrong)?;
    let recording = kept_run::of(path, &experiment)?;
    let clock_hz = experiment.config().clock_hz();
    let asked =
        (0..channels).filter(|channel| arguments.axis.is_none_or(|only| only == usize::from(*channel)));
    let found: Vec<Driven> = asked
        .filter_map(|channel| {
            let steps = Some(steps(&recording.trace, channel)).filter(|steps| !steps.is_empty())?;
            let machine = Machine::of_channel(&named, 0, channel.into())?;
            Some(Driven::of_steps(channel, machine, &steps, clock_hz))
        })
        .collect();
    if found.is_empty() {
        let detail = "no channel that was asked for makes a step, so no motor is asked for anything; give another --axis";
        return Err(refused("source", detail));
    }
    Ok(found)
}
