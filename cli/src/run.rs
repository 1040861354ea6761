//! `stepscope run`: one scenario, from its file to digest, status and files.

use crate::{
    failure::Failure,
    files::{self, Files, Out, Output, Outputs},
    timing,
};
use clap::Args;
use std::{
    fs,
    io::{self, Read, Write},
    path::{Path, PathBuf},
};
use stepscope_core::{
    run::{Experiment, Run},
    scenario::{Hex, LineScript, Scenario, ScriptedSend, Source, link},
    trace::Digest,
};

/// What `stepscope run` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario, a JSON file; `-` reads standard input.
    scenario: PathBuf,
    /// Print only the digest of the trace: XXH64, 16 hexadecimal digits.
    #[arg(long)]
    digest: bool,
    /// Print positions, fault flags and ticks done.
    #[arg(long)]
    status: bool,
    /// Print the share link of the scenario: what stands behind the page's address.
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
    /// Write a table of the packets, with what the controller did with each.
    #[arg(long, value_name = "FILE")]
    packets: Option<PathBuf>,
    /// Write the scenario with its source as a line script: every byte and the cycle it is sent in;
    /// or, where segments run it, as their lists. Run in its turn, it gives the same trace.
    #[arg(long, value_name = "FILE")]
    line: Option<PathBuf>,
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
    let bytes = read(path).map_err(|error| Failure::File(path.clone(), error))?;
    let text = String::from_utf8(bytes).map_err(|_| Failure::NotText(path.clone()))?;
    let experiment =
        Experiment::from_json(&text).map_err(|problems| Failure::Scenario(path.clone(), problems))?;
    let (scenario, _) = Scenario::from_json_lenient(&text);

    let mut digest = Digest::default();
    let mut outputs = Outputs { digest: &mut digest, files: open(arguments, &experiment)? };
    let mut timing = arguments.timing.check(path, &scenario)?;
    let finished = experiment.run(&mut (&mut outputs, timing.as_mut()));
    for (path, file) in outputs.files {
        file.finish(finished.cycles().0).map_err(|error| Failure::File(path, error))?;
    }
    if let Some(file) = &arguments.line {
        let text = scripted(scenario.clone(), &experiment, &finished).to_json();
        let failed = |error| Failure::File(file.clone(), error);
        let mut out = files::create(file).map_err(failed)?;
        writeln!(out, "{text}").and_then(|()| out.flush()).map_err(failed)?;
    }
    let link = if arguments.link { Some(link::encode(&scenario).map_err(Failure::Link)?) } else { None };
    print(arguments, link, &digest, &finished, &experiment)
        .map_err(|error| Failure::File(PathBuf::from("standard output"), error))?;
    timing.map_or(Ok(()), |timing| arguments.timing.report(&timing, scenario.clock_hz))
}

/// The files that were asked for, each with its path.
fn open(arguments: &Arguments, experiment: &Experiment) -> Result<Files, Failure> {
    let config = experiment.config();
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
    add(&arguments.packets, &|out| Ok(files::packets(out)))?;
    Ok(opened)
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
        .map(|send| ScriptedSend { start_cycle: send.start.0, bytes: Hex(send.bytes.to_vec()), frame: None })
        .collect();
    scenario.source = Source::Line(LineScript { sends });
    scenario
}

fn print(
    arguments: &Arguments,
    link: Option<String>,
    digest: &Digest,
    run: &Run,
    experiment: &Experiment,
) -> io::Result<()> {
    let mut out = io::stdout().lock();
    if let Some(link) = link {
        writeln!(out, "#{link}")?;
    }
    if arguments.digest && !arguments.status {
        return writeln!(out, "{:016x}", digest.value());
    }
    if !arguments.status && arguments.asks_for_a_file() {
        return Ok(());
    }
    let channels = usize::from(experiment.config().channels());
    let positions: Vec<String> = run.positions().iter().take(channels).map(i32::to_string).collect();
    let faults: Vec<&str> = run.faults().names().collect();
    let faults = if faults.is_empty() { "none".into() } else { faults.join(" ") };
    writeln!(out, "digest {:016x}", digest.value())?;
    writeln!(out, "cycles {}", run.cycles().0)?;
    writeln!(out, "records {}", digest.records())?;
    writeln!(out, "ticks_done {}", run.ticks_done())?;
    writeln!(out, "positions {}", positions.join(" "))?;
    writeln!(out, "faults {:#06x} {faults}", run.faults().bits())
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    if path == Path::new("-") {
        let mut bytes = Vec::new();
        io::stdin().read_to_end(&mut bytes)?;
        return Ok(bytes);
    }
    fs::read(path)
}
