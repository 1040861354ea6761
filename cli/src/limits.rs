//! `stepscope settling`, `stepscope limits` and `stepscope resonance`: limits of the motors of a scenario's plant.

use crate::{
    failure::{Failure, Numbered, no_plant},
    json::Tables,
    motors::Replacing,
    options::{Json, Out, Work},
    output, parallel,
    progress::Progress,
    quantity::{Acceleration, PeakPart, Rate, whole},
    scenario_file, terminal,
};
use clap::Args;
use serde_json::json;
use std::{
    io::Write,
    num::NonZero,
    path::{Path, PathBuf},
};
use stepscope_core::{
    inspect::plant::outcome::settling as settling_of,
    plant::{
        Refused,
        parameters::{MotorModel, Setup},
        rates::{RAMP_STEPS_S2, Resonance, pulls, resonance as resonance_of, search, starts},
        settling::StepResponse,
    },
    scenario::{Cause, Problem, Scenario},
    sim::Experiment,
};

#[derive(Args)]
pub(crate) struct Common {
    /// Scenario with a plant: a JSON file or a preset's name; `-` reads standard input
    scenario: PathBuf,
    /// Channel of the motor, from 0 (default: all)
    #[arg(long, value_name = "K", value_parser = whole::<usize>(0..=u64::MAX))]
    channel: Option<usize>,
    #[command(flatten)]
    replacing: Replacing,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    work: Work,
}

#[derive(Args)]
pub(crate) struct SettlingArguments {
    #[command(flatten)]
    common: Common,
    /// Deviation that counts as settled, as a fraction of the peak
    #[arg(long, value_name = "PART", default_value = "0.2")]
    share: PeakPart,
    /// Step period, in cycles; the current is observed for 11 periods (default: a slot of the bus)
    #[arg(long, value_name = "CYCLES", value_parser = whole::<NonZero<u32>>(1..=u32::MAX.into()))]
    t_step: Option<NonZero<u32>>,
    /// Write the scenario with its bus.settle_cycles set to the longest settling time
    #[arg(short = 'o', long, alias = "write", value_name = "FILE")]
    write_scenario: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct LimitsArguments {
    #[command(flatten)]
    common: Common,
    /// Number of steps in each start-stop trial (default: one turn)
    #[arg(long, value_name = "N", value_parser = whole::<NonZero<u64>>(1..=MAX_STEPS))]
    steps: Option<NonZero<u64>>,
    /// Acceleration of the ramps in pull-out trials, in steps/s^2
    #[arg(long, value_name = "A", default_value = "200000")]
    ramp: Acceleration,
}

#[derive(Args)]
pub(crate) struct ResonanceArguments {
    #[command(flatten)]
    common: Common,
    /// Minimum rate, in full steps/s
    #[arg(long, value_name = "RATE", default_value = "20")]
    from: Rate,
    /// Maximum rate, in full steps/s
    #[arg(long, value_name = "RATE", default_value = "400")]
    to: Rate,
    /// Rate increment, in full steps/s
    #[arg(long, alias = "rung", value_name = "RATE", default_value = "4")]
    step: Rate,
    #[command(flatten)]
    out: Out,
}

// The default of --ramp.
const _: () = assert!(RAMP_STEPS_S2 == 200_000.0);

const MAX_RATES: f64 = 100_000.0;

/// A motor with a supply of its own, and all channels with an equal motor.
struct SingleMotor {
    channels: Vec<usize>,
    setup: Setup,
}

/// The distinct motors of the first controller's plant.
fn motors(common: &Common) -> Result<(Scenario, Experiment, Vec<SingleMotor>), Failure> {
    let path = &common.scenario;
    let (scenario, experiment) = common.replacing.validated(path)?;
    let plants = experiment.plants().ok_or_else(|| no_plant(path))?;
    let setup = plants.setups.first().cloned().unwrap_or_default();
    let count = setup.motors.len();
    if let Some(channel) = common.channel.filter(|&channel| channel >= count) {
        return Err(Failure::index(path, Numbered::Channels, channel, count, true));
    }
    let mut found: Vec<SingleMotor> = Vec::new();
    for (channel, motor) in setup.motors.iter().enumerate() {
        if common.channel.is_some_and(|only| only != channel) {
            continue;
        }
        match found.iter_mut().find(|alone| alone.setup.motors.first() == Some(motor)) {
            Some(alone) => alone.channels.push(channel),
            None => {
                found.extend(
                    setup.single_motor(channel).map(|setup| SingleMotor { channels: vec![channel], setup }),
                );
            }
        }
    }
    Ok((Scenario::clone(&scenario), Experiment::clone(&experiment), found))
}

fn on_threads<T: Send>(
    common: &Common,
    (what, unit): (&'static str, &str),
    count: usize,
    job: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, Failure> {
    let mut progress = Progress::new(what, common.work.show.progress);
    let done = parallel::each(count as u64, common.work.threads, &mut progress, |index| job(index as usize))
        .map_err(Failure::threads)?;
    progress.end(format_args!("{count} {unit}"), &[]);
    Ok(done)
}

fn refused(path: &Path, refused: Vec<Refused>) -> Failure {
    let problem = |refused| Problem::new("plant", Cause::Plant(refused));
    Failure::Scenario(path.to_owned(), refused.into_iter().map(problem).collect())
}

fn wrong_option(path: &Path, what: &str) -> Failure {
    Failure::Table(path.to_owned(), what.to_owned())
}

fn channels(alone: &SingleMotor) -> String {
    let all: Vec<String> = alone.channels.iter().map(usize::to_string).collect();
    all.join(", ")
}

pub(crate) fn settling(arguments: &SettlingArguments) -> Result<(), Failure> {
    let (common, path) = (&arguments.common, &arguments.common.scenario);
    let share = arguments.share.get();
    let to_standard = arguments.write_scenario.as_deref() == Some(Path::new(output::STANDARD));
    let (mut scenario, experiment, motors) = motors(common)?;
    let slot = experiment.config().tick().0 / u64::from(experiment.config().slots());
    let t_step = arguments.t_step.map_or(slot, |cycles| cycles.get().into());
    // A step is observed for 11 T_step; all samples are kept.
    for SingleMotor { setup, .. } in &motors {
        let grid = u64::from(setup.grid_cycles());
        if t_step < grid || 11 * t_step / grid > MAX_SAMPLES {
            let most = MAX_SAMPLES * grid / 11;
            let what = format!("--t-step: {t_step} cycles are out of range; use {grid} to {most}");
            return Err(wrong_option(path, &what));
        }
    }
    let all = on_threads(common, ("settling", "motors"), motors.len(), |index| {
        let alone = motors.get(index).ok_or_else(Vec::new)?;
        settling_of(&alone.setup, 0, t_step, share).map(|(found, _)| found)
    })?;
    let all: Vec<StepResponse> =
        all.into_iter().collect::<Result<_, _>>().map_err(|found| refused(path, found))?;
    if let Some(file) = &arguments.write_scenario {
        let greatest = all.iter().map(|response| response.reached).max().flatten();
        let settled = all.iter().all(|response| response.reached.is_some());
        // Like the self-test: T_step if a channel does not settle.
        let cycles = greatest.filter(|_| settled).unwrap_or(t_step);
        scenario.bus.settle_cycles = u32::try_from(cycles).unwrap_or(u32::MAX);
        let text = scenario_file::text(file, &scenario, "use a shorter scenario")?;
        output::write_new(file, |out| out.write_all(text.as_bytes()))?;
    }
    if to_standard {
        return Ok(());
    }
    let clock_hz = f64::from(experiment.config().clock_hz());
    if common.json.json {
        let rows = motors.iter().zip(&all).flat_map(|(alone, found)| {
            alone.channels.iter().map(move |channel| {
                json!({
                    "channel": channel, "t_step_cycles": t_step, "share": share, "rest_a": found.rest_a,
                    "least_a": found.min_a, "greatest_a": found.max_a, "reached_cycles": found.reached,
                    "settled_cycles": found.settled,
                })
            })
        });
        return Tables::of("settling").with("settling", rows).print();
    }
    let mut out = terminal::out();
    let time = |cycles: Option<u64>| {
        cycles.map_or_else(
            || "not within the observed time".to_owned(),
            |cycles| format!("{:.4} ms, {cycles} cycles", cycles as f64 / clock_hz * 1e3),
        )
    };
    for (alone, found) in motors.iter().zip(&all) {
        writeln!(
            out,
            "motor {}: {:.4} A at rest, {:.3} to {:.3} A after a step\n  reached  {}\n  settled  {}",
            channels(alone),
            found.rest_a,
            found.min_a,
            found.max_a,
            time(found.reached),
            time(found.settled)
        )
        .map_err(Failure::output)?;
    }
    Ok(())
}

pub(crate) fn limits(arguments: &LimitsArguments) -> Result<(), Failure> {
    let (common, path) = (&arguments.common, &arguments.common.scenario);
    let ramp = arguments.ramp.get();
    let (_, _, motors) = motors(common)?;
    let turn = |setup: &Setup| setup.motors.first().map_or(1, MotorModel::steps_per_turn);
    // The pull-out rates take longer, so they come first.
    let all = on_threads(common, ("limits", "searches"), 2 * motors.len(), |index| {
        let Some(alone) = motors.get(index / 2) else { return Ok(None) };
        let setup = &alone.setup;
        let steps = arguments.steps.map_or_else(|| turn(setup), NonZero::get);
        if index % 2 == 0 {
            search(|rate| pulls(setup, rate, ramp))
        } else {
            search(|rate| starts(setup, rate, steps))
        }
    })?;
    let all: Vec<Option<f64>> =
        all.into_iter().collect::<Result<_, _>>().map_err(|found| refused(path, found))?;
    let rows: Vec<(&SingleMotor, Option<f64>, Option<f64>)> = motors
        .iter()
        .zip(all.chunks(2))
        .map(|(alone, pair)| (alone, pair.get(1).copied().flatten(), pair.first().copied().flatten()))
        .collect();
    if common.json.json {
        let rows = rows.iter().flat_map(|(alone, start_stop, pull_out)| {
            alone.channels.iter().map(move |channel| {
                json!({ "channel": channel, "start_stop_steps_s": start_stop, "pull_out_steps_s": pull_out, "ramp_steps_s2": ramp })
            })
        });
        return Tables::of("limits").with("limits", rows).print();
    }
    let rate = |found: Option<f64>| {
        found.map_or_else(|| "below 500 steps/s".to_owned(), |rate| format!("{rate:.0} steps/s"))
    };
    let mut out = terminal::out();
    for (alone, start_stop, pull_out) in rows {
        let text = format!(
            "motor {}\n  start-stop rate  {}\n  pull-out rate    {}, by a ramp of {} steps/s^2\n",
            channels(alone),
            rate(start_stop),
            rate(pull_out),
            ramp
        );
        out.write_all(text.as_bytes()).map_err(Failure::output)?;
    }
    Ok(())
}

const MAX_SAMPLES: u64 = 10_000_000;
const MAX_STEPS: u64 = 10_000_000;
/// Maximum motor steps of a map (PLANT F1), and seconds per rate.
const MAX_MOTOR_STEPS: f64 = 1e10;
const RATE_S: f64 = 0.6;

pub(crate) fn resonance(arguments: &ResonanceArguments) -> Result<(), Failure> {
    let (common, path) = (&arguments.common, &arguments.common.scenario);
    let [from, to, step] = [arguments.from, arguments.to, arguments.step].map(Rate::get);
    let count = (to - from) / step + 1e-9;
    if !(to >= from && count < MAX_RATES) {
        let what = format!(
            "--from {from} --to {to} --step {step}: out of range; use a --to of at least --from, and at most {MAX_RATES} rates"
        );
        return Err(wrong_option(path, &what));
    }
    let (_, _, motors) = motors(common)?;
    let rates: Vec<f64> = (0..=count as u64).map(|index| from + index as f64 * step).collect();
    let points =
        |alone: &SingleMotor| RATE_S * f64::from(alone.setup.clock_hz) / f64::from(alone.setup.grid_cycles());
    let motor_steps = rates.len() as f64 * motors.iter().map(points).sum::<f64>();
    if motor_steps > MAX_MOTOR_STEPS {
        let what = format!(
            "the map needs {motor_steps:.2e} motor steps, more than {MAX_MOTOR_STEPS:e}; use a larger --step, or one --channel"
        );
        return Err(wrong_option(path, &what));
    }
    let all = on_threads(common, ("resonance", "rates"), rates.len() * motors.len(), |index| {
        let (alone, rate) = (motors.get(index / rates.len()), rates.get(index % rates.len()));
        let (Some(alone), Some(rate)) = (alone, rate) else { return Err(Vec::new()) };
        let microsteps = alone.setup.motors.first().map_or(1.0, |motor| f64::from(motor.microsteps));
        resonance_of(&alone.setup, rate * microsteps)
    })?;
    let all: Vec<Resonance> =
        all.into_iter().collect::<Result<_, _>>().map_err(|found| refused(path, found))?;
    let rows = motors.iter().zip(all.chunks(rates.len())).flat_map(|(alone, found)| {
        let rows = rates.iter().zip(found);
        alone
            .channels
            .iter()
            .flat_map(move |&channel| rows.clone().map(move |(rate, found)| (channel, rate, found)))
    });
    if common.json.json {
        let rows = rows.map(|(channel, rate, found)| {
            json!({ "channel": channel, "rate_full_steps_s": rate, "swing_full_steps": found.peak_to_peak, "loses_steps": found.loses_steps })
        });
        let tables = Tables::of("resonance").with("resonance", rows);
        return output::write_new(&arguments.out.out, |out| tables.write(out));
    }
    output::write_new(&arguments.out.out, |out| {
        writeln!(out, "channel,rate_full_steps_s,swing_full_steps,loses_steps")?;
        for (channel, rate, found) in rows {
            writeln!(out, "{channel},{rate},{},{}", found.peak_to_peak, u8::from(found.loses_steps))?;
        }
        Ok(())
    })
}
