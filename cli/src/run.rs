//! `stepscope run`: runs a scenario; prints digest and status, writes files.

use crate::{
    failure::{Failure, Numbered},
    files::{self, Files, Output, Station},
    json::Tables,
    line,
    options::{Json, ShowProgress},
    output::{Out, Outputs},
    panel,
    progress::Progress,
    quantity::whole,
    scenarios, status, terminal,
    timing::{self, TimeUnit},
};
use clap::Args;
use serde_json::json;
use std::{
    io::{self, Write},
    path::PathBuf,
};
use stepscope_core::{
    controller::{CheckedSetup, StandAlone},
    inspect::{
        export::vcd::Timescale,
        trace::{fingerprint::Fingerprinter, run_fingerprint::RunFingerprint},
    },
    peripheral::config::Config,
    scenario::{Cause, Problem, Scenario, Source, link},
    sim::{Experiment, Run, Summary},
};

/// Records between progress reports.
const SLICE: u64 = 1 << 16;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    scenario: PathBuf,
    /// Print only the digest of the trace (XXH64), one line per controller
    #[arg(long)]
    digest: bool,
    /// Print positions, fault flags and completed ticks
    ///
    /// For a framed line, also prints the controller's state, the host's counters and the line load.
    #[arg(long)]
    status: bool,
    /// Print the share link of the scenario
    ///
    /// The link contains the digests of this run for `stepscope open --verify`.
    #[arg(long)]
    link: bool,
    /// Write the trace: cycle and levels in hexadecimal, one record per line
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Write a value change dump for GTKWave, Surfer or PulseView
    #[arg(long, value_name = "FILE")]
    vcd: Option<PathBuf>,
    /// Time unit of the dump: 1, 10 or 100 of s, ms, us, ns, ps or fs
    ///
    /// It must not exceed one cycle, so that the dump is exact: time t is cycle round(t*clock). The dump's header has
    /// the clock.
    #[arg(long, value_name = "TIME", default_value = "1ns", requires = "vcd", value_parser = timescale)]
    vcd_timescale: Timescale,
    /// Write a table of the signals (CSV): cycle, time in s, one level per signal
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Write a table of the packets and their outcomes (CSV)
    #[arg(long, value_name = "FILE")]
    packets: Option<PathBuf>,
    /// Write the panel states of stand-alone controllers (CSV)
    ///
    /// One row per change: cycle, panel word, position, display, and the fields of the word (state, alarm, trust,
    /// outputs, group, loop).
    #[arg(long, value_name = "FILE")]
    panel: Option<PathBuf>,
    /// Write a scenario that replays each byte, forced level or segment of the run
    ///
    /// It includes the noise, so its run has the same traces.
    #[arg(long, value_name = "FILE")]
    line: Option<PathBuf>,
    /// Controller to report: 0 is the scenario's own, 1 the first of `controllers`
    ///
    /// By default, digest and status cover all controllers; files and the timing check cover controller 0.
    #[arg(long, value_name = "K", value_parser = whole::<usize>(0..=u64::MAX))]
    controller: Option<usize>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    show: ShowProgress,
    #[command(flatten)]
    timing: timing::Options,
}

fn timescale(text: &str) -> Result<Timescale, String> {
    text.parse().map_err(str::to_owned)
}

impl Arguments {
    const fn writes_a_file(&self) -> bool {
        self.trace.is_some()
            || self.vcd.is_some()
            || self.csv.is_some()
            || self.packets.is_some()
            || self.panel.is_some()
            || self.line.is_some()
            || self.link
            || self.timing.is_wanted()
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let mut outputs = Outputs::default();
    let mut timing = None;
    let (scenario, experiment) = scenarios::validated_after(path, |scenario| {
        if arguments.panel.is_some() && !matches!(scenario.source, Source::Standalone(_)) {
            return Err(Failure::NoPanel(path.clone()));
        }
        timing = arguments.timing.check(path, scenario)?;
        Ok(())
    })?;
    let controllers = experiment.controllers();
    let chosen = arguments.controller.unwrap_or(0);
    let config = experiment.configs().nth(chosen);
    let config =
        config.ok_or_else(|| Failure::index(path, Numbered::Controllers, chosen, controllers, true))?;

    let mut stations: Vec<Station> = (0..controllers).map(|_| Station::default()).collect();
    if let Some(station) = stations.get_mut(chosen) {
        station.timing = timing;
        station.files = open(arguments, &mut outputs, chosen, config, experiment.stand_alone())?;
    }
    if arguments.link {
        stations.iter_mut().for_each(|station| station.fingerprint = Some(Fingerprinter::default()));
    }
    let mut create = |path: &Option<PathBuf>| path.as_ref().map(|path| outputs.create(path)).transpose();
    let (line, violations) = (create(&arguments.line)?, create(&arguments.timing.violations)?);
    for warned in experiment.stand_alone().iter().flat_map(|controllers| controllers.warnings()) {
        let _ = writeln!(terminal::err(), "warning: {warned}");
    }
    let mut progress = Progress::new("run", arguments.show.progress);
    let finished = go(&experiment, &mut stations, &mut progress);
    if let Some(work) = finished.stand_alone().and_then(StandAlone::too_many_groups) {
        let at = format!("source.standalone[{}].groups", work.controller);
        return Err(Failure::Scenario(path.clone(), vec![Problem::new(at, Cause::TooManyGroups(work))]));
    }
    let mut timing = None;
    for station in &mut stations {
        timing = timing.or(station.timing.take());
        for (path, file) in station.files.drain(..) {
            file.finish(&experiment, &finished).map_err(|error| Failure::File(path, error))?;
        }
    }
    if let Some(file) = arguments.line.as_deref().zip(line) {
        line::write(file, Scenario::clone(&scenario), &experiment, &finished)?;
    }
    if let (Some(path), Some(out), Some(timing)) = (&arguments.timing.violations, violations, &timing) {
        let written = timing::write_violations(out, timing, TimeUnit::of_cycles(scenario.clock_hz));
        written.map_err(|error| Failure::File(path.clone(), error))?;
    }
    let written = outputs.commit()?;
    let records: u64 = stations.iter().map(|station| station.digest.records()).sum();
    progress.end(format_args!("{records} records, {} cycles", finished.cycles().0), &written);

    let summary = Summary::new(&experiment, &finished, stations.iter().map(|station| &station.digest));
    let summary = match arguments.controller {
        Some(controller) => summary.only(controller),
        None => summary,
    };
    let link = if arguments.link { Some(link_of(&scenario, &mut stations)?) } else { None };
    if arguments.json.json {
        let mut tables = status::tables(Tables::of("run"), &summary, chosen);
        if let Some(timing) = &timing {
            tables = timing::tables(tables, timing, TimeUnit::of_cycles(scenario.clock_hz));
        }
        if let Some(link) = link {
            tables = tables.with("links", [json!({ "link": format!("#{link}") })]);
        }
        tables.print()?;
    } else {
        if let Some(link) = link {
            writeln!(terminal::out(), "#{link}").map_err(Failure::output)?;
        }
        if arguments.digest && !arguments.status {
            status::digests(&summary).map_err(Failure::output)?;
        } else if arguments.status || !arguments.writes_a_file() {
            status::print(&summary).map_err(Failure::output)?;
        }
        if let Some(timing) = &timing {
            arguments.timing.report(timing, TimeUnit::of_cycles(scenario.clock_hz))?;
        }
    }
    timing.map_or(Ok(()), |timing| arguments.timing.result(&timing))
}

fn link_of(scenario: &Scenario, stations: &mut [Station]) -> Result<String, Failure> {
    let link = link::encode(scenario).map_err(Failure::Link)?;
    let seen = stations.iter_mut().filter_map(|station| station.fingerprint.take());
    let proof = RunFingerprint::of(seen.map(Fingerprinter::finish).collect());
    Ok(link::with_part(link, "d", &proof.emit()))
}

fn go(experiment: &Experiment, stations: &mut [Station], progress: &mut Progress) -> Run {
    let mut run = experiment.start();
    while !run.advance_each(SLICE, stations) {
        if stations.iter().any(Station::has_failed) {
            return run;
        }
        progress.update(run.cycles().0, experiment.cost().end_cycle);
    }
    progress.update(1, 1);
    run
}

fn open(
    arguments: &Arguments,
    outputs: &mut Outputs,
    controller: usize,
    config: &Config,
    panels: Option<&CheckedSetup>,
) -> Result<Files, Failure> {
    let (clock_hz, channels) = (config.clock_hz(), config.channels());
    let timescale = arguments.vcd_timescale;
    if arguments.vcd.is_some() {
        timescale.of_clock(clock_hz).map_err(Failure::Timescale)?;
    }
    let mut opened = Vec::new();
    let mut add = |path: &Option<PathBuf>, make: &dyn Fn(Out) -> io::Result<Box<dyn Output>>| {
        let Some(path) = path else { return Ok(()) };
        let file = make(outputs.create(path)?).map_err(|error| Failure::File(path.clone(), error))?;
        opened.push((path.clone(), file));
        Ok(())
    };
    add(&arguments.trace, &|out| Ok(files::trace(out)))?;
    add(&arguments.vcd, &|out| match panels {
        Some(panels) => panel::vcd(out, timescale, (clock_hz, channels), panels),
        None => files::vcd(out, timescale, clock_hz, channels),
    })?;
    add(&arguments.csv, &|out| match panels {
        Some(panels) => panel::csv(out, (clock_hz, channels), panels),
        None => files::csv(out, clock_hz, channels),
    })?;
    add(&arguments.panel, &|out| Ok(panel::records(out)))?;
    add(&arguments.packets, &|out| Ok(files::packets(out, controller)))?;
    Ok(opened)
}
