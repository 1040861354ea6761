//! `stepscope serve`: a scenario's controllers behind a port, or operated by lines on standard input (LIVE H2).

use super::keyboard::Keyboard;
use super::port::{Listener, Port, Rs485, Serial};
use super::recording::{self, Files, times_path};
use super::server::{Pacing, Server, Settings};
use crate::failure::{Failure, plural};
use crate::output::{self, Outputs};
use crate::terminal::{self, Escaped};
use crate::{interrupt, quantity::whole, scenarios};
use clap::Args;
use std::path::{Path, PathBuf};
use std::{io::Write, net::SocketAddr};
use stepscope_core::sim::session::{Pace, Session};

#[derive(Args)]
#[command(group(clap::ArgGroup::new("where").args(["pty", "tcp", "port"])))]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    ///
    /// Its own packets are ignored, because another program is the host. Stand-alone controllers have no serial line.
    /// Operate their buttons with lines of text on standard input, such as `press start 100ms`; `help` lists them.
    scenario: PathBuf,
    /// Open a pseudo-terminal and print its path; LINK becomes a symbolic link to it
    #[cfg_attr(not(unix), arg(hide = true))]
    #[arg(long, value_name = "LINK", num_args = 0..=1)]
    pty: Option<Option<PathBuf>>,
    /// Listen on an address, such as 127.0.0.1:4000 (port 0: any free port)
    ///
    /// Serves the raw bytes of the line to one client at a time.
    #[arg(long, value_name = "ADDRESS", value_parser = address)]
    tcp: Option<SocketAddr>,
    /// Allow addresses that other machines can reach
    #[arg(long, alias = "open", requires = "tcp")]
    allow_remote: bool,
    /// Serve a host on this serial port
    #[arg(long, value_name = "DEVICE")]
    port: Option<PathBuf>,
    /// Maximum delay of the model, in ms, before its clock is set back
    ///
    /// If the clock is set back, the session continues, and its exit code is 3.
    #[arg(long, value_name = "MS", default_value_t = 50, value_parser = whole::<u64>(1..=60_000))]
    lag: u64,
    /// Speed relative to real time, 0.001 to 100, or `max`
    ///
    /// With `max`, bytes take no time, and the model continues when the host has been silent for 10 ms.
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = pace)]
    pace: Pacing,
    /// Record the session as a scenario, with its wall-clock times in NAME.session.json
    ///
    /// Runs the scenario again to check that the digest is the same.
    #[arg(short = 'o', long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Stop when the client disconnects
    ///
    /// Stand-alone controllers stop when standard input has ended and nothing is pending.
    #[arg(long)]
    once: bool,
    /// Show status even if standard error is not a terminal
    #[arg(long)]
    progress: bool,
}

fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse().map_err(|_| "not an address with a port; use both, such as 127.0.0.1:4000".to_owned())
}

fn pace(text: &str) -> Result<Pacing, String> {
    if text == "max" { Ok(Pacing::Max) } else { Ok(Pacing::Real(text.parse::<Pace>()?)) }
}

pub(crate) fn serve(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let times = arguments.record.as_deref().map(times_path);
    let paths = || arguments.record.iter().chain(&times).map(PathBuf::as_path);
    if let Some(path) = paths().find(|path| !output::can_be_file(path)) {
        let why = format!(
            "--record: {} is not a file; a recording has two, NAME.json and NAME.session.json; use --record NAME.json",
            Escaped::path(path)
        );
        return Err(Failure::Option(why));
    }
    let link = arguments.pty.iter().flatten().map(|link| ("pty", link.as_path()));
    let mut outputs = Outputs::check(Some(path), paths().map(|path| ("record", path)).chain(link))?;
    let scenario = scenarios::read(path)?;
    let session = Session::new(&scenario).map_err(|problems| Failure::Scenario(path.clone(), problems))?;
    let mut create = |path: &Path| outputs.create(path).map(|out| (path.to_owned(), out));
    let files = match (&arguments.record, &times) {
        (Some(record), Some(times)) => Some(Files { scenario: create(record)?, times: create(times)? }),
        _ => None,
    };
    // Until here a signal ends the command at once, even while it waits for a pipe.
    interrupt::watch()?;
    let port = open(arguments, &session)?;
    let Arguments { pace, lag, once, progress, .. } = *arguments;
    let records = arguments.record.is_some();
    let mut server =
        Server::new(&Settings { pacing: pace, lag_ms: lag, records, once, progress }, session, port);
    let ended = server.run();
    // A closed standard output must not lose the recording.
    let printed = server.print_end().map_err(Failure::output);
    if let Some(files) = files {
        let record = files.scenario.0.clone();
        let verified = recording::write(&server.session, (&server.clock, &server.times), files)?;
        outputs.commit()?;
        verified.map_err(|why| {
            let record = Escaped::path(&record);
            Failure::Check(format!(
                "{record}: written, but the recording does not reproduce the session: {why}"
            ))
        })?;
        server.line.note("recorded");
        if printed.is_ok()
            && let Some(link) = recording::link(&server.session.recording().scenario)
        {
            writeln!(terminal::out(), "#{link}").map_err(Failure::output)?;
        }
    }
    printed?;
    ended?;
    let setbacks = server.clock.setbacks();
    if setbacks.count > 0 {
        let ms = server.clock.nanos(setbacks.cycles) as f64 / 1e6;
        return Err(Failure::Check(format!(
            "not in real time: the clock was set back {} time{}, by {ms:.0} ms in total (the recording is still reproducible); use a longer --lag or a lower --pace",
            setbacks.count,
            plural(setbacks.count)
        )));
    }
    Ok(())
}

fn open(arguments: &Arguments, session: &Session) -> Result<Box<dyn Port>, Failure> {
    if session.run().stand_alone().is_some() {
        return open_keyboard(arguments);
    }
    let baud = session.experiment().baud();
    let print = |text: String| {
        let mut out = terminal::out();
        writeln!(out, "{text}").and_then(|()| out.flush()).map_err(Failure::output)
    };
    if let Some(address) = arguments.tcp {
        let (listener, address) = Listener::open(address, arguments.allow_remote)?;
        print(format!("tcp:{address}"))?;
        return Ok(Box::new(listener));
    }
    if let Some(device) = &arguments.port {
        let port = Serial::open(device, baud, Rs485::Auto)?;
        print(device.display().to_string())?;
        return Ok(Box::new(port));
    }
    #[cfg(unix)]
    if let Some(link) = &arguments.pty {
        let pty = super::port::Pty::open(link.as_deref(), baud)?;
        print(format!("pty:{}", pty.path.display()))?;
        return Ok(Box::new(pty));
    }
    Err(Failure::Option(match arguments.pty {
        Some(_) => "--pty: this system has no pseudo-terminals; use --tcp 127.0.0.1:4000".to_owned(),
        None => "no connection is given; use --pty, --tcp 127.0.0.1:4000 or --port DEVICE".to_owned(),
    }))
}

fn open_keyboard(arguments: &Arguments) -> Result<Box<dyn Port>, Failure> {
    if arguments.pty.is_some() || arguments.tcp.is_some() || arguments.port.is_some() {
        let why = "a stand-alone controller has no line; omit --pty, --tcp and --port, and write lines such as `press start 100ms` to standard input";
        return Err(Failure::Option(format!("{}: {why}", arguments.scenario.display())));
    }
    let keyboard = Keyboard::open().map_err(Failure::threads)?;
    writeln!(terminal::out(), "stdin").map_err(Failure::output)?;
    Ok(Box::new(keyboard))
}
