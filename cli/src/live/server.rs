//! Runs a session in real time (LIVE H1, H2).
//!
//! ```text
//! round   run the model to the clock's cycle, at most 1 ms -> write complete replies -> read bytes for later cycles
//! ```
//!
//! For stand-alone controllers the bytes are lines on standard input, and nothing is written.

use super::panel::{self, Panel};
use super::port::{Port, Received};
use super::status_line::StatusLine;
use super::stop_watch::{StopWatch, wake_on_time};
use crate::{failure::Failure, interrupt, terminal};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use stepscope_core::peripheral::trace::Digest;
use stepscope_core::peripheral::units::{Cycles, Instant};
use stepscope_core::sim::session::{Input, Pace, Session, SessionClock};
use stepscope_core::sim::{Summary, lateness::Lateness, session_times::SessionTimes};

/// Maximum cycles per round, which limits the records.
const MAX_ROUND: u64 = 1_000_000;
const IDLE_WAIT: Duration = Duration::from_millis(5);
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// With `--pace max`: how long the model waits for the host.
const RESPONSE_TIME: Duration = Duration::from_millis(10);
/// Maximum bytes of replies for a host that does not read; the oldest are lost, as on a real line.
const MAX_UNSENT: usize = 1 << 16;
/// Rounds whose bytes are put on the line in advance, to wake once per frame instead of once per byte.
const ROUNDS_AHEAD: u64 = 10;

#[derive(Clone, Copy)]
pub(super) enum Pacing {
    Real(Pace),
    Max,
}

pub(super) struct Settings {
    pub(super) pacing: Pacing,
    pub(super) lag_ms: u64,
    pub(super) records: bool,
    pub(super) once: bool,
    pub(super) progress: bool,
}

pub(super) struct Server {
    pub(super) session: Session,
    port: Box<dyn Port>,
    panel: Option<Panel>,
    pacing: Pacing,
    pub(super) clock: SessionClock,
    watch: StopWatch,
    once: bool,
    /// The client has disconnected, or standard input has ended, with `once`.
    input_ended: bool,
    recording_is_full: bool,
    last_poll: Duration,
    silent_since: Duration,
    /// Bytes not yet on the line. While it is full nothing is read and the host waits.
    input: Input,
    /// Whether the client has stopped sending; its last bytes may still be buffered.
    client_is_leaving: bool,
    /// Bytes that clients had sent and that were dropped when they left.
    dropped_input: u64,
    /// Bytes of replies that the port has not accepted yet.
    unsent: VecDeque<u8>,
    /// Bytes of replies dropped because the host does not read.
    dropped_replies: u64,
    reply_delays: Lateness,
    last_wait: Duration,
    /// Since the last status line: the most that the model was behind the clock, less the time it had just slept.
    max_behind: Duration,
    pub(super) times: SessionTimes,
    pub(super) line: StatusLine,
}

impl Server {
    pub(super) fn new(settings: &Settings, session: Session, port: Box<dyn Port>) -> Self {
        let clock_hz = session.experiment().config().clock_hz();
        let (pace, name) = match settings.pacing {
            Pacing::Real(pace) => (pace, pace.to_string()),
            Pacing::Max => (Pace::REAL_TIME, "max".to_owned()),
        };
        Self {
            panel: session.run().stand_alone().map(|_| Panel::default()),
            session,
            port,
            pacing: settings.pacing,
            clock: SessionClock::new(clock_hz, pace, settings.lag_ms * 1_000_000),
            watch: StopWatch::start(),
            once: settings.once,
            input_ended: false,
            recording_is_full: false,
            last_poll: Duration::ZERO,
            silent_since: Duration::ZERO,
            input: Input::default(),
            client_is_leaving: false,
            dropped_input: 0,
            unsent: VecDeque::new(),
            dropped_replies: 0,
            reply_delays: Lateness::default(),
            last_wait: Duration::ZERO,
            max_behind: Duration::ZERO,
            times: SessionTimes::new(unix_ms(), name, settings.lag_ms, settings.records),
            line: StatusLine::new(settings.progress),
        }
    }

    pub(super) fn run(&mut self) -> Result<(), Failure> {
        wake_on_time();
        let mut buffer = [0; 4096];
        while interrupt::count() == 0 && !(self.input_ended && self.is_over()) {
            let wait = self.advance();
            self.write_replies().map_err(lost)?;
            let free = self.free_input().min(buffer.len());
            let received = match buffer.get_mut(..free) {
                Some(free @ [_, ..]) => self.port.read(free, wait),
                _ => self.port.wait(wait),
            };
            self.handle(received.map_err(lost)?, &buffer)?;
            if let Some(panel) = &mut self.panel {
                panel.execute(&mut self.session, &mut self.line);
            }
            self.report_events();
            let Self { line, session, clock, reply_delays, max_behind, port, .. } = self;
            line.update(|| {
                let text = status(session, (clock, std::mem::take(max_behind)), reply_delays);
                let errors = port.line_errors().filter(|errors| !errors.is_none());
                errors.map_or_else(|| text.clone(), |errors| format!("{text}  line errors: {errors}"))
            });
        }
        if interrupt::count() == 0 && self.session.jogs_without_end() {
            self.line.note(
                "a jog button is still pressed at the end of the input; add `release` lines to end the jog",
            );
        }
        Ok(())
    }

    fn handle(&mut self, received: Received, buffer: &[u8]) -> Result<(), Failure> {
        match received {
            Received::Bytes(count) => {
                self.silent_since = self.watch.elapsed();
                self.catch_up()?;
                self.receive(buffer.get(..count).unwrap_or_default());
            }
            Received::Connected => {
                // With `once`, a second client ends the session: the first had already stopped sending.
                self.input_ended |= self.once && self.client_is_leaving;
                self.drop_input();
            }
            Received::Ended => self.client_is_leaving = true,
            Received::Gone => {
                self.input_ended = self.once;
                self.disconnect();
            }
            Received::Nothing => {}
        }
        if self.client_is_leaving && self.is_client_done() {
            self.input_ended = self.once;
            self.port.hang_up();
            self.disconnect();
        }
        Ok(())
    }

    /// Reports events of the port, and when the recording is full.
    fn report_events(&mut self) {
        if !self.recording_is_full && !self.session.records_all() {
            self.recording_is_full = true;
            self.line.note("the recording has reached its maximum size: the session continues unrecorded");
        }
        let now = self.watch.elapsed();
        if now.saturating_sub(self.last_poll) > POLL_INTERVAL {
            self.last_poll = now;
            if let Some(text) = self.port.poll_events() {
                self.line.note(&text);
            }
        }
    }

    /// Runs the model up to the present, so that new bytes do not reach it too early.
    fn catch_up(&mut self) -> Result<(), Failure> {
        while matches!(self.pacing, Pacing::Real(_)) && self.advance().is_zero() {
            self.write_replies().map_err(lost)?;
        }
        Ok(())
    }

    fn receive(&mut self, bytes: &[u8]) {
        self.times.chunk(self.watch.nanos(), self.session.now(), bytes.len());
        if let Some(panel) = &mut self.panel {
            panel.receive(bytes);
            return;
        }
        self.input.push(bytes);
    }

    fn free_input(&self) -> usize {
        self.panel.as_ref().map_or_else(|| self.input.room(), Panel::room)
    }

    fn disconnect(&mut self) {
        if let Some(panel) = &mut self.panel {
            return panel.end_line();
        }
        self.line.note("client disconnected");
        self.drop_input();
    }

    /// Drops the input of the last client, so that the next one gets no reply to it.
    fn drop_input(&mut self) {
        let count = self.input.clear();
        if count > 0 {
            self.dropped_input += count as u64;
            self.line
                .note(&format!("dropped {count} bytes that the client sent faster than the line takes them"));
        }
        self.session.hang_up();
        self.unsent.clear();
        self.client_is_leaving = false;
    }

    /// Whether the client's bytes have been processed, and their replies sent if it still reads.
    fn is_client_done(&self) -> bool {
        let replies = self.port.is_connected() && !self.unsent.is_empty();
        self.input.is_empty() && !self.session.is_busy() && !replies
    }

    /// Whether nothing is pending; only a panel has pending work.
    fn is_over(&self) -> bool {
        let is_last = || self.session.is_idle() || self.session.jogs_without_end();
        self.panel.as_ref().is_none_or(|panel| panel.is_done() && is_last())
    }

    /// The next cycle with bytes to write or a line to execute. With `--pace max` no round goes beyond it; in real
    /// time only the wait ends at it.
    fn deadline(&self) -> Instant {
        let wait_until = self.panel.as_ref().and_then(|panel| panel.wait_until);
        // Waking for every byte would delay the process on a busy system.
        let due = self.session.deadline_of_round(Cycles(self.round_cycles()));
        wait_until.map_or(due, |until| until.min(due))
    }

    fn round_cycles(&self) -> u64 {
        let clock_hz = u64::from(self.session.experiment().config().clock_hz());
        (clock_hz / 1000).clamp(1, MAX_ROUND)
    }

    /// Runs one round of the model; returns how long to wait for bytes.
    fn advance(&mut self) -> Duration {
        let (to, wait) = match self.pacing {
            Pacing::Real(_) => self.real_round(),
            Pacing::Max => self.unpaced_round(),
        };
        if to > self.session.now() {
            self.session.advance::<Digest>(to, &mut []);
        }
        self.last_wait = match (self.pacing, self.deadline()) {
            (Pacing::Real(_), due) if due != Instant::NEVER && wait > Duration::ZERO => {
                let cycles = Cycles(due.0.saturating_sub(self.session.now().0));
                wait.min(Duration::from_nanos(self.clock.nanos(cycles).max(1)))
            }
            _ => wait,
        };
        self.last_wait
    }

    /// The end of a round in real time, and how long to wait after it.
    fn real_round(&mut self) -> (Instant, Duration) {
        let (now, step) = (self.session.now(), self.round_cycles());
        let target = self.clock.target(self.watch.nanos(), now);
        let behind = self.clock.nanos(Cycles(target.0.saturating_sub(now.0)));
        self.max_behind = self.max_behind.max(Duration::from_nanos(behind).saturating_sub(self.last_wait));
        let wait_until = self.panel.as_ref().and_then(|panel| panel.wait_until).unwrap_or(Instant::NEVER);
        let to = target.min(Instant(now.0 + step)).min(wait_until);
        self.input.feed(&mut self.session, to + Cycles(ROUNDS_AHEAD * step));
        (to, if to < target { Duration::ZERO } else { IDLE_WAIT })
    }

    /// The end of a round with `--pace max`, and how long to wait after it.
    fn unpaced_round(&mut self) -> (Instant, Duration) {
        let now = self.session.now();
        let (deadline, round_end) = (self.deadline(), Instant(now.0.saturating_add(MAX_ROUND)));
        if !self.input.is_empty() || deadline != Instant::NEVER {
            self.input.feed(&mut self.session, now + Cycles(MAX_ROUND));
            (self.deadline().min(round_end), Duration::ZERO)
        } else if self.watch.elapsed().saturating_sub(self.silent_since) < RESPONSE_TIME {
            // The host may still respond.
            (now, RESPONSE_TIME)
        } else if !self.session.is_idle() {
            (round_end, Duration::ZERO)
        } else {
            (now, IDLE_WAIT)
        }
    }

    fn write_replies(&mut self) -> io::Result<()> {
        let now_ns = self.watch.nanos();
        for reply in self.session.take_replies() {
            self.unsent.push_back(reply.byte);
            // A reply ends with its delimiter.
            if reply.byte == 0 {
                let late = match self.pacing {
                    Pacing::Real(_) => self.clock.late_ns(now_ns, reply.end),
                    Pacing::Max => 0,
                };
                self.reply_delays.add(late);
                self.times.reply(&reply, now_ns, late);
            }
        }
        if !self.port.is_connected() {
            self.unsent.clear();
        }
        while !self.unsent.is_empty() {
            let (bytes, _) = self.unsent.as_slices();
            let written = self.port.write(bytes)?;
            if written == 0 {
                break;
            }
            self.unsent.drain(..written);
        }
        let too_many = self.unsent.len().saturating_sub(MAX_UNSENT);
        self.unsent.drain(..too_many);
        self.dropped_replies += too_many as u64;
        Ok(())
    }

    pub(super) fn print_end(&mut self) -> io::Result<()> {
        let Self { session, .. } = self;
        let summary = Summary::new(session.experiment(), session.run(), session.digests());
        let mut out = terminal::out();
        for controller in &summary.controllers {
            writeln!(out, "digest {:016x}", controller.digest)?;
        }
        write!(out, "{summary}")?;
        if self.panel.is_none() {
            writeln!(out, "bytes_heard {}", session.received())?;
        }
        if self.reply_delays.count() > 0 {
            writeln!(out, "replies {} late{}", self.reply_delays.count(), self.reply_delays)?;
        }
        if let Some(errors) = self.port.line_errors() {
            writeln!(out, "line_errors {errors}")?;
        }
        let setbacks = self.clock.setbacks();
        if setbacks.count > 0 {
            // The word of the output's first version.
            writeln!(out, "stretches {} cycles {}", setbacks.count, setbacks.cycles.0)?;
        }
        if self.dropped_replies > 0 {
            writeln!(out, "reply_bytes_not_read {}", self.dropped_replies)?;
        }
        if self.dropped_input > 0 {
            writeln!(out, "bytes_dropped {}", self.dropped_input)?;
        }
        out.flush()
    }
}

fn unix_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

fn lost(error: io::Error) -> Failure {
    Failure::LostPort(error.to_string())
}

fn status(session: &Session, (clock, behind): (&SessionClock, Duration), late: &Lateness) -> String {
    let config = session.experiment().config();
    let seconds = session.now().0 as f64 / f64::from(config.clock_hz().max(1));
    let mut text = format!("{seconds:8.1} s  lag {:.1} ms", 1e3 * behind.as_secs_f64());
    if let Some(machine) = session.run().stand_alone() {
        text += &panel::status(machine);
        return text + &not_real_time(clock);
    }
    let devices = session.run().devices().zip(session.experiment().configs());
    for (device, config) in devices.take(4) {
        if let Some(status) = device.status() {
            let queued = config.queue_depth() - status.free.min(config.queue_depth());
            text += &format!("  {} queue {queued}/{}", status.state.name(), config.queue_depth());
        }
        let positions: Vec<String> = device.positions().iter().take(8).map(ToString::to_string).collect();
        text += &format!("  positions {}", positions.join(" "));
        let faults: Vec<String> = device.faults().names().map(|name| name.to_string()).collect();
        if !faults.is_empty() {
            text += &format!("  {}", faults.join(" "));
        }
    }
    if late.count() > 0 {
        text += &format!("  replies {} 99 % within {} ms", late.count(), late.within_ms(99));
    }
    text + &not_real_time(clock)
}

fn not_real_time(clock: &SessionClock) -> String {
    let setbacks = clock.setbacks();
    if setbacks.count == 0 {
        return String::new();
    }
    let ms = clock.nanos(setbacks.cycles) / 1_000_000;
    format!("  NOT REAL TIME: set back {} times, {ms} ms", setbacks.count)
}
