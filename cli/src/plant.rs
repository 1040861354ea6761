//! `stepscope plant`: simulates the motors, supply and sensors that a scenario's pulses drive.

use crate::failure::{Failure, Numbered, no_plant};
use crate::motors::{self, MotorReplacement};
use crate::options::{Json, ShowProgress};
use crate::output::{Out, Outputs, STANDARD};
use crate::{json::Tables, progress::Progress, quantity::whole, terminal};
use clap::Args;
use serde::Serialize;
use serde_json::Value;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::{cell::RefCell, num::NonZero, rc::Rc, slice};
use stepscope_core::{
    inspect::{
        export::vcd::{Timescale, VcdWriter},
        plant::{
            outcome::{energy_left_over, names, table_head, table_row, too_coarse, values, verdict},
            report::PlantReport,
        },
    },
    peripheral::{
        signal::{Record, Sink},
        units::Cycles,
    },
    plant::{
        Observer, Plant,
        measures::{MotorResult, Peak, PlantResult},
        parameters::Setup,
        settling::Deviation,
    },
    sim::{Experiment, plant_run::PlantRun},
};

/// Cycles between progress reports.
const SLICE: Cycles = Cycles(1 << 22);
const MAX_SLIPS: usize = 20;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario with a plant: a JSON file or a preset's name; `-` reads standard input
    #[arg(required_unless_present = "motors")]
    scenario: Option<PathBuf>,
    #[command(flatten)]
    replacing: MotorReplacement,
    /// List the motors and motor drivers with their parameters and sources
    #[arg(long, conflicts_with_all = ["scenario", "motor", "motor_driver", "controller", "digest", "csv", "vcd"])]
    motors: bool,
    /// Controller to report
    #[arg(long, value_name = "K", default_value_t = 0, value_parser = whole::<usize>(0..=u64::MAX))]
    controller: usize,
    /// Print only the digest of the plant (XXH64)
    #[arg(long, conflicts_with = "json")]
    digest: bool,
    /// Write the simulated points (CSV): voltage, currents, angles, lost steps, sensor codes
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a value change dump of signals and analog values
    #[arg(long, value_name = "FILE")]
    vcd: Option<PathBuf>,
    /// Write only every Nth point to the files
    #[arg(long, value_name = "N", default_value = "1", value_parser = whole::<NonZero<u64>>(1..=u64::MAX))]
    every: NonZero<u64>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    show: ShowProgress,
}

#[derive(Clone, Default)]
struct Files(Rc<RefCell<OpenFiles>>);

#[derive(Default)]
struct OpenFiles {
    csv: Option<(PathBuf, Out, io::Result<()>)>,
    vcd: Option<(PathBuf, VcdWriter<Out>)>,
    every: u64,
    skipped_points: u64,
}

impl Sink for Files {
    fn record(&mut self, record: Record) {
        if let Some((_, writer)) = &mut self.0.borrow_mut().vcd {
            writer.record(record);
        }
    }
}

impl Observer for Files {
    fn point(&mut self, plant: &Plant) {
        let mut open = self.0.borrow_mut();
        if open.csv.is_none() && open.vcd.is_none() {
            return;
        }
        open.skipped_points = (open.skipped_points + 1) % open.every.max(1);
        if open.skipped_points != 0 {
            return;
        }
        if let Some((_, out, result)) = &mut open.csv
            && result.is_ok()
        {
            *result = out.write_all(table_row(plant).as_bytes());
        }
        if let Some((_, writer)) = &mut open.vcd {
            writer.analog(plant.cycle(), &values(plant));
        }
    }
}

pub(crate) fn plant(arguments: &Arguments) -> Result<(), Failure> {
    let Some(path) = &arguments.scenario else { return motors::list(arguments.json.json) };
    let mut outputs = Outputs::default();
    let (_, experiment) = arguments.replacing.validated(path)?;
    let (controllers, chosen) = (experiment.controllers(), arguments.controller);
    if chosen >= controllers {
        return Err(Failure::index(path, Numbered::Controllers, chosen, controllers, false));
    }
    let parts: Vec<(Files, Files)> = (0..controllers).map(|_| <(Files, Files)>::default()).collect();
    let mut run = PlantRun::new(&experiment, parts).ok_or_else(|| no_plant(path))?;
    let opened = run.plant(chosen).map(|plant| open(arguments, &mut outputs, plant, &experiment));
    let files = opened.transpose()?.unwrap_or_default();
    run.attach(chosen, files.clone(), files.clone());
    let mut progress = Progress::new("plant", arguments.show.progress);
    while !run.advance(SLICE) {
        progress.update(run.now().0, experiment.cost().end_cycle);
    }
    close(&files, run.now().0)?;
    progress.end(format_args!("{} cycles", run.now().0), &outputs.commit()?);
    let results = run.results();
    let Some(result) = results.get(chosen) else { return Ok(()) };
    let setups = experiment.plants().map(|plants| plants.setups.as_slice());
    let Some(setup) = setups.and_then(|setups| setups.get(chosen)) else { return Ok(()) };
    if arguments.digest {
        return writeln!(terminal::out(), "{:016x}", result.digest).map_err(Failure::output);
    }
    if arguments.json.json {
        return PlantReport::of(&experiment, &run, chosen).map_or(Ok(()), |report| tables(&report).print());
    }
    if arguments.csv.as_deref() == Some(Path::new(STANDARD))
        || arguments.vcd.as_deref() == Some(Path::new(STANDARD))
    {
        return Ok(());
    }
    print(&run, result, chosen, setup).map_err(Failure::output)
}

fn open(
    arguments: &Arguments,
    outputs: &mut Outputs,
    plant: &Plant,
    experiment: &Experiment,
) -> Result<Files, Failure> {
    let mut opened = OpenFiles { every: arguments.every.get(), ..OpenFiles::default() };
    if let Some(path) = &arguments.csv {
        let mut out = outputs.create(path)?;
        let result = out.write_all(table_head(plant).as_bytes());
        opened.csv = Some((path.clone(), out, result));
    }
    if let Some(path) = &arguments.vcd {
        let (clock_hz, channels) = (experiment.config().clock_hz(), plant.motors() as u8);
        let scale = Timescale::default().of_clock(clock_hz).map_err(Failure::Timescale)?;
        let writer =
            VcdWriter::with_signals(outputs.create(path)?, scale, clock_hz, channels, &names(plant), []);
        opened.vcd = Some((path.clone(), writer.map_err(|error| Failure::File(path.clone(), error))?));
    }
    Ok(Files(Rc::new(RefCell::new(opened))))
}

fn close(files: &Files, end: u64) -> Result<(), Failure> {
    let mut open = files.0.borrow_mut();
    if let Some((path, mut out, result)) = open.csv.take() {
        result.and_then(|()| out.flush()).map_err(|error| Failure::File(path, error))?;
    }
    if let Some((path, writer)) = open.vcd.take() {
        writer.finish(end).map_err(|error| Failure::File(path, error))?;
    }
    Ok(())
}

fn ms(cycles: u64, clock_hz: u32) -> f64 {
    cycles as f64 / f64::from(clock_hz) * 1e3
}

fn print<S: Sink, O: Observer>(
    run: &PlantRun<S, O>,
    result: &PlantResult,
    controller: usize,
    setup: &Setup,
) -> io::Result<()> {
    let clock_hz = setup.clock_hz;
    let mut out = io::BufWriter::new(terminal::out());
    writeln!(out, "plant digest     {:016x}", result.digest)?;
    writeln!(out, "simulated to     {:.3} ms, cycle {}", ms(result.cycle, clock_hz), result.cycle)?;
    let (current, voltage) = (&result.supply_a, &result.supply_v);
    let rms = current.rms();
    writeln!(out, "supply current   {:.3} to {:.3} A, RMS {rms:.3} A", current.min, current.max)?;
    writeln!(out, "bus              {:.3} to {:.3} V", voltage.min, voltage.max)?;
    if let Some(found) = &result.deviation {
        let Deviation { rest_a, above_a, below_a } = found;
        writeln!(
            out,
            "  deviation      +{above_a:.3} A, -{below_a:.3} A from the idle {rest_a:.3} A, at the sensor"
        )?;
    }
    if let Some(at) = result.collapsed {
        writeln!(
            out,
            "  warning: the supply collapses at {:.3} ms; use a stronger source or less load",
            ms(at, clock_hz)
        )?;
    }
    if let Some(at) = run.overload(controller) {
        writeln!(
            out,
            "overload         in cycle {at}, {:.3} ms: EN and STEP are off from the next cycle on",
            ms(at, clock_hz)
        )?;
    }
    for (channel, found) in run.self_test(controller).iter().enumerate() {
        match found {
            Some(cycles) => writeln!(
                out,
                "self-test {channel}      settles in {cycles} cycles, {:.3} ms",
                ms(*cycles, clock_hz)
            )?,
            None => writeln!(out, "self-test {channel}      does not settle (fault SELF_TEST)")?,
        }
    }
    for (channel, motor) in result.motors.iter().enumerate() {
        print_motor(&mut out, (channel, motor), clock_hz, run.overload(controller))?;
        if let Some(warning) = too_coarse(setup, channel, motor) {
            writeln!(out, "  warning: {warning}")?;
        }
    }
    out.flush()
}

fn print_motor(
    out: &mut impl Write,
    (channel, motor): (usize, &MotorResult),
    clock_hz: u32,
    overload: Option<u64>,
) -> io::Result<()> {
    writeln!(out, "motor {channel}          {}", verdict(motor, clock_hz, overload))?;
    let Peak { value: following, cycle: at } = motor.following_error;
    writeln!(out, "  following error maximum {following:+.4} full steps, at {:.3} ms", ms(at, clock_hz))?;
    writeln!(
        out,
        "  at the end     {:.4} full steps of {:.4}, off by {:+.4}",
        motor.state.x,
        motor.command,
        motor.state.x - motor.command
    )?;
    if let (Some(overshoot), Some(settling)) = (motor.overshoot, motor.settling) {
        writeln!(
            out,
            "  last step      overshoot {overshoot:+.4} full steps; within 0.05 after {:.3} ms",
            ms(settling, clock_hz)
        )?;
    }
    for slip in motor.slips.iter().take(MAX_SLIPS) {
        let side = if slip.is_behind { "behind" } else { "ahead" };
        writeln!(
            out,
            "  slip           at {:.3} ms, cycle {}: four full steps {side}",
            ms(slip.cycle, clock_hz),
            slip.cycle
        )?;
    }
    if motor.slip_count > MAX_SLIPS as u64 {
        writeln!(out, "  slips          {} in all", motor.slip_count)?;
    }
    writeln!(out, "  phase current  maximum {:.3} A, RMS {:.3} A", motor.phase_peak_a, motor.phase_rms_a)?;
    let energy = &motor.energy;
    writeln!(
        out,
        "  energy         {:.5} J from the bus = copper {:.5} + friction {:.5} + viscous {:.5} + diodes {:.5} + load {:.5} + stored {:.5}",
        energy.bus, energy.copper, energy.friction, energy.viscous, energy.diodes, energy.load, energy.stored
    )?;
    if let Some(warning) = energy_left_over(motor) {
        writeln!(out, "  warning: {warning}")?;
    }
    Ok(())
}

fn tables(report: &PlantReport) -> Tables {
    fn rows<T: Serialize>(rows: &[T]) -> Vec<Value> {
        rows.iter().map(|row| serde_json::to_value(row).unwrap_or_default()).collect()
    }
    Tables::of("plant")
        .with("plant", rows(slice::from_ref(&report.plant)))
        .with("motors", rows(&report.motors))
        .with("slips", rows(&report.slips))
        .with("self_test", rows(&report.self_test))
}
