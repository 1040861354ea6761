//! `stepscope run`: one scenario, from its file to digest, trace and status.

use clap::Args;
use std::{
    fmt, fs,
    io::{self, BufWriter, Read, Write},
    path::{Path, PathBuf},
    process::ExitCode,
};
use stepscope_core::{
    run::{Experiment, Run},
    scenario::Problem,
    signal::{Record, Sink},
    trace::{Digest, write_record},
};

/// What `stepscope run` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario, a JSON file; `-` reads standard input.
    scenario: PathBuf,
    /// Print only the digest of the trace: XXH64, 16 hexadecimal digits.
    #[arg(long)]
    digest: bool,
    /// Write the trace: one record a line, cycle and levels in hexadecimal; `-` writes standard
    /// output.
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Print positions, fault flags and ticks done.
    #[arg(long)]
    status: bool,
}

/// Why there is no result.
pub(crate) enum Failure {
    /// A file could not be read or written.
    File(PathBuf, io::Error),
    /// The scenario is wrong.
    Scenario(PathBuf, Vec<Problem>),
}

impl Failure {
    /// The command's exit code.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            Self::File(..) => ExitCode::from(1),
            Self::Scenario(..) => ExitCode::from(2),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Scenario(path, problems) => {
                let count = problems.len();
                let s = if count == 1 { "" } else { "s" };
                write!(f, "{}: {count} problem{s}", path.display())?;
                problems.iter().try_for_each(|problem| write!(f, "\n  {problem}"))
            }
        }
    }
}

/// Runs the scenario and prints what was asked for; digest and status if nothing was.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let text = read(path).map_err(|error| Failure::File(path.clone(), error))?;
    let experiment =
        Experiment::from_json(&text).map_err(|problems| Failure::Scenario(path.clone(), problems))?;

    let mut digest = Digest::default();
    let finished = match &arguments.trace {
        None => experiment.run(&mut digest),
        Some(file) => {
            let failed = |error| Failure::File(file.clone(), error);
            let mut out = Text::new(create(file).map_err(failed)?);
            let finished = experiment.run(&mut (&mut digest, &mut out));
            out.finish().map_err(failed)?;
            finished
        }
    };
    print(arguments, &digest, &finished, &experiment)
        .map_err(|error| Failure::File(PathBuf::from("standard output"), error))
}

fn print(arguments: &Arguments, digest: &Digest, run: &Run, experiment: &Experiment) -> io::Result<()> {
    let mut out = io::stdout().lock();
    if arguments.digest && !arguments.status {
        return writeln!(out, "{:016x}", digest.value());
    }
    if !arguments.status && arguments.trace.is_some() {
        return Ok(());
    }
    let device = run.device();
    let channels = usize::from(experiment.config().channels());
    let positions: Vec<String> = device.positions().iter().take(channels).map(i32::to_string).collect();
    let faults: Vec<&str> = device.faults().names().collect();
    let faults = if faults.is_empty() { "none".into() } else { faults.join(" ") };
    writeln!(out, "digest {:016x}", digest.value())?;
    writeln!(out, "cycles {}", run.cycles().0)?;
    writeln!(out, "records {}", digest.records())?;
    writeln!(out, "ticks_done {}", device.ticks_done())?;
    writeln!(out, "positions {}", positions.join(" "))?;
    writeln!(out, "faults {:#06x} {faults}", device.faults().bits())
}

fn read(path: &Path) -> io::Result<String> {
    if path == Path::new("-") {
        let mut text = String::new();
        io::stdin().read_to_string(&mut text)?;
        return Ok(text);
    }
    fs::read_to_string(path)
}

fn create(path: &Path) -> io::Result<Box<dyn Write>> {
    Ok(if path == Path::new("-") { Box::new(io::stdout()) } else { Box::new(fs::File::create(path)?) })
}

/// Writes records as text; the first error is kept until the end.
struct Text {
    out: BufWriter<Box<dyn Write>>,
    line: String,
    result: io::Result<()>,
}

impl Text {
    fn new(out: Box<dyn Write>) -> Self {
        Self { out: BufWriter::new(out), line: String::new(), result: Ok(()) }
    }

    fn finish(mut self) -> io::Result<()> {
        self.result.and_then(|()| self.out.flush())
    }
}

impl Sink for Text {
    fn record(&mut self, record: Record) {
        if self.result.is_ok() {
            self.line.clear();
            self.result = write_record(&mut self.line, record)
                .map_err(io::Error::other)
                .and_then(|()| self.out.write_all(self.line.as_bytes()));
        }
    }
}
