//! `stepscope settling`, `stepscope limits` and `stepscope resonance`: limits of the motors of a scenario's plant.

use crate::failure::{Failure, Numbered, no_plant};
use crate::options::{Json, Out, Work};
use crate::quantity::{Acceleration, PeakPart, Rate, whole};
use crate::{
    json::Tables, motors::MotorReplacement, output, parallel, progress::Progress, scenario_file, terminal,
};
use clap::Args;
use serde_json::json;
use std::io::{self, Write};
use std::num::NonZero;
use std::path::{Path, PathBuf};
use stepscope_core::{
    inspect::plant::outcome::settling as settling_of,
    plant::{
        Refused,
        parameters::{MotorModel, Setup},
        rates::{RAMP_STEPS_S2, RESONANCE_S, pulls, resonance as resonance_of, search, starts},
        settling::StepResponse,
    },
    scenario::{Cause, Problem, Problems, Scenario},
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
    replacing: MotorReplacement,
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
/// Step periods for which the current is observed.
const OBSERVED_PERIODS: u64 = 11;

/// A motor with its own supply, and all channels with an equal motor.
struct SingleMotor {
    channels: Vec<usize>,
    setup: Setup,
}

/// Maximum rates in steps/s; `None` below 500.
struct MotorLimits<'a> {
    motor: &'a SingleMotor,
    start_stop: Option<f64>,
    pull_out: Option<f64>,
}

#[derive(Clone, Copy)]
enum LimitKind {
    StartStop,
    PullOut,
}

/// The distinct motors of the first controller's plant.
fn distinct_motors(common: &Common) -> Result<(Scenario, Experiment, Vec<SingleMotor>), Failure> {
    let path = &common.scenario;
    let (scenario, experiment) = common.replacing.validated(path)?;
    let plants = experiment.plants().ok_or_else(|| no_plant(path))?;
    let setup = plants.setups.first().cloned().unwrap_or_default();
    let count = setup.motors.len();
    if let Some(channel) = common.channel.filter(|&channel| channel >= count) {
        return Err(Failure::index(path, Numbered::Channels, channel, count, true));
    }
    let mut motors: Vec<SingleMotor> = Vec::new();
    for (channel, model) in setup.motors.iter().enumerate() {
        if common.channel.is_some_and(|only| only != channel) {
            continue;
        }
        if let Some(equal) = motors.iter_mut().find(|motor| motor.setup.motors.first() == Some(model)) {
            equal.channels.push(channel);
        } else if let Some(setup) = setup.single_motor(channel) {
            motors.push(SingleMotor { channels: vec![channel], setup });
        }
    }
    Ok((Scenario::clone(&scenario), Experiment::clone(&experiment), motors))
}

/// Runs `job` for each input, on `--threads` threads; the results are in order.
fn in_parallel<I: Sync, T: Send>(
    common: &Common,
    (command, unit): (&'static str, &str),
    inputs: &[I],
    job: impl Fn(&I) -> Result<T, Vec<Refused>> + Sync,
) -> Result<Vec<T>, Failure> {
    let count = inputs.len();
    let mut progress = Progress::new(command, common.work.show.progress);
    let job_at = |index: u64| inputs.get(index as usize).map(&job);
    let results = parallel::each(count as u64, common.work.threads, &mut progress, job_at);
    let results = results.map_err(Failure::threads)?;
    progress.end(format_args!("{count} {unit}"), &[]);
    results.into_iter().flatten().collect::<Result<_, _>>().map_err(|refused| {
        let problems = refused.into_iter().map(|refused| Problem::new("plant", Cause::Plant(refused)));
        let problems = Problems::new(problems.collect());
        let refused = |problems| Failure::Scenario(common.scenario.clone(), problems);
        problems.map_or_else(|| no_plant(&common.scenario), refused)
    })
}

fn channel_list(motor: &SingleMotor) -> String {
    motor.channels.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

pub(crate) fn settling(arguments: &SettlingArguments) -> Result<(), Failure> {
    let common = &arguments.common;
    let share = arguments.share.get();
    let (mut scenario, experiment, motors) = distinct_motors(common)?;
    let config = experiment.config();
    let slot = config.tick().0 / u64::from(config.slots());
    let t_step = arguments.t_step.map_or(slot, |cycles| cycles.get().into());
    check_step_period(&common.scenario, &motors, t_step)?;
    let responses = in_parallel(common, ("settling", "motors"), &motors, |motor| {
        settling_of(&motor.setup, 0, t_step, share).map(|(response, _)| response)
    })?;
    if let Some(file) = &arguments.write_scenario {
        scenario.bus.settle_cycles = settle_cycles(&responses, t_step);
        let text = scenario_file::text(file, &scenario, "use a shorter scenario")?;
        output::write_new(file, |out| out.write_all(text.as_bytes()))?;
        if file == Path::new(output::STANDARD) {
            return Ok(());
        }
    }
    let rows = motors.iter().zip(&responses);
    if !common.json.json {
        return print_settling(rows, config.clock_hz()).map_err(Failure::output);
    }
    let rows = rows.flat_map(|(motor, response)| {
        motor.channels.iter().map(move |channel| {
            json!({
                "channel": channel, "t_step_cycles": t_step, "share": share, "rest_a": response.rest_a,
                "least_a": response.min_a, "greatest_a": response.max_a,
                "reached_cycles": response.reached, "settled_cycles": response.settled,
            })
        })
    });
    Tables::of("settling").with("settling", rows).print()
}

/// A step is observed for 11 step periods, and all samples are stored.
fn check_step_period(path: &Path, motors: &[SingleMotor], t_step: u64) -> Result<(), Failure> {
    for SingleMotor { setup, .. } in motors {
        let grid = u64::from(setup.grid_cycles());
        let max = MAX_SAMPLES * grid / OBSERVED_PERIODS;
        if !(grid..=max).contains(&t_step) {
            let why = format!("--t-step: {t_step} cycles are out of range; use {grid} to {max}");
            return Err(Failure::Invalid(path.to_owned(), why));
        }
    }
    Ok(())
}

/// The longest settling time. Like the self-test of the device, it is the time after which a channel's current first is
/// near its current at rest, whatever follows, and the step period if a channel does not settle.
fn settle_cycles(responses: &[StepResponse], t_step: u64) -> u32 {
    let reached: Option<Vec<u64>> = responses.iter().map(|response| response.reached).collect();
    let cycles = reached.and_then(|cycles| cycles.into_iter().max()).unwrap_or(t_step);
    u32::try_from(cycles).unwrap_or(u32::MAX)
}

fn print_settling<'a>(
    mut rows: impl Iterator<Item = (&'a SingleMotor, &'a StepResponse)>,
    clock_hz: u32,
) -> io::Result<()> {
    let time = |cycles: Option<u64>| match cycles {
        Some(cycles) => format!("{:.4} ms, {cycles} cycles", cycles as f64 / f64::from(clock_hz) * 1e3),
        None => "not within the observed time".to_owned(),
    };
    let mut out = terminal::out();
    rows.try_for_each(|(motor, response)| {
        writeln!(
            out,
            "motor {}: {:.4} A at rest, {:.3} to {:.3} A after a step\n  reached  {}\n  settled  {}",
            channel_list(motor),
            response.rest_a,
            response.min_a,
            response.max_a,
            time(response.reached),
            time(response.settled)
        )
    })
}

pub(crate) fn limits(arguments: &LimitsArguments) -> Result<(), Failure> {
    let common = &arguments.common;
    let ramp = arguments.ramp.get();
    let (_, _, motors) = distinct_motors(common)?;
    let turn = |setup: &Setup| setup.motors.first().map_or(1, MotorModel::steps_per_turn);
    let kinds = [LimitKind::StartStop, LimitKind::PullOut];
    let jobs: Vec<(&SingleMotor, LimitKind)> =
        motors.iter().flat_map(|motor| kinds.map(|kind| (motor, kind))).collect();
    let rates = in_parallel(common, ("limits", "searches"), &jobs, |(SingleMotor { setup, .. }, kind)| {
        let steps = arguments.steps.map_or_else(|| turn(setup), NonZero::get);
        match kind {
            LimitKind::StartStop => search(|rate| starts(setup, rate, steps)),
            LimitKind::PullOut => search(|rate| pulls(setup, rate, ramp)),
        }
    })?;
    let rows = motors.iter().zip(rates.chunks(kinds.len())).filter_map(|(motor, rates)| match *rates {
        [start_stop, pull_out] => Some(MotorLimits { motor, start_stop, pull_out }),
        _ => None,
    });
    if common.json.json {
        let rows = rows.flat_map(|MotorLimits { motor, start_stop, pull_out }| {
            motor.channels.iter().map(move |channel| {
                json!({ "channel": channel, "start_stop_steps_s": start_stop, "pull_out_steps_s": pull_out, "ramp_steps_s2": ramp })
            })
        });
        return Tables::of("limits").with("limits", rows).print();
    }
    let rate = |rate: Option<f64>| {
        rate.map_or_else(|| "below 500 steps/s".to_owned(), |rate| format!("{rate:.0} steps/s"))
    };
    let mut out = terminal::out();
    for MotorLimits { motor, start_stop, pull_out } in rows {
        let (channels, start_stop, pull_out) = (channel_list(motor), rate(start_stop), rate(pull_out));
        writeln!(
            out,
            "motor {channels}\n  start-stop rate  {start_stop}\n  pull-out rate    {pull_out}, with a ramp of {ramp} steps/s^2"
        )
        .map_err(Failure::output)?;
    }
    Ok(())
}

const MAX_SAMPLES: u64 = 10_000_000;
const MAX_STEPS: u64 = 10_000_000;
/// Maximum grid steps of all motors of a map (PLANT F1).
const MAX_MOTOR_GRID_STEPS: f64 = 1e10;

pub(crate) fn resonance(arguments: &ResonanceArguments) -> Result<(), Failure> {
    let common = &arguments.common;
    let invalid = |why: String| Failure::Invalid(common.scenario.clone(), why);
    let [from, to, step] = [arguments.from, arguments.to, arguments.step].map(Rate::get);
    let last_index = (to - from) / step + 1e-9;
    if to < from {
        return Err(Failure::Option(format!("--to: {to} is below --from {from}; use {from} or more")));
    }
    if last_index >= MAX_RATES {
        let why = format!("--step: {step} gives more than {MAX_RATES} rates; use a larger step");
        return Err(Failure::Option(why));
    }
    let (_, _, motors) = distinct_motors(common)?;
    let rates: Vec<f64> = (0..=last_index as u64).map(|index| from + index as f64 * step).collect();
    let grid_steps = |SingleMotor { setup, .. }: &SingleMotor| {
        RESONANCE_S * f64::from(setup.clock_hz) / f64::from(setup.grid_cycles())
    };
    let motor_grid_steps = rates.len() as f64 * motors.iter().map(grid_steps).sum::<f64>();
    if motor_grid_steps > MAX_MOTOR_GRID_STEPS {
        return Err(invalid(format!(
            "the map needs {motor_grid_steps:.2e} grid steps of all motors, more than {MAX_MOTOR_GRID_STEPS:e}; use a larger --step, or one --channel"
        )));
    }
    let jobs: Vec<(&SingleMotor, f64)> =
        motors.iter().flat_map(|motor| rates.iter().map(move |rate| (motor, *rate))).collect();
    let points = in_parallel(common, ("resonance", "rates"), &jobs, |(SingleMotor { setup, .. }, rate)| {
        let microsteps = setup.motors.first().map_or(1.0, |motor| f64::from(motor.microsteps));
        resonance_of(setup, rate * microsteps)
    })?;
    let rows = motors.iter().zip(points.chunks(rates.len())).flat_map(|(motor, points)| {
        let of_channel = rates.iter().zip(points);
        let channels = motor.channels.iter();
        channels.flat_map(move |&channel| of_channel.clone().map(move |(rate, point)| (channel, rate, point)))
    });
    if common.json.json {
        let rows = rows.map(|(channel, rate, point)| {
            json!({ "channel": channel, "rate_full_steps_s": rate, "swing_full_steps": point.peak_to_peak, "loses_steps": point.loses_steps })
        });
        let tables = Tables::of("resonance").with("resonance", rows);
        return output::write_new(&arguments.out.out, |out| tables.write(out));
    }
    output::write_new(&arguments.out.out, |out| {
        writeln!(out, "channel,rate_full_steps_s,swing_full_steps,loses_steps")?;
        for (channel, rate, point) in rows {
            writeln!(out, "{channel},{rate},{},{}", point.peak_to_peak, u8::from(point.loses_steps))?;
        }
        Ok(())
    })
}
