//! `stepscope serve`: the controllers of a scenario behind a pseudo-terminal, a socket or a real port, against the wall clock
//! (LIVE H1, H2, H5).
//!
//! ```text
//! round   the model runs to the clock's cycle, a millisecond at most ── replies that have left are written
//!         ── bytes are read, and come after that cycle
//! ```

use super::{
    histogram::Histogram,
    interrupt,
    port::{Heard, Listener, Port, Rs485, Serial},
    sidecar::{Sidecar, beside},
    status_line::StatusLine,
    stop_watch::StopWatch,
};
use crate::{
    failure::Failure,
    output::{Out, Outputs},
    scenarios,
};
use clap::Args;
use std::{
    collections::VecDeque,
    io::{self, Write},
    net::SocketAddr,
    path::{Path, PathBuf},
    time::Duration,
};
use stepscope_core::{
    peripheral::{
        trace::Digest,
        units::{Cycles, Instant},
    },
    sim::{
        Summary,
        session::{NotTheSession, Pace, Recording, Session, SessionClock},
    },
};

/// Cycles of a round at most: as many records, at the very most.
const MAX_ROUND: u64 = 1_000_000;
/// How long is waited for bytes where nothing else is due.
const IDLE_WAIT: Duration = Duration::from_millis(5);
/// With `--pace max`: what the host may think before the model goes on without it.
const THINKING: Duration = Duration::from_millis(10);
/// Bytes of replies that wait for a host that does not read. Then it misses the oldest, as it would of a real line.
const MAX_WAITING: usize = 1 << 16;

/// What `stepscope serve` takes.
#[derive(Args)]
#[command(group(clap::ArgGroup::new("where").required(true).args(["pty", "tcp", "port"])))]
pub(crate) struct Arguments {
    /// The scenario: a JSON file, or a preset's name. Of it the controllers and their line are served; what it sends is left
    /// out, for the host comes from outside.
    scenario: PathBuf,
    /// Make a pseudo-terminal and print its path; LINK becomes a symbolic link to it.
    #[cfg_attr(not(unix), arg(hide = true))]
    #[arg(long, value_name = "LINK", num_args = 0..=1)]
    pty: Option<Option<PathBuf>>,
    /// Listen on an address, such as 127.0.0.1:4000 (port 0: one that is free): the line's bytes as they are, one client.
    #[arg(long, value_name = "ADDRESS")]
    tcp: Option<SocketAddr>,
    /// Listen also where others than this machine can connect.
    #[arg(long, requires = "tcp")]
    open: bool,
    /// Answer a real host on a real port.
    #[arg(long, value_name = "DEVICE")]
    port: Option<PathBuf>,
    /// How late the model may be, in ms, before its clock is set back. That is told, and ends with exit code 3.
    #[arg(long, value_name = "MS", default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..=60_000))]
    lag: u64,
    /// How fast time goes, 0.001 to 100; or `max`: the line takes no time, and the model goes on by itself where the host
    /// is silent for 10 ms.
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = pace)]
    pace: Pacing,
    /// Write the session as a scenario, whose run gives the same digest (that is checked), and beside it NAME.session.json
    /// with its wall-clock times.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// End when the client goes.
    #[arg(long)]
    once: bool,
    /// Show the status also where standard error is no terminal.
    #[arg(long)]
    progress: bool,
}

/// How a session's time goes.
#[derive(Clone, Copy)]
enum Pacing {
    Real(Pace),
    Max,
}

fn pace(text: &str) -> Result<Pacing, String> {
    if text == "max" { Ok(Pacing::Max) } else { Ok(Pacing::Real(text.parse::<Pace>()?)) }
}

/// What comes from outside. A stand-alone controller's buttons and switches, from lines on standard input, will be another
/// kind; all of them come after the cycle that the model stands behind.
enum Input<'a> {
    /// Bytes of the line.
    Bytes(&'a [u8]),
}

/// Serves until it is told to end.
pub(crate) fn serve(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let beside = arguments.record.as_deref().map(beside);
    let files = arguments.record.iter().chain(&beside).map(PathBuf::as_path);
    let mut outputs = Outputs::judge(Some(path), files)?;
    let scenario = scenarios::read(path)?;
    let session = Session::new(&scenario).map_err(|problems| Failure::Scenario(path.clone(), problems))?;
    interrupt::watch()?;
    let mut create = |path: &Path| outputs.create(path).map(|out| (path.to_owned(), out));
    let files = match (&arguments.record, &beside) {
        (Some(record), Some(beside)) => Some((create(record)?, create(beside)?)),
        _ => None,
    };
    let port = open(arguments, session.experiment().baud())?;
    let mut server = Server::new(arguments, session, port);
    let ended = server.run();
    server.print_end().map_err(Failure::output)?;
    if let Some(files) = files {
        let record = files.0.0.clone();
        let verified = server.write_recording(files)?;
        outputs.commit()?;
        verified.map_err(|why| Failure::NotRecorded(record, why.to_string()))?;
        server.line.note("recorded");
    }
    ended?;
    let stretches = server.clock.stretches();
    if stretches.count > 0 {
        let ms = server.clock.nanos(stretches.cycles) as f64 / 1e6;
        return Err(Failure::NotRealTime(stretches.count, ms));
    }
    Ok(())
}

/// Opens where the line goes, and says where that is.
fn open(arguments: &Arguments, baud: u32) -> Result<Box<dyn Port>, Failure> {
    let tell = |text: String| {
        let mut out = io::stdout().lock();
        writeln!(out, "{text}").and_then(|()| out.flush()).map_err(Failure::output)
    };
    if let Some(address) = arguments.tcp {
        let (listener, address) = Listener::open(address, arguments.open)?;
        tell(format!("tcp:{address}"))?;
        return Ok(Box::new(listener));
    }
    if let Some(device) = &arguments.port {
        let port = Serial::open(device, baud, Rs485::Auto)?;
        tell(device.display().to_string())?;
        return Ok(Box::new(port));
    }
    #[cfg(unix)]
    if let Some(link) = &arguments.pty {
        let pty = super::port::Pty::open(link.as_deref(), baud)?;
        tell(format!("pty:{}", pty.path.display()))?;
        return Ok(Box::new(pty));
    }
    Err(Failure::Option("there are no pseudo-terminals here; give --tcp 127.0.0.1:4000".to_owned()))
}

struct Server {
    session: Session,
    port: Box<dyn Port>,
    pacing: Pacing,
    clock: SessionClock,
    watch: StopWatch,
    once: bool,
    /// Bytes of replies that the port has not taken.
    waiting: VecDeque<u8>,
    missed: u64,
    late: Histogram,
    sidecar: Sidecar,
    line: StatusLine,
}

impl Server {
    fn new(arguments: &Arguments, session: Session, port: Box<dyn Port>) -> Self {
        let clock_hz = session.experiment().config().clock_hz();
        let (pace, name) = match arguments.pace {
            Pacing::Real(pace) => (pace, pace.to_string()),
            Pacing::Max => (Pace::REAL_TIME, "max".to_owned()),
        };
        Self {
            session,
            port,
            pacing: arguments.pace,
            clock: SessionClock::new(clock_hz, pace, arguments.lag * 1_000_000),
            watch: StopWatch::start(),
            once: arguments.once,
            waiting: VecDeque::new(),
            missed: 0,
            late: Histogram::default(),
            sidecar: Sidecar::new(name, arguments.lag),
            line: StatusLine::new(arguments.progress),
        }
    }

    /// Round after round, until Ctrl-C, or until the client goes where that is the end.
    fn run(&mut self) -> Result<(), Failure> {
        let mut buffer = [0; 4096];
        let (mut looked, mut silent_since) = (Duration::ZERO, self.watch.elapsed());
        while interrupt::count() == 0 {
            let wait = self.round(silent_since);
            self.write_replies().map_err(lost)?;
            let heard = self.port.read(&mut buffer, wait).map_err(lost)?;
            match heard {
                Heard::Bytes(count) => {
                    silent_since = self.watch.elapsed();
                    self.catch_up(silent_since)?;
                    self.take(&Input::Bytes(buffer.get(..count).unwrap_or_default()));
                }
                Heard::Gone => {
                    self.line.note("the client has gone");
                    self.waiting.clear();
                    if self.once {
                        return Ok(());
                    }
                }
                Heard::Nothing => {}
            }
            if self.watch.elapsed().saturating_sub(looked) > Duration::from_millis(20) {
                looked = self.watch.elapsed();
                if let Some(text) = self.port.look() {
                    self.line.note(&text);
                }
            }
            let Self { line, session, clock, late, .. } = self;
            line.tell(|| status(session, clock, late));
        }
        Ok(())
    }

    /// Runs to the clock's cycle, so that what was just read does not come before its time.
    fn catch_up(&mut self, silent_since: Duration) -> Result<(), Failure> {
        while matches!(self.pacing, Pacing::Real(_)) && self.round(silent_since).is_zero() {
            self.write_replies().map_err(lost)?;
        }
        Ok(())
    }

    /// What came, after the cycle that the model stands behind.
    fn take(&mut self, input: &Input<'_>) {
        match input {
            Input::Bytes(bytes) => {
                let recorded = self.session.records_all();
                self.session.receive(bytes);
                self.sidecar.chunk(self.watch.nanos(), self.session.now().0, bytes.len());
                if recorded && !self.session.records_all() {
                    self.line.note("more bytes than a recording may have: the session goes on unrecorded");
                }
            }
        }
    }

    /// Runs the model on, a round at most; how long may be waited for bytes then.
    fn round(&mut self, silent_since: Duration) -> Duration {
        let now = self.session.now();
        let clock_hz = u64::from(self.session.experiment().config().clock_hz());
        let step = (clock_hz / 1000).clamp(1, MAX_ROUND);
        let (to, wait) = match self.pacing {
            Pacing::Real(_) => {
                let target = self.clock.target(self.watch.nanos(), now);
                let to = target.min(Instant(now.0 + step));
                (to, if to < target { Duration::ZERO } else { IDLE_WAIT })
            }
            Pacing::Max if self.session.is_busy() => (self.session.deadline(), Duration::ZERO),
            Pacing::Max if self.watch.elapsed().saturating_sub(silent_since) < THINKING => (now, THINKING),
            Pacing::Max if !self.session.is_at_rest() => (Instant(now.0 + MAX_ROUND), Duration::ZERO),
            Pacing::Max => (now, IDLE_WAIT),
        };
        if to > now {
            self.session.advance::<Digest>(to, &mut []);
        }
        match (self.pacing, self.session.deadline()) {
            (Pacing::Real(_), due) if due != Instant::NEVER && wait > Duration::ZERO => {
                let cycles = Cycles(due.0.saturating_sub(self.session.now().0));
                wait.min(Duration::from_nanos(self.clock.nanos(cycles).max(1)))
            }
            _ => wait,
        }
    }

    /// Writes the replies that have left the model.
    fn write_replies(&mut self) -> io::Result<()> {
        let now_ns = self.watch.nanos();
        for reply in self.session.take_replies() {
            self.waiting.push_back(reply.byte);
            // A reply ends with its delimiter.
            if reply.byte == 0 {
                let late = match self.pacing {
                    Pacing::Real(_) => self.clock.late_ns(now_ns, reply.end),
                    Pacing::Max => 0,
                };
                self.late.add(late);
                self.sidecar.reply(reply.controller, reply.end.0, now_ns, late);
            }
        }
        if !self.port.is_connected() {
            self.waiting.clear();
        }
        while !self.waiting.is_empty() {
            let (bytes, _) = self.waiting.as_slices();
            let written = self.port.write(bytes)?;
            if written == 0 {
                break;
            }
            self.waiting.drain(..written);
        }
        let too_many = self.waiting.len().saturating_sub(MAX_WAITING);
        self.waiting.drain(..too_many);
        self.missed += too_many as u64;
        Ok(())
    }

    /// What the session came to.
    fn print_end(&mut self) -> io::Result<()> {
        let Self { session, .. } = self;
        let summary = Summary::new(session.experiment(), session.run(), session.digests());
        let mut out = io::stdout().lock();
        for controller in &summary.controllers {
            writeln!(out, "digest {:016x}", controller.digest)?;
        }
        write!(out, "{summary}")?;
        writeln!(out, "bytes_heard {}", session.heard())?;
        if self.late.count() > 0 {
            writeln!(out, "replies {} late{}", self.late.count(), self.late)?;
        }
        let stretches = self.clock.stretches();
        if stretches.count > 0 {
            writeln!(out, "stretches {} cycles {}", stretches.count, stretches.cycles.0)?;
        }
        if self.missed > 0 {
            writeln!(out, "reply_bytes_not_read {}", self.missed)?;
        }
        out.flush()
    }

    /// Writes the recording, and what was of the wall clock; gives whether it is the same run again.
    fn write_recording(
        &self,
        ((record, mut out), (beside, mut times)): (Named, Named),
    ) -> Result<Result<(), NotTheSession>, Failure> {
        let recording = self.session.recording();
        let whole = self.session.records_all();
        let verified = recording.verify();
        let mut rescue = Vec::new();
        let texts = [
            (&record, &mut out, format!("{}\n", recording.scenario.to_json())),
            (&beside, &mut times, self.sidecar.json(&self.clock, &recording, whole)),
        ];
        let mut failed = None;
        for (path, out, text) in texts {
            let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
            if let Err(error) = &written
                && failed.is_none()
            {
                failed = Some((path.clone(), error.to_string()));
            }
            rescue.push((path.clone(), text));
        }
        if let Some((path, error)) = failed {
            return Err(rescued(&path, &error, &rescue));
        }
        if !whole {
            let Recording { scenario, .. } = &recording;
            let cycles = scenario.run_cycles.unwrap_or(0);
            let _ =
                writeln!(io::stderr(), "recorded are the first {cycles} cycles: then there was no more room");
        }
        Ok(verified)
    }
}

type Named = (PathBuf, Out);

/// A recording that its disk does not take is written where there may be room.
fn rescued(path: &Path, error: &str, texts: &[(PathBuf, String)]) -> Failure {
    let mut places = Vec::new();
    for (path, text) in texts {
        let elsewhere = std::env::temp_dir().join(path.file_name().unwrap_or_default());
        if !elsewhere.exists() && std::fs::write(&elsewhere, text).is_ok() {
            places.push(elsewhere.display().to_string());
        }
    }
    let also = if places.is_empty() { "nothing could be written elsewhere" } else { "written instead:" };
    Failure::Port(path.display().to_string(), format!("{error}; {also} {}", places.join(" ")))
}

fn lost(error: io::Error) -> Failure {
    Failure::LostPort(error.to_string())
}

/// How things stand, in a line.
fn status(session: &Session, clock: &SessionClock, late: &Histogram) -> String {
    let config = session.experiment().config();
    let seconds = session.now().0 as f64 / f64::from(config.clock_hz().max(1));
    let mut text = format!("{seconds:8.1} s");
    let devices = session.run().devices().zip(session.experiment().configs());
    for (device, config) in devices.take(4) {
        if let Some(status) = device.status() {
            let queued = config.queue_depth() - status.free.min(config.queue_depth());
            text += &format!("  {} queue {queued}/{}", status.state.name(), config.queue_depth());
        }
        let positions = device.positions();
        let channels = usize::from(config.channels()).min(8);
        let positions: Vec<String> = positions.iter().take(channels).map(ToString::to_string).collect();
        text += &format!("  positions {}", positions.join(" "));
        let faults: Vec<String> = device.faults().names().map(|name| name.to_string()).collect();
        if !faults.is_empty() {
            text += &format!("  {}", faults.join(" "));
        }
    }
    if late.count() > 0 {
        text += &format!("  replies {} 99 % within {} ms", late.count(), late.within_ms(99));
    }
    let stretches = clock.stretches();
    if stretches.count > 0 {
        let ms = clock.nanos(stretches.cycles) / 1_000_000;
        text += &format!("  NOT REAL TIME: set back {} times, {ms} ms", stretches.count);
    }
    text
}
