//! `stepscope send`: sends a scenario's ticks to real controllers (LIVE H3), with the protocol logic of a simulated
//! host. Reports a tick as done only if the controller has confirmed it.

use super::port::{Port, Received, Rs485, Serial, Socket};
use super::stop_watch::{StopWatch, wake_on_time};
use super::{raw, status_line::StatusLine, wire::Wire};
use crate::options::{Json, ShowProgress};
use crate::{failure::Failure, interrupt, json::Tables, quantity::whole, scenarios, terminal};
use clap::Args;
use serde_json::json;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;
use stepscope_core::peripheral::units::{Cycles, Instant};
use stepscope_core::peripheral::wire::{frame, schedule::line_time};
use stepscope_core::peripheral::{config::Protocol, protocol::Kind};
use stepscope_core::sim::framed_host::{Conversation, HostStatus, Report, for_real_line};
use stepscope_core::sim::session::{Pace, SessionClock};
use stepscope_core::sim::{Experiment, raw_host::RawHost};

/// Above this rate, RTS would drop too late.
const MAX_RTS_BAUD: u32 = 9600;
const WRITE_LIMIT: Duration = Duration::from_secs(2);
const WAIT: Duration = Duration::from_millis(10);
const BROADCAST: u8 = 255;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    scenario: PathBuf,
    /// Port to send to: a serial port, tcp:ADDRESS or pty:PATH
    #[arg(long, value_name = "PORT")]
    port: String,
    /// Additional time limit of each reply, in ms, for the system and the adapter
    #[arg(long, value_name = "MS", default_value_t = 50, value_parser = whole::<u64>(0..=60_000))]
    slack: u64,
    /// Number of raw packets to send ahead, fewer than the queue holds
    ///
    /// A delay shorter than this number of ticks then causes no underrun.
    #[arg(long, value_name = "PACKETS", default_value_t = 0, value_parser = whole::<u8>(0..=254))]
    lead: u8,
    /// How the direction of an RS-485 transceiver is switched
    #[arg(long, value_enum, default_value_t)]
    rs485: Rs485,
    /// Expect and check an echo of the sent bytes
    #[arg(long)]
    echo: bool,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    show: ShowProgress,
}

enum Job {
    Raw(RawHost),
    Framed(Conversation),
}

pub(crate) fn send(arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.scenario;
    let experiment = Experiment::new(&for_real_line(scenarios::read(path)?));
    let experiment = experiment.map_err(|problems| Failure::Scenario(path.clone(), problems))?;
    let job = prepare(arguments, &experiment)?;
    wake_on_time();
    // Until here a signal ends the command at once, even while it waits for a pipe.
    interrupt::watch()?;
    let baud = experiment.baud();
    let port = open(&arguments.port, baud, arguments.rs485)?;
    let wire = &mut Wire::new(port, arguments.rs485 == Rs485::Rts, arguments.echo);
    let conversation = match job {
        Job::Raw(host) => return raw::send(host, wire, (arguments.json.json, arguments.show.progress)),
        Job::Framed(conversation) => conversation,
    };
    let clock_hz = experiment.config().clock_hz();
    let slack = Cycles(u64::from(clock_hz) * arguments.slack / 1000);
    let mut sender = Sender {
        host: conversation.with_slack(slack),
        clock: SessionClock::new(clock_hz, Pace::REAL_TIME, u64::MAX),
        clock_hz,
        baud,
        watch: StopWatch::start(),
        line: StatusLine::new(arguments.show.progress),
        interrupts: 0,
    };
    let ended = sender.run(wire);
    // Ends the status line before the report.
    drop(std::mem::replace(&mut sender.line, StatusLine::new(false)));
    let is_interrupted = sender.interrupts > 0;
    let report = Report::new(&experiment, &mut sender.host, is_interrupted);
    print(&report, wire, baud, (arguments.json.json, ended.as_ref().err()))?;
    ended?;
    if is_interrupted {
        return Err(Failure::Interrupted);
    }
    report.doubt().map_or(Ok(()), |why| Err(Failure::Check(why)))
}

/// Checks what can be checked before the port is opened.
fn prepare(arguments: &Arguments, experiment: &Experiment) -> Result<Job, Failure> {
    let invalid = |why| Err(Failure::invalid(&arguments.scenario, why));
    if experiment.segments().is_some() {
        return invalid("the scenario has segments, so there are no ticks to send; use the engine ticks");
    }
    let baud = experiment.baud();
    if arguments.rs485 == Rs485::Rts && baud > MAX_RTS_BAUD {
        return Err(Failure::Option(format!(
            "--rs485: rts is too slow for {baud} baud; use at most {MAX_RTS_BAUD} baud, or kernel or auto"
        )));
    }
    if experiment.config().protocol() == Protocol::Raw {
        return raw::host(experiment, arguments.lead).map(Job::Raw);
    }
    if arguments.lead > 0 {
        let why = "is for raw packets only; omit it, because the framed protocol keeps the queue filled";
        return Err(Failure::Option(format!("--lead: {} {why}", arguments.lead)));
    }
    match experiment.conversation(Instant(1)) {
        Some(conversation) => Ok(Job::Framed(conversation)),
        None => invalid(
            "replies to a line script are unknown, so nothing can be confirmed; use a motion or packets as the source",
        ),
    }
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

    fn run(&mut self, wire: &mut Wire) -> Result<(), Failure> {
        let lost = |error: io::Error| Failure::LostPort(error.to_string());
        let mut buffer = [0; 4096];
        while !self.host.is_over() {
            self.handle_interrupts(wire)?;
            let now = self.now();
            while self.host.deadline() <= now {
                if let Some(bytes) = self.host.poll(now) {
                    wire.write(&bytes, WRITE_LIMIT).map_err(lost)?;
                    let written = self.now();
                    let takes = line_time(bytes.len() as u64, self.clock_hz, self.baud);
                    // The system does not report when the bytes have been sent, only that it has taken them.
                    self.host.sent(now.max(written) + Cycles(takes));
                }
            }
            let due = Cycles(self.host.deadline().0.saturating_sub(self.now().0));
            let wait = Duration::from_nanos(self.clock.nanos(due)).min(WAIT);
            match wire.port.read(&mut buffer, wait).map_err(lost)? {
                Received::Bytes(count) => {
                    let now = self.now();
                    let bytes = wire.without_echo(buffer.get(..count).unwrap_or_default());
                    bytes.into_iter().for_each(|byte| self.host.receive(byte, now));
                }
                Received::Gone | Received::Ended => {
                    return Err(Failure::LostPort("the other end closed the connection".to_owned()));
                }
                Received::Nothing | Received::Connected => {}
            }
            let Self { line, host, .. } = self;
            line.update(|| HostStatus::new(host).to_string());
        }
        Ok(())
    }

    /// The first Ctrl-C sends STOP until it is acknowledged; the second sends STOP to all and ends.
    fn handle_interrupts(&mut self, wire: &mut Wire) -> Result<(), Failure> {
        let count = interrupt::count();
        if count > self.interrupts {
            if self.interrupts == 0 && count == 1 {
                self.line.note(
                    "stopping: sending STOP until it is acknowledged; press Ctrl-C again to end at once",
                );
                let now = self.now();
                self.host.stop(now);
            } else {
                let mut stop = frame::emit(BROADCAST, Kind::Stop as u8, &[]);
                stop.insert(0, frame::DELIMITER);
                let _ = wire.write(&stop, WRITE_LIMIT);
                let _ = wire.port.drain();
                self.interrupts = count;
                return Err(Failure::Interrupted);
            }
            self.interrupts = count;
        }
        Ok(())
    }
}

fn print(
    report: &Report,
    wire: &Wire,
    baud: u32,
    (as_json, failure): (bool, Option<&Failure>),
) -> Result<(), Failure> {
    let lost = failure.map(ToString::to_string);
    if as_json {
        return tables(report, wire, lost.as_deref()).print();
    }
    let mut out = terminal::out();
    let mut write = || -> io::Result<()> {
        write!(out, "{report}")?;
        if let Some(errors) = wire.port.line_errors().filter(|errors| !errors.is_none()) {
            writeln!(out, "line_errors {errors}; set the other end to {baud} baud")?;
        }
        if wire.collisions() > 0 {
            writeln!(
                out,
                "collisions {}: the echo differs from the bytes that were sent",
                wire.collisions()
            )?;
        }
        out.flush()
    };
    write().map_err(Failure::output)
}

fn tables(report: &Report, wire: &Wire, lost: Option<&str>) -> Tables {
    let Report { rows, counts } = report;
    let verified = lost.is_none() && report.doubt().is_none();
    let summary = json!({
        "protocol": "framed",
        "outcome": if verified { "done" } else { "not verified" },
        "why": lost.map(str::to_owned).or_else(|| report.doubt()),
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
            "reports_positions": !row.known.hides_positions,
        })
    });
    let positions = rows.iter().flat_map(|row| {
        let channels = row.bounds.as_ref().map_or(0, |(least, _)| least.len());
        (0..channels).map(move |channel| {
            let of = |list: Option<&Vec<i32>>| list.and_then(|list| list.get(channel).copied());
            let reported = row.known.positions.and_then(|reported| reported.as_slice().get(channel).copied());
            json!({
                "controller": row.controller,
                "channel": channel,
                "reported": reported,
                "expected": of(row.expected.as_ref()),
                "steps_of_done_ticks": of(row.bounds.as_ref().map(|(least, _)| least)),
                "steps_with_the_next_tick": of(row.bounds.as_ref().map(|(_, most)| most)),
            })
        })
    });
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
