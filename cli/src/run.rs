//! `stepscope run`: runs a scenario; prints digest and status, writes files.

use crate::{
    failure::{Failure, Numbered},
    files::{self, ControllerOutputs, Files, Output},
    json::Tables,
    line,
    options::{Json, ShowProgress},
    output::{Out, Outputs},
    panel,
    progress::Progress,
    quantity::{parsed, whole},
    scenarios, status, terminal,
    timing::{self, TimeUnit},
    verify,
};
use clap::Args;
use serde_json::json;
use std::io::{self, Write};
use std::path::PathBuf;
use stepscope_core::controller::{CheckedSetup, StandAlone};
use stepscope_core::inspect::export::vcd::Timescale;
use stepscope_core::inspect::trace::{fingerprint::Fingerprinter, timing::TimingCheck};
use stepscope_core::peripheral::config::Config;
use stepscope_core::scenario::{Cause, Problem, Scenario, Source, link};
use stepscope_core::sim::{Experiment, Run, Summary};

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
    #[arg(long, value_name = "TIME", default_value = "1ns", requires = "vcd", value_parser = parsed::<Timescale>)]
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
    /// The bytes already contain the effects of noise, so the run has the same traces.
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
        if arguments.panel.is_some() && !matches!(scenario.source, Source::StandAlone(_)) {
            let why = "--panel: the scenario has no stand-alone controller; omit the option, or use a preset such as zhang-2012-controller";
            return Err(Failure::invalid(path, why));
        }
        timing = arguments.timing.check(path, scenario)?;
        Ok(())
    })?;
    let mut controllers = open_all(arguments, &mut outputs, &experiment, timing)?;
    let mut create = |path: &Option<PathBuf>| path.as_ref().map(|path| outputs.create(path)).transpose();
    let (line, violations) = (create(&arguments.line)?, create(&arguments.timing.violations)?);
    for warning in experiment.stand_alone().iter().flat_map(|setup| setup.warnings()) {
        let _ = writeln!(terminal::err(), "warning: {warning}");
    }
    let mut progress = Progress::new("run", arguments.show.progress);
    let finished = simulate(&experiment, &mut controllers, &mut progress);
    if let Some(work) = finished.stand_alone().and_then(StandAlone::too_many_groups) {
        let at = format!("source.standalone[{}].groups", work.controller);
        return Err(Failure::Scenario(path.clone(), Problem::new(at, Cause::TooManyGroups(work)).into()));
    }
    for (path, file) in controllers.iter_mut().flat_map(|controller| controller.files.drain(..)) {
        file.finish(&experiment, &finished).map_err(|error| Failure::File(path, error))?;
    }
    if let Some(file) = arguments.line.as_deref().zip(line) {
        line::write(file, Scenario::clone(&scenario), &experiment, &finished)?;
    }
    let unit = TimeUnit::of_cycles(scenario.clock_hz);
    let timing = controllers.iter_mut().find_map(|controller| controller.timing.take());
    if let (Some(path), Some(out), Some(timing)) = (&arguments.timing.violations, violations, &timing) {
        let written = timing::write_violations(out, timing, unit);
        written.map_err(|error| Failure::File(path.clone(), error))?;
    }
    let written = outputs.commit()?;
    let records: u64 = controllers.iter().map(|controller| controller.digest.records()).sum();
    progress.end(format_args!("{records} records, {} cycles", finished.cycles().0), &written);

    let digests = controllers.iter().map(|controller| &controller.digest);
    let mut summary = Summary::new(&experiment, &finished, digests);
    if let Some(controller) = arguments.controller {
        summary = summary.only(controller);
    }
    let link = if arguments.link { Some(link_of(&scenario, &mut controllers)?) } else { None };
    report(arguments, &summary, timing.as_ref().map(|timing| (timing, unit)), link.as_deref())?;
    timing.map_or(Ok(()), |timing| arguments.timing.result(&timing))
}

/// The outputs of each controller; files and timing are for the selected one.
fn open_all(
    arguments: &Arguments,
    outputs: &mut Outputs,
    experiment: &Experiment,
    timing: Option<TimingCheck>,
) -> Result<Vec<ControllerOutputs>, Failure> {
    let count = experiment.controllers();
    let selected = arguments.controller.unwrap_or(0);
    let mut controllers: Vec<_> = (0..count).map(|_| ControllerOutputs::default()).collect();
    let (Some(config), Some(controller)) =
        (experiment.configs().nth(selected), controllers.get_mut(selected))
    else {
        return Err(Failure::index(&arguments.scenario, Numbered::Controllers, selected, count, true));
    };
    controller.timing = timing;
    controller.files = open(arguments, outputs, selected, config, experiment.stand_alone())?;
    if arguments.link {
        for controller in &mut controllers {
            controller.fingerprint = Some(Fingerprinter::default());
        }
    }
    Ok(controllers)
}

fn report(
    arguments: &Arguments,
    summary: &Summary,
    timing: Option<(&TimingCheck, TimeUnit)>,
    link: Option<&str>,
) -> Result<(), Failure> {
    if arguments.json.json {
        let mut tables = status::tables(Tables::of("run"), summary, arguments.controller.unwrap_or_default());
        if let Some((timing, unit)) = timing {
            tables = timing::tables(tables, timing, unit);
        }
        if let Some(link) = link {
            tables = tables.with("links", [json!({ "link": format!("#{link}") })]);
        }
        return tables.print();
    }
    if let Some(link) = link {
        writeln!(terminal::out(), "#{link}").map_err(Failure::output)?;
    }
    if arguments.digest && !arguments.status {
        status::digests(summary).map_err(Failure::output)?;
    } else if arguments.status || !arguments.writes_a_file() {
        status::print(summary).map_err(Failure::output)?;
    }
    timing.map_or(Ok(()), |(timing, unit)| arguments.timing.report(timing, unit))
}

fn link_of(scenario: &Scenario, controllers: &mut [ControllerOutputs]) -> Result<String, Failure> {
    let link = link::encode(scenario).map_err(Failure::Link)?;
    let traces = controllers.iter_mut().filter_map(|controller| controller.fingerprint.take());
    Ok(verify::with_digests(link, traces))
}

fn simulate(experiment: &Experiment, controllers: &mut [ControllerOutputs], progress: &mut Progress) -> Run {
    let mut run = experiment.start();
    while !run.advance_each(SLICE, controllers) {
        if controllers.iter().any(ControllerOutputs::has_failed) {
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
