//! Runs a session in real time (LIVE H1, H2).
//!
//! ```text
//! round   run the model to the clock's cycle, at most 1 ms -> write finished replies -> read bytes, which come after that cycle
//! ```
//!
//! For stand-alone controllers the bytes are lines on standard input, and nothing is written.

use super::{
    panel::{self, Panel},
    port::{Port, Received},
    status_line::StatusLine,
    stop_watch::{StopWatch, wake_on_time},
};
use crate::{failure::Failure, interrupt, terminal};
use std::{
    collections::VecDeque,
    io::{self, Write},
    time::{Duration, SystemTime, UNIX_EPOCH},
};
use stepscope_core::{
    peripheral::{
        trace::Digest,
        units::{Cycles, Instant},
    },
    sim::{
        Summary,
        lateness::Lateness,
        session::{Input, Pace, Session, SessionClock},
        session_times::SessionTimes,
    },
};

/// Limits the cycles, and so the records, per round.
const MAX_ROUND: u64 = 1_000_000;
const IDLE_WAIT: Duration = Duration::from_millis(5);
/// With `--pace max`: the host's time to respond before the model goes on.
const THINKING: Duration = Duration::from_millis(10);
/// Replies for a host that does not read; the oldest are lost, as on a real line.
const MAX_WAITING: usize = 1 << 16;
/// Puts the bytes of several rounds on the line in advance, to wake once per frame rather than per byte.
const ROUNDS_AHEAD: u64 = 10;

#[derive(Clone, Copy)]
pub(super) enum Pacing {
    Real(Pace),
    Max,
}

pub(super) struct Settings {
    pub(super) pacing: Pacing,
    pub(super) lag: u64,
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
    /// Bytes not yet on the line. While it is full nothing is read and the host waits.
    input: Input,
    /// The client has stopped sending; its last bytes are still buffered.
    is_leaving: bool,
    dropped: u64,
    waiting: VecDeque<u8>,
    missed: u64,
    late: Lateness,
    waited: Duration,
    /// Maximum delay beyond that wait, since the last report.
    behind: Duration,
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
            clock: SessionClock::new(clock_hz, pace, settings.lag * 1_000_000),
            watch: StopWatch::start(),
            once: settings.once,
            input: Input::default(),
            is_leaving: false,
            dropped: 0,
            waiting: VecDeque::new(),
            missed: 0,
            late: Lateness::default(),
            waited: Duration::ZERO,
            behind: Duration::ZERO,
            times: SessionTimes::new(unix_ms(), name, settings.lag, settings.records),
            line: StatusLine::new(settings.progress),
        }
    }

    pub(super) fn run(&mut self) -> Result<(), Failure> {
        wake_on_time();
        let mut buffer = [0; 4096];
        let (mut polled, mut silent_since) = (Duration::ZERO, self.watch.elapsed());
        let (mut has_ended, mut was_recorded) = (false, true);
        while interrupt::count() == 0 && !(has_ended && self.is_over()) {
            let wait = self.round(silent_since);
            self.write_replies().map_err(lost)?;
            let room = self.room().min(buffer.len());
            let received = match buffer.get_mut(..room) {
                Some(free @ [_, ..]) => self.port.read(free, wait),
                _ => self.port.wait(wait),
            };
            match received.map_err(lost)? {
                Received::Bytes(count) => {
                    silent_since = self.watch.elapsed();
                    self.catch_up(silent_since)?;
                    self.take(buffer.get(..count).unwrap_or_default());
                }
                Received::Connected => {
                    has_ended |= self.once && self.is_leaving;
                    self.drop_input();
                }
                Received::Ended => self.is_leaving = true,
                Received::Gone => {
                    has_ended = self.once;
                    self.gone();
                }
                Received::Nothing => {}
            }
            if self.is_leaving && self.has_left() {
                has_ended = self.once;
                self.port.hang_up();
                self.gone();
            }
            if let Some(panel) = &mut self.panel {
                panel.execute(&mut self.session, &mut self.line);
            }
            if was_recorded && !self.session.records_all() {
                was_recorded = false;
                self.line
                    .note("the recording has reached its maximum size: the session continues unrecorded");
            }
            if self.watch.elapsed().saturating_sub(polled) > Duration::from_millis(20) {
                polled = self.watch.elapsed();
                if let Some(text) = self.port.poll_events() {
                    self.line.note(&text);
                }
            }
            let Self { line, session, clock, late, behind, port, .. } = self;
            line.update(|| {
                let text = status(session, (clock, std::mem::take(behind)), late);
                let errors = port.line_errors().filter(|errors| !errors.is_none());
                errors.map_or_else(|| text.clone(), |errors| format!("{text}  line errors: {errors}"))
            });
        }
        if interrupt::count() == 0 && self.session.jogs_without_end() {
            self.line.note(
                "a jog button is still pressed, so the session ends here; add `release` lines to end the jog",
            );
        }
        Ok(())
    }

    /// New bytes must not come before their time.
    fn catch_up(&mut self, silent_since: Duration) -> Result<(), Failure> {
        while matches!(self.pacing, Pacing::Real(_)) && self.round(silent_since).is_zero() {
            self.write_replies().map_err(lost)?;
        }
        Ok(())
    }

    fn take(&mut self, bytes: &[u8]) {
        self.times.chunk(self.watch.nanos(), self.session.now(), bytes.len());
        if let Some(panel) = &mut self.panel {
            panel.receive(bytes);
            return;
        }
        self.input.push(bytes);
    }

    fn room(&self) -> usize {
        self.panel.as_ref().map_or_else(|| self.input.room(), Panel::room)
    }

    fn gone(&mut self) {
        if let Some(panel) = &mut self.panel {
            return panel.end_line();
        }
        self.line.note("client disconnected");
        self.drop_input();
    }

    /// The next client must not get the rest of the last one's bytes.
    fn drop_input(&mut self) {
        let count = self.input.clear();
        if count > 0 {
            self.dropped += count as u64;
            self.line
                .note(&format!("dropped {count} bytes that the client sent faster than the line takes them"));
        }
        self.session.hang_up();
        self.waiting.clear();
        self.is_leaving = false;
    }

    /// Whether a client's bytes have been processed and answered, as far as it reads.
    fn has_left(&self) -> bool {
        let replies = self.port.is_connected() && !self.waiting.is_empty();
        self.input.is_empty() && !self.session.is_busy() && !replies
    }

    /// Whether the session has ended: for a panel, when all input is processed.
    fn is_over(&self) -> bool {
        let is_last = || self.session.is_idle() || self.session.jogs_without_end();
        self.panel.as_ref().is_none_or(|panel| panel.is_done() && is_last())
    }

    /// The next cycle with something to write or press; no round passes it.
    fn deadline(&self) -> Instant {
        let waits = self.panel.as_ref().and_then(|panel| panel.waits);
        // A process that waits for every byte is scheduled later on a busy system.
        let due = self.session.deadline_of_round(Cycles(self.round_cycles()));
        waits.map_or(due, |waits| waits.min(due))
    }

    fn round_cycles(&self) -> u64 {
        let clock_hz = u64::from(self.session.experiment().config().clock_hz());
        (clock_hz / 1000).clamp(1, MAX_ROUND)
    }

    /// Returns how long to wait for bytes.
    fn round(&mut self, silent_since: Duration) -> Duration {
        let now = self.session.now();
        let step = self.round_cycles();
        let (to, wait) = match self.pacing {
            Pacing::Real(_) => {
                let target = self.clock.target(self.watch.nanos(), now);
                let behind = self.clock.nanos(Cycles(target.0.saturating_sub(now.0)));
                self.behind = self.behind.max(Duration::from_nanos(behind).saturating_sub(self.waited));
                let waits = self.panel.as_ref().and_then(|panel| panel.waits).unwrap_or(Instant::NEVER);
                let to = target.min(Instant(now.0 + step)).min(waits);
                self.input.feed(&mut self.session, to + Cycles(ROUNDS_AHEAD * step));
                (to, if to < target { Duration::ZERO } else { IDLE_WAIT })
            }
            Pacing::Max if !self.input.is_empty() || self.deadline() != Instant::NEVER => {
                self.input.feed(&mut self.session, now + Cycles(MAX_ROUND));
                (self.deadline().min(Instant(now.0.saturating_add(MAX_ROUND))), Duration::ZERO)
            }
            Pacing::Max if self.watch.elapsed().saturating_sub(silent_since) < THINKING => (now, THINKING),
            Pacing::Max if !self.session.is_idle() => (Instant(now.0 + MAX_ROUND), Duration::ZERO),
            Pacing::Max => (now, IDLE_WAIT),
        };
        if to > now {
            self.session.advance::<Digest>(to, &mut []);
        }
        self.waited = match (self.pacing, self.deadline()) {
            (Pacing::Real(_), due) if due != Instant::NEVER && wait > Duration::ZERO => {
                let cycles = Cycles(due.0.saturating_sub(self.session.now().0));
                wait.min(Duration::from_nanos(self.clock.nanos(cycles).max(1)))
            }
            _ => wait,
        };
        self.waited
    }

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
                self.times.reply(&reply, now_ns, late);
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
        if self.late.count() > 0 {
            writeln!(out, "replies {} late{}", self.late.count(), self.late)?;
        }
        if let Some(errors) = self.port.line_errors() {
            writeln!(out, "line_errors {errors}")?;
        }
        let stretches = self.clock.setbacks();
        if stretches.count > 0 {
            writeln!(out, "stretches {} cycles {}", stretches.count, stretches.cycles.0)?;
        }
        if self.missed > 0 {
            writeln!(out, "reply_bytes_not_read {}", self.missed)?;
        }
        if self.dropped > 0 {
            writeln!(out, "bytes_dropped {}", self.dropped)?;
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
    text + &not_real_time(clock)
}

fn not_real_time(clock: &SessionClock) -> String {
    let stretches = clock.setbacks();
    if stretches.count == 0 {
        return String::new();
    }
    let ms = clock.nanos(stretches.cycles) / 1_000_000;
    format!("  NOT REAL TIME: set back {} times, {ms} ms", stretches.count)
}
