//! `stepscope send`: a scenario's ticks to real controllers (LIVE H3). Over the framed protocol by the very conversation that a
//! simulated run has; what is not confirmed by the controller is never said to be done.

use super::{
    interrupt,
    port::{Heard, Port, Rs485, Serial, Socket},
    raw,
    status_line::StatusLine,
    stop_watch::{StopWatch, wake_on_time},
    wire::Wire,
};
use crate::{failure::Failure, json::Tables, scenarios};
use clap::Args;
use serde_json::json;
use std::{
    io::{self, Write},
    path::{Path, PathBuf},
    time::Duration,
};
use stepscope_core::{
    peripheral::{
        config::Protocol,
        device::Faults,
        protocol::{Kind, State},
        units::{Cycles, Instant},
        wire::{frame, schedule::line_time},
    },
    scenario::{Noise, Scenario},
    sim::{
        Experiment,
        framed_host::{Conversation, Known, Progress},
        session::{Pace, SessionClock},
    },
};

/// Above this RTS cannot be dropped in time.
const MAX_RTS_BAUD: u32 = 9600;
/// How long a write is given beyond the line's own time.
const WRITE_WITHIN: Duration = Duration::from_secs(2);
const WAIT: Duration = Duration::from_millis(10);
/// All controllers.
const ALL: u8 = 255;

/// What `stepscope send` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario whose ticks are sent: a JSON file, or a preset's name.
    scenario: PathBuf,
    /// Where to: a serial port, tcp:ADDRESS, or pty:PATH.
    #[arg(long, value_name = "PORT")]
    port: String,
    /// How much longer than on the line a reply may take, in ms: what the system and the adapter add.
    #[arg(long, value_name = "MS", default_value_t = 50, value_parser = clap::value_parser!(u64).range(0..=60_000))]
    slack: u64,
    /// Of raw packets send so many ahead, less than the queue holds: what a late write may cost.
    #[arg(long, value_name = "PACKETS", default_value_t = 0)]
    lead: u8,
    /// Who turns an RS-485 transceiver.
    #[arg(long, value_enum, default_value_t)]
    rs485: Rs485,
    /// What is sent is heard again: it is compared and taken out.
    #[arg(long)]
    echo: bool,
    /// Print the report as JSON: one object of tables (docs/command.md).
    #[arg(long)]
    json: bool,
    /// Show the progress also where standard error is no terminal.
    #[arg(long)]
    progress: bool,
}

/// Sends the ticks, and says what is known of them.
pub(crate) fn send(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let scenario = Scenario { run_cycles: None, ..scenarios::read(path)? };
    let experiment = Experiment::new(&plain(scenario));
    let experiment = experiment.map_err(|problems| Failure::Scenario(path.clone(), problems))?;
    if experiment.segments().is_some() {
        let why = "segments run a controller by itself: there is nothing to send; choose ticks";
        return Err(Failure::Option(format!("{}: {why}", path.display())));
    }
    let baud = experiment.baud();
    if arguments.rs485 == Rs485::Rts && baud > MAX_RTS_BAUD {
        return Err(Failure::Option(format!(
            "--rs485 rts: at {baud} baud RTS cannot fall before the reply comes; up to {MAX_RTS_BAUD} baud, or give kernel or auto"
        )));
    }
    let is_raw = experiment.config().protocol() == Protocol::Raw;
    if arguments.lead > 0 && !is_raw {
        let why = "a framed line is answered, and keeps the queue filled by itself";
        return Err(Failure::Option(format!("--lead: {why}")));
    }
    raw::judge_lead(&experiment, arguments.lead)?;
    interrupt::watch()?;
    wake_on_time();
    let port = open(&arguments.port, baud, arguments.rs485)?;
    let wire = &mut Wire::new(port, arguments.rs485 == Rs485::Rts, arguments.echo);
    if is_raw {
        return raw::send(&experiment, wire, (arguments.lead, arguments.json, arguments.progress));
    }
    let clock_hz = experiment.config().clock_hz();
    let slack = Cycles(u64::from(clock_hz) * arguments.slack / 1000);
    let Some(conversation) = experiment.conversation(Instant(1)) else {
        let why = "a line script is sent as it stands, and nobody knows what is to be answered; send a motion or packets";
        return Err(Failure::Option(format!("{}: {why}", path.display())));
    };
    let mut sender = Sender {
        host: conversation.with_slack(slack),
        clock: SessionClock::new(clock_hz, Pace::REAL_TIME, u64::MAX),
        clock_hz,
        baud,
        watch: StopWatch::start(),
        line: StatusLine::new(arguments.progress),
        interrupts: 0,
    };
    let ended = sender.run(wire);
    drop(std::mem::replace(&mut sender.line, StatusLine::new(false)));
    let rows = sender.rows(&experiment);
    report(&rows, &sender, wire, (arguments.json, ended.as_ref().err()))?;
    let interrupted = sender.interrupts > 0;
    ended?;
    if interrupted {
        return Err(Failure::Interrupted);
    }
    match rows.iter().find_map(|row| row.doubt()) {
        None => Ok(()),
        Some(why) => Err(Failure::NotVerified(why)),
    }
}

/// Without what only a simulated line has.
fn plain(mut scenario: Scenario) -> Scenario {
    scenario.line.noise = Noise::default();
    scenario.line.glitches.clear();
    scenario
}

fn open(name: &str, baud: u32, rs485: Rs485) -> Result<Box<dyn Port>, Failure> {
    Ok(match name.split_once(':') {
        Some(("tcp", address)) => Box::new(Socket::connect(address)?),
        Some(("pty", path)) => Box::new(Serial::open(Path::new(path), baud, rs485)?),
        _ => Box::new(Serial::open(Path::new(name), baud, rs485)?),
    })
}

struct Sender {
    host: Conversation,
    clock: SessionClock,
    clock_hz: u32,
    baud: u32,
    watch: StopWatch,
    line: StatusLine,
    interrupts: usize,
}

impl Sender {
    fn now(&mut self) -> Instant {
        self.clock.target(self.watch.nanos(), Instant::RESET)
    }

    /// The whole conversation. An error is a port that is lost.
    fn run(&mut self, wire: &mut Wire) -> Result<(), Failure> {
        let lost = |error: io::Error| Failure::LostPort(error.to_string());
        let mut buffer = [0; 4096];
        while !self.host.is_over() {
            self.obey(wire)?;
            let now = self.now();
            while self.host.deadline() <= now {
                if let Some(bytes) = self.host.poll(now) {
                    wire.write(&bytes, WRITE_WITHIN).map_err(lost)?;
                    let written = self.now();
                    let takes = line_time(bytes.len() as u64, self.clock_hz, self.baud);
                    // Whether the system has sent it all when it has taken it all, it does not say.
                    self.host.sent(now.max(written) + Cycles(takes));
                }
            }
            let due = Cycles(self.host.deadline().0.saturating_sub(self.now().0));
            let wait = Duration::from_nanos(self.clock.nanos(due)).min(WAIT);
            match wire.port.read(&mut buffer, wait).map_err(lost)? {
                Heard::Bytes(count) => {
                    let now = self.now();
                    let bytes = wire.without_echo(buffer.get(..count).unwrap_or_default());
                    bytes.into_iter().for_each(|byte| self.host.hear(byte, now));
                }
                Heard::Gone => return Err(Failure::LostPort("the other end has closed it".to_owned())),
                Heard::Nothing => {}
            }
            let Self { line, host, .. } = self;
            line.tell(|| progress(host));
        }
        Ok(())
    }

    /// Ctrl-C: the first is STOP until it is acknowledged; the second one STOP to all, and the end.
    fn obey(&mut self, wire: &mut Wire) -> Result<(), Failure> {
        let count = interrupt::count();
        if count > self.interrupts {
            if self.interrupts == 0 && count == 1 {
                self.line.note("stopping: STOP until it is acknowledged; Ctrl-C once more ends at once");
                let now = self.now();
                self.host.stop(now);
            } else {
                let mut stop = frame::emit(ALL, Kind::Stop as u8, &[]);
                stop.insert(0, frame::DELIMITER);
                let _ = wire.write(&stop, WRITE_WITHIN);
                let _ = wire.port.drain();
                self.interrupts = count;
                return Err(Failure::Interrupted);
            }
            self.interrupts = count;
        }
        Ok(())
    }

    /// What is known of each controller that had something to do.
    fn rows(&mut self, experiment: &Experiment) -> Vec<Row> {
        let mut rows = Vec::new();
        for controller in 0..experiment.controllers() {
            let Some(job) = experiment.job(controller) else { continue };
            let told = self.host.known().nth(job).map(|(told, known)| (told.address, told.ticks(), *known));
            let ends = self.host.progress().nth(job).zip(self.host.acknowledged().nth(job));
            let (Some((address, ticks, known)), Some((progress, acknowledged))) = (told, ends) else {
                continue;
            };
            let done = known.ticks_done().map(|done| done.min(ticks));
            let expected = done.and_then(|done| self.host.expected(job, done));
            let bounds = done.map(|done| {
                let next = (done + 1).min(ticks);
                (self.host.sums(job, done), self.host.sums(job, next))
            });
            rows.push(Row {
                controller,
                address,
                ticks,
                acknowledged,
                progress,
                expected,
                bounds,
                done,
                known,
            });
        }
        rows
    }
}

/// How far it is, in a line.
fn progress(host: &Conversation) -> String {
    let (mut done, mut all) = (0, 0);
    for (job, known) in host.known() {
        done += u64::from(known.ticks_done().unwrap_or(0).min(job.ticks()));
        all += u64::from(job.ticks());
    }
    let accepted: u64 = host.acknowledged().map(u64::from).sum();
    let counts = host.counts();
    let words: Vec<&str> = host.progress().map(Progress::name).collect();
    format!(
        "{}: {accepted} ticks accepted, {done} done, {} left, {} repeats, {} NAKs",
        words.join(" "),
        all - accepted,
        counts.repeated,
        counts.refused
    )
}

/// What is known of one controller at the end.
struct Row {
    controller: usize,
    address: u8,
    ticks: u32,
    acknowledged: u32,
    progress: Progress,
    /// Ticks that it says are done.
    done: Option<u32>,
    /// Where these lead to.
    expected: Option<Vec<i32>>,
    /// How far they go, and how far with the next one, of which STOP may have left any part.
    bounds: Option<(Vec<i32>, Vec<i32>)>,
    known: Known,
}

impl Row {
    /// Fault flags that it did not have when it was opened.
    fn new_faults(&self) -> Vec<String> {
        let bits = |status: Option<frame::Status>| status.map_or(0, |status| status.faults);
        let new = bits(self.known.last) & !bits(self.known.opened);
        Faults::from_bits(new).names().map(|name| name.to_string()).collect()
    }

    fn is_ready(&self) -> bool {
        self.known.last.is_some_and(|last| last.state == State::Ready)
    }

    /// Why it is not known that all was done as it was ordered; `None` where it is.
    fn doubt(&self) -> Option<String> {
        let faults = self.new_faults();
        let controller = self.controller;
        match self.progress {
            Progress::Done if self.is_ready() && faults.is_empty() => None,
            Progress::Done if faults.is_empty() => Some(format!("controller {controller} is not READY")),
            Progress::Done => Some(format!(
                "controller {controller}: all ticks are done, but with faults: {}",
                faults.join(" ")
            )),
            progress => Some(format!("controller {controller}: {progress}")),
        }
    }
}

fn report(
    rows: &[Row],
    sender: &Sender,
    wire: &Wire,
    (as_json, failure): (bool, Option<&Failure>),
) -> Result<(), Failure> {
    let lost = failure.map(ToString::to_string);
    if as_json {
        return tables(rows, sender, wire, lost.as_deref()).print();
    }
    let mut out = io::stdout().lock();
    let mut write = || -> io::Result<()> {
        for row in rows {
            write_row(&mut out, row, sender.interrupts > 0)?;
        }
        let counts = sender.host.counts();
        writeln!(
            out,
            "frames {} repeated {} replies {} rejected {} refused {}",
            counts.frames, counts.repeated, counts.replies, counts.rejected, counts.refused
        )?;
        if let Some(errors) = wire.port.line_errors().filter(|errors| !errors.is_none()) {
            writeln!(out, "line_errors {errors}: is the other end at {} baud?", sender.baud)?;
        }
        if wire.collisions() > 0 {
            writeln!(out, "collisions {}: own bytes came back changed", wire.collisions())?;
        }
        out.flush()
    };
    write().map_err(Failure::output)
}

fn write_row(out: &mut impl Write, row: &Row, stopped: bool) -> io::Result<()> {
    let Row { controller, address, ticks, acknowledged, progress, done, known, .. } = row;
    writeln!(out, "controller {controller} address {address}: {progress}")?;
    match done {
        Some(done) => write!(out, "  ticks {done} of {ticks} done, {acknowledged} acknowledged")?,
        None => write!(out, "  ticks {ticks}, none sent: it was never opened")?,
    }
    if *progress != Progress::Done && *progress != Progress::Counted && done.is_none_or(|done| done < *ticks)
    {
        write!(out, "; tick {} is the first not known to be done", done.unwrap_or(0))?;
    }
    writeln!(out)?;
    let list = |positions: &[i32]| positions.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    match (&known.positions, &row.expected) {
        (Some(told), _) if *progress == Progress::Done => {
            writeln!(out, "  positions {}: the sums of the ticks", list(told.as_slice()))?;
        }
        (Some(told), Some(expected)) if known.stop_acknowledged => {
            let (told, expected) = (list(told.as_slice()), list(expected));
            writeln!(out, "  positions {told}; the ticks that are done lead to {expected}")?;
        }
        (Some(told), _) => writeln!(out, "  positions {} when they were told last", list(told.as_slice()))?,
        (None, _) if known.hides_positions => {
            writeln!(out, "  it does not know POSITIONS: how far its motors went is not told")?;
            if let Some((least, most)) = row.bounds.as_ref().filter(|_| known.stop_acknowledged) {
                let (least, most) = (list(least), list(most));
                let cut = "with all of the one that STOP cut short";
                writeln!(out, "  by the ticks that are done they went {least}, {cut} {most}")?;
            }
        }
        _ => {}
    }
    if known.stop_acknowledged {
        writeln!(out, "  STOP is acknowledged")?;
    } else if stopped && !matches!(progress, Progress::Done | Progress::Counted) {
        writeln!(out, "  STOP is not acknowledged")?;
    }
    if let Some(last) = known.last {
        let faults = row.new_faults();
        let faults = if faults.is_empty() { "none".to_owned() } else { faults.join(" ") };
        writeln!(out, "  state {}, new faults {faults}", last.state.name())?;
    }
    Ok(())
}

fn tables(rows: &[Row], sender: &Sender, wire: &Wire, lost: Option<&str>) -> Tables {
    let verified = lost.is_none() && rows.iter().all(|row| row.doubt().is_none());
    let summary = json!({
        "protocol": "framed",
        "outcome": if verified { "done" } else { "not verified" },
        "why": lost.map(str::to_owned).or_else(|| rows.iter().find_map(Row::doubt)),
        "collisions": wire.collisions(),
        "line_errors": wire.port.line_errors().map(|errors| errors.to_string()),
    });
    let controllers = rows.iter().map(|row| {
        json!({
            "controller": row.controller,
            "address": row.address,
            "progress": row.progress.name(),
            "why": row.doubt(),
            "ticks": row.ticks,
            "ticks_acknowledged": row.acknowledged,
            "ticks_done": row.done,
            "state": row.known.last.map(|last| last.state.name()),
            "new_faults": row.new_faults().join(" "),
            "stop_acknowledged": row.known.stop_acknowledged,
            "tells_positions": !row.known.hides_positions,
        })
    });
    let positions = rows.iter().flat_map(|row| {
        let channels = row.bounds.as_ref().map_or(0, |(least, _)| least.len());
        (0..channels).map(move |channel| {
            let of = |list: Option<&Vec<i32>>| list.and_then(|list| list.get(channel).copied());
            let told = row.known.positions.and_then(|told| told.as_slice().get(channel).copied());
            json!({
                "controller": row.controller,
                "channel": channel,
                "told": told,
                "expected": of(row.expected.as_ref()),
                "steps_of_done_ticks": of(row.bounds.as_ref().map(|(least, _)| least)),
                "steps_with_the_next_tick": of(row.bounds.as_ref().map(|(_, most)| most)),
            })
        })
    });
    let counts = sender.host.counts();
    let host = json!({
        "frames": counts.frames,
        "repeated": counts.repeated,
        "replies": counts.replies,
        "rejected": counts.rejected,
        "refused": counts.refused,
    });
    Tables::of("send")
        .with("send", [summary])
        .with("controllers", controllers)
        .with("positions", positions)
        .with("host", [host])
}
