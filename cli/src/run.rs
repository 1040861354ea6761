//! `stepscope run`: one scenario, from its file to digest, status and files.

use crate::{
    failure::Failure,
    files::{self, Files, Out, Output, Station},
    line,
    progress::Progress,
    scenarios, status, timing,
};
use clap::Args;
use std::{
    io::{self, Write},
    path::PathBuf,
};
use stepscope_core::{
    inspect::{fingerprint::Fingerprinter, run_fingerprint::RunFingerprint},
    peripheral::config::Config,
    scenario::{Scenario, link},
    sim::{Experiment, Run, Summary},
};

/// Records between two looks at how far a run is.
const SLICE: u64 = 1 << 16;

/// What `stepscope run` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario, a JSON file; `-` reads standard input.
    scenario: PathBuf,
    /// Print only the digest of the trace: XXH64, 16 hexadecimal digits; of several controllers, one a
    /// line.
    #[arg(long)]
    digest: bool,
    /// Print positions, fault flags and ticks done; on a framed line also the controller's state, what
    /// the host reached and counted, and the load of the line.
    #[arg(long)]
    status: bool,
    /// Print the share link of the scenario: what stands behind the page's address. It carries the digests
    /// of this run, so that whoever opens it can tell whether theirs is the same.
    #[arg(long)]
    link: bool,
    /// Write the trace: one record a line, cycle and levels in hexadecimal (`-`: standard output).
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Write a value change dump, for GTKWave, Surfer or PulseView.
    #[arg(long, value_name = "FILE")]
    vcd: Option<PathBuf>,
    /// Write a table of the signals: cycle, time in s, and a level each.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a table of the packets, with what the controller did with each (CSV as in RFC 4180).
    #[arg(long, value_name = "FILE")]
    packets: Option<PathBuf>,
    /// Write the scenario with what was done to the line as its source: every byte and the cycle it is
    /// sent in, and every forced level, those of noise among them; or, where segments run it, as their
    /// lists. Run in its turn, it gives the same traces.
    #[arg(long, value_name = "FILE")]
    line: Option<PathBuf>,
    /// Of several controllers take this one: 0 is the scenario's own, 1 the first of `controllers`.
    /// Without it digest and status are those of all, files and timing those of controller 0.
    #[arg(long, value_name = "K")]
    controller: Option<usize>,
    /// Show the progress also where standard error is no terminal.
    #[arg(long)]
    progress: bool,
    #[command(flatten)]
    timing: timing::Options,
}

impl Arguments {
    /// Whether something else than digest and status was asked for.
    const fn asks_for_a_file(&self) -> bool {
        self.trace.is_some()
            || self.vcd.is_some()
            || self.csv.is_some()
            || self.packets.is_some()
            || self.line.is_some()
            || self.link
            || self.timing.asked()
    }
}

/// Runs the scenario and writes what was asked for; digest and status if nothing was.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let (scenario, experiment) = scenarios::judged(path)?;
    let controllers = experiment.controllers();
    let chosen = arguments.controller.unwrap_or(0);
    let config = experiment.configs().nth(chosen);
    let config = config.ok_or_else(|| Failure::Controller(path.clone(), chosen, controllers))?;

    let mut stations: Vec<Station> = (0..controllers).map(|_| Station::default()).collect();
    if let Some(station) = stations.get_mut(chosen) {
        station.files = open(arguments, chosen, config)?;
        station.timing = arguments.timing.check(path, &scenario)?;
    }
    if arguments.link {
        stations.iter_mut().for_each(|station| station.fingerprint = Some(Fingerprinter::default()));
    }
    let finished = go(&experiment, &mut stations, arguments.progress);
    let mut timing = None;
    for station in &mut stations {
        timing = timing.or(station.timing.take());
        for (path, file) in station.files.drain(..) {
            file.finish(&experiment, &finished).map_err(|error| Failure::File(path, error))?;
        }
    }
    if let Some(file) = &arguments.line {
        line::write(file, Scenario::clone(&scenario), &experiment, &finished)?;
    }
    if arguments.link {
        let link = link::encode(&scenario).map_err(Failure::Link)?;
        let seen = stations.iter_mut().filter_map(|station| station.fingerprint.take());
        let proof = RunFingerprint::of(seen.map(Fingerprinter::finish).collect());
        let link = link::with_part(link, "d", &proof.emit());
        writeln!(io::stdout(), "#{link}").map_err(Failure::output)?;
    }
    let summary = Summary::new(&experiment, &finished, stations.iter().map(|station| &station.digest));
    let summary = match arguments.controller {
        Some(controller) => summary.only(controller),
        None => summary,
    };
    if arguments.digest && !arguments.status {
        status::digests(&summary).map_err(Failure::output)?;
    } else if arguments.status || !arguments.asks_for_a_file() {
        status::print(&summary).map_err(Failure::output)?;
    }
    timing.map_or(Ok(()), |timing| arguments.timing.report(&timing, scenario.clock_hz))
}

/// The whole run; a long one says how far it is.
fn go(experiment: &Experiment, stations: &mut [Station], wanted: bool) -> Run {
    let mut progress = Progress::new("run", wanted);
    let mut run = experiment.start();
    while !run.advance_each(SLICE, stations) {
        progress.tell(run.cycles().0, experiment.cost().end_cycle);
    }
    if wanted {
        progress.tell(1, 1);
    }
    run
}

/// The files that were asked for, each with its path.
fn open(arguments: &Arguments, controller: usize, config: &Config) -> Result<Files, Failure> {
    let (clock_hz, channels) = (config.clock_hz(), config.channels());
    let mut opened = Vec::new();
    let mut add = |path: &Option<PathBuf>, make: &dyn Fn(Out) -> io::Result<Box<dyn Output>>| {
        let Some(path) = path else { return Ok(()) };
        let file = files::create(path).and_then(make).map_err(|error| Failure::File(path.clone(), error))?;
        opened.push((path.clone(), file));
        Ok(())
    };
    add(&arguments.trace, &|out| Ok(files::trace(out)))?;
    add(&arguments.vcd, &|out| files::vcd(out, clock_hz, channels))?;
    add(&arguments.csv, &|out| files::csv(out, clock_hz, channels))?;
    add(&arguments.packets, &|out| Ok(files::packets(out, controller)))?;
    Ok(opened)
}
