//! A session: a scenario's controllers on a line that an external host drives (LIVE H1, H5).
//!
//! ```text
//! bytes read from a port  ── receive ──┐
//! the clock's cycle       ── advance ──┼── the model ── take_replies: bytes, each with the cycle in which it has left
//!                                      └── recording: a scenario that replays the session
//! ```
//!
//! Time is given in cycles, so the same bytes in the same cycles are the same session. A byte read at cycle N joins the last
//! send if its position there is after N; otherwise it begins a send at N + 1. Stand-alone controllers have buttons instead of
//! a line ([`Session::enter`]).

mod clock;
mod input;
mod panel;
#[cfg(test)]
mod tests;

pub use clock::{Pace, SessionClock, Setbacks};
pub use input::Input;
pub use panel::MAX_RECORDED_INPUTS;

use crate::{Experiment, Run, replayed};
use alloc::{collections::VecDeque, sync::Arc, vec, vec::Vec};
use core::fmt;
use stepscope_controller::input::{Change, Signal};
use stepscope_controller::{NotEntered, StandAlone};
use stepscope_peripheral::signal::{Event, Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::{BitTimes, bit_times::BYTE_BITS};
use stepscope_peripheral::{config::Protocol, trace::Digest};
use stepscope_scenario::{
    END_OF_TIME, Hex, Host, LineScript, Noise, Problem, Problems, Scenario, ScriptedSend, Source, ValueError,
};

/// Maximum recorded bytes, as in a line script.
pub const MAX_RECORDED_BYTES: u64 = 4 << 20;
/// Maximum recorded sends, so that the scenario can be read again (64 MiB of text).
pub const MAX_RECORDED_SENDS: u64 = 400_000;

/// Bit times after a frame in which its reply has begun: 11, and a margin for other clocks.
const REPLY_BEGINS_BITS: u64 = 30;

/// Ends an incomplete frame as invalid: a byte that makes its CRC fail, and the delimiter.
const INVALID_END: [u8; 2] = [0xff, 0];

/// A byte of a controller's reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplyByte {
    pub controller: usize,
    /// First cycle after its stop bit.
    pub end: Instant,
    pub byte: u8,
}

/// Simulated controllers that an external host drives.
///
/// ```
/// use stepscope_peripheral::{signal::Record, units::Instant, wire::frame};
/// use stepscope_scenario::Scenario;
/// use stepscope_sim::session::Session;
///
/// let scenario = Scenario::from_json(r#"{ "line": { "protocol": "framed" } }"#).expect("valid JSON");
/// let mut session = Session::new(&scenario).expect("no problems");
/// let mut traces = [Vec::<Record>::new()];
/// session.receive(&frame::emit(0, 4, &[])); // the bytes of your host: STATUS
/// session.advance(Instant(50_000), &mut traces);
/// assert_eq!(session.take_replies().count(), 17); // the bytes for your host
/// session.recording().verify().expect("a replay has the same trace");
/// ```
#[derive(Clone)]
pub struct Session {
    /// The recording without its sends and its length.
    blank: Scenario,
    experiment: Arc<Experiment>,
    run: Run,
    times: BitTimes,
    /// Replies use the controllers' own rates.
    reply_times: Vec<BitTimes>,
    /// Start of the last send, and its bytes.
    last_send: Option<(Instant, u64)>,
    received: u64,
    /// Whether the last received byte is within a frame.
    in_frame: bool,
    replies: VecDeque<ReplyByte>,
    /// Replies that begin earlier are for a host that has disconnected.
    replies_from: Instant,
    digests: Vec<Digest>,
    /// The recording, once it has reached its limit.
    full_recording: Option<Arc<Recording>>,
    presses: panel::Presses,
}

fn blank(scenario: &Scenario) -> Scenario {
    let mut blank = match &scenario.source {
        Source::StandAlone(_) => scenario.clone(),
        _ => replayed(scenario.clone(), LineScript::default()),
    };
    if let Source::StandAlone(controllers) = &mut blank.source {
        controllers.iter_mut().for_each(|controller| controller.inputs = Vec::new());
    }
    blank.line.host = Host::default();
    blank.line.noise = Noise::default();
    blank.run_cycles = Some(1);
    blank
}

impl Session {
    /// Ignores sends, presses, length, host and noise. Errors: every problem, and segments, which have no line.
    pub fn new(scenario: &Scenario) -> Result<Self, Problems> {
        if scenario.source.uses_segments() {
            let detail = "segments run without a serial line; use ticks, packets or a line script";
            return Err(Problem::new("source", ValueError::Conflict { detail }).into());
        }
        let blank = blank(scenario);
        let experiment = Experiment::new(&blank)?;
        let clock_hz = experiment.config().clock_hz();
        let mut run = experiment.start();
        run.extend_to_end_of_time();
        let mut session = Self {
            blank,
            run,
            times: BitTimes::new(clock_hz, experiment.baud()),
            reply_times: experiment
                .configs()
                .map(|config| BitTimes::new(clock_hz, config.reply_baud()))
                .collect(),
            last_send: None,
            received: 0,
            in_frame: false,
            replies: VecDeque::new(),
            replies_from: Instant::RESET,
            digests: vec![Digest::default(); experiment.controllers()],
            experiment: Arc::new(experiment),
            full_recording: None,
            presses: panel::Presses::default(),
        };
        session.advance::<Digest>(Instant::RESET, &mut []);
        Ok(session)
    }

    /// Controllers and line, without sends.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    pub const fn run(&self) -> &Run {
        &self.run
    }

    /// The last cycle that was run.
    pub fn now(&self) -> Instant {
        Instant(self.run.cycles().0.saturating_sub(1))
    }

    pub const fn received(&self) -> u64 {
        self.received
    }

    /// Digest of the trace of each controller.
    pub fn digests(&self) -> &[Digest] {
        &self.digests
    }

    /// Whether no event follows without input, and no reply is left.
    pub fn is_idle(&self) -> bool {
        self.presses.are_done() && self.run.is_idle() && self.replies.is_empty()
    }

    /// Whether a stand-alone controller jogs without end.
    pub fn jogs_without_end(&self) -> bool {
        self.presses.are_done() && self.run.stand_alone().is_some_and(StandAlone::jogs_without_end)
    }

    /// Whether [`Self::deadline`] is a cycle.
    pub fn is_busy(&self) -> bool {
        self.deadline() != Instant::NEVER
    }

    /// The next cycle to run to, when a byte of a reply has been sent or all received bytes are on the line;
    /// [`Instant::NEVER`] if the line is idle.
    pub fn deadline(&self) -> Instant {
        self.deadline_of_round(Cycles(0))
    }

    /// As [`Self::deadline`], but for all bytes of replies that end within `round` after the first one.
    pub fn deadline_of_round(&self, round: Cycles) -> Instant {
        let now = self.now();
        let ends = || self.replies.iter().map(|reply| reply.end);
        let together = |first: Instant| ends().take_while(|&end| end <= first + round).last();
        let reply = ends().next().and_then(together).map_or(Instant::NEVER, |end| end.max(now.next()));
        let received =
            self.last_send.map(|(start, bytes)| start + self.times.byte(bytes) + self.times.bit(1));
        received.filter(|&received| received > now).map_or(reply, |received| received.min(reply))
    }

    /// How many of `max` bytes begin on the line by cycle `until` if they are received now.
    pub fn fits_until(&self, until: Instant, max: usize) -> usize {
        let (start, sent) = self.joined_send().unwrap_or((self.now().next(), 0));
        (0..max).take_while(|&byte| start + self.times.byte(sent + byte as u64) <= until).count()
    }

    /// The last send, if a byte that is received now joins it.
    fn joined_send(&self) -> Option<(Instant, u64)> {
        let next = self.now().next();
        self.last_send.filter(|&(start, sent)| start + self.times.byte(sent) >= next)
    }

    /// Disconnects the host. Replies to it are dropped, so that the next host does not get them. An incomplete frame is ended as
    /// invalid, so that it neither runs nor includes the first frame of the next host.
    pub fn hang_up(&mut self) {
        if self.in_frame {
            self.receive(&INVALID_END);
        }
        self.replies.clear();
        let end = self.last_send.map_or(self.now(), |(start, sent)| start + self.times.byte(sent));
        self.replies_from = end.max(self.now()) + self.times.bit(REPLY_BEGINS_BITS);
    }

    /// Puts bytes on the line from the next cycle on; ignores them without a line. [`Input`] buffers the bytes of a host that
    /// sends faster than the line.
    pub fn receive(&mut self, bytes: &[u8]) {
        let count = bytes.len() as u64;
        if count == 0 || !matches!(self.blank.source, Source::Line(_)) {
            return;
        }
        let next = self.now().next();
        let joins = self.joined_send();
        if self.full_recording.is_none() {
            let sends = self.run.schedule().len() as u64 + u64::from(joins.is_none());
            if self.received + count > MAX_RECORDED_BYTES || sends > MAX_RECORDED_SENDS {
                self.end_recording();
            }
        }
        self.received += count;
        self.in_frame =
            self.blank.line.protocol == Protocol::Framed && bytes.last().is_some_and(|byte| *byte != 0);
        let line = self.run.line_mut();
        if self.full_recording.is_some() {
            line.forget_sent();
        }
        if let Some((start, sent)) = joins {
            line.extend(bytes);
            self.last_send = Some((start, sent + count));
        } else {
            line.send(next, bytes);
            self.last_send = Some((next, count));
        }
    }

    /// Enters a change at the panel of a stand-alone controller after [`Self::now`] and returns its cycle: the next one in which
    /// that input has no change yet. It cancels a later level of that input. Errors: a change that a script may not have, or a
    /// session with a line.
    pub fn enter(&mut self, controller: usize, change: Change) -> Result<Instant, NotEntered> {
        if self.full_recording.is_none() && !self.presses.has_room() {
            self.end_recording();
        }
        if self.full_recording.is_some() {
            self.presses.forget();
        }
        let machine = self.run.stand_alone_mut().ok_or(NotEntered::NoController)?;
        self.presses.enter(machine, controller, change)
    }

    /// As [`Self::enter`], for a level that lasts `held`, unless the input changes before.
    pub fn enter_for(
        &mut self,
        controller: usize,
        (signal, level): (Signal, bool),
        held: Cycles,
    ) -> Result<Instant, NotEntered> {
        let at = self.enter(controller, Change::Level(signal, level))?;
        let back = Instant(at.0.saturating_add(held.0.max(1)));
        self.presses.later(controller, back, (signal, !level));
        Ok(at)
    }

    fn end_recording(&mut self) {
        self.full_recording = Some(Arc::new(self.recording_to_now()));
    }

    /// Runs up to and including cycle `to`, with a sink per controller.
    pub fn advance<S: Sink>(&mut self, to: Instant, sinks: &mut [S]) {
        while let Some(due) = self.presses.due(to) {
            self.run_to(Instant(due.0.saturating_sub(1)), sinks);
            while let Some((controller, change)) = self.presses.take(due) {
                // The previous level was allowed, so this one is, too.
                let _ = self.enter(controller, change);
            }
        }
        self.run_to(to, sinks);
        if self.full_recording.is_none() && self.run.stand_alone().is_some_and(panel::begins_many) {
            self.end_recording();
        }
    }

    fn run_to<S: Sink>(&mut self, to: Instant, sinks: &mut [S]) {
        let Self { run, digests, replies, reply_times, replies_from, .. } = self;
        let mut sinks = sinks.iter_mut();
        let mut new_replies: Vec<Vec<ReplyByte>> = vec![Vec::new(); digests.len()];
        let parts = digests.iter_mut().zip(reply_times.iter()).zip(&mut new_replies).enumerate();
        let mut session_sinks: Vec<SessionSink<'_, S>> = parts
            .map(|(controller, ((digest, times), replies))| SessionSink {
                controller,
                digest,
                times: *times,
                replies_from: *replies_from,
                replies,
                sink: sinks.next(),
            })
            .collect();
        run.run_to(to.min(Instant(END_OF_TIME - 1)).next(), &mut session_sinks);
        new_replies.sort_by_key(|replies| replies.first().map(|reply| reply.end));
        replies.extend(new_replies.into_iter().flatten());
    }

    /// Removes and returns the bytes of replies that have been sent, in order.
    pub fn take_replies(&mut self) -> impl Iterator<Item = ReplyByte> {
        let now = self.now();
        let sent = self.replies.iter().take_while(|reply| reply.end <= now).count();
        self.replies.drain(..sent)
    }

    /// Whether the recording has the whole session.
    pub const fn records_all(&self) -> bool {
        self.full_recording.is_none()
    }

    /// The recorded session so far, as a scenario.
    pub fn recording(&self) -> Recording {
        self.full_recording.as_ref().map_or_else(|| self.recording_to_now(), |full| Recording::clone(full))
    }

    fn recording_to_now(&self) -> Recording {
        let mut scenario = self.blank.clone();
        scenario.source = self.source_to_now();
        scenario.run_cycles = Some(self.run.cycles().0);
        let digests = self.digests.iter().map(Digest::value).collect();
        Recording { scenario, digests, panel_digest: panel_digest(&self.run) }
    }

    fn source_to_now(&self) -> Source {
        if let Source::StandAlone(controllers) = &self.blank.source {
            let mut controllers = controllers.clone();
            for (index, controller) in controllers.iter_mut().enumerate() {
                controller.inputs = self.presses.script(index, self.now());
            }
            return Source::StandAlone(controllers);
        }
        let sends = self.run.schedule().iter().map(|send| ScriptedSend {
            start_cycle: send.start.0,
            bytes: Hex(send.bytes.to_vec()),
            frame: None,
        });
        Source::Line(LineScript { sends: sends.collect() })
    }
}

/// Collects the digest and the replies of a controller, and passes its records on.
struct SessionSink<'a, S> {
    controller: usize,
    digest: &'a mut Digest,
    times: BitTimes,
    replies_from: Instant,
    replies: &'a mut Vec<ReplyByte>,
    sink: Option<&'a mut S>,
}

impl<S: Sink> Sink for SessionSink<'_, S> {
    fn record(&mut self, record: Record) {
        self.digest.record(record);
        self.sink.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        if let Event::Reply { start, reply, positions, .. } = &event
            && *start >= self.replies_from
        {
            let bytes = (0..).zip(reply.emit(positions.as_ref()));
            let (controller, times) = (self.controller, self.times);
            self.replies.extend(bytes.map(|(index, byte)| ReplyByte {
                controller,
                end: *start + times.byte(index) + times.bit(BYTE_BITS),
                byte,
            }));
        }
        self.sink.event(at, event);
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The same controllers and line, with the received bytes as the source.
    pub scenario: Scenario,
    /// Digest of the trace of each controller.
    pub digests: Vec<u64>,
    /// Digest of the panels of stand-alone controllers.
    pub panel_digest: Option<u64>,
}

fn panel_digest(run: &Run) -> Option<u64> {
    run.stand_alone().map(stepscope_controller::StandAlone::panel_digest)
}

/// Why a recording does not replay the session.
#[derive(Clone, Debug, PartialEq)]
pub enum NotTheSession {
    /// The scenario of the recording has problems.
    Refused(Problems),
    /// The trace of a controller has another digest.
    Differs { controller: usize, session: u64, replay: u64 },
    /// The panels have another digest.
    PanelsDiffer,
}

impl fmt::Display for NotTheSession {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(problems) => {
                f.write_str("the recording cannot be run")?;
                problems.iter().try_for_each(|problem| write!(f, "; {problem}"))
            }
            Self::Differs { controller, session, replay } => write!(
                f,
                "controller {controller}: the digest is {session:016x} in the session, but {replay:016x} in the replay"
            ),
            Self::PanelsDiffer => f.write_str("the panels in the replay differ from those in the session"),
        }
    }
}

impl Recording {
    /// Replays the session and compares the digests. Errors: the first difference.
    pub fn verify(&self) -> Result<(), NotTheSession> {
        let experiment = Experiment::new(&self.scenario).map_err(NotTheSession::Refused)?;
        let mut replay = vec![Digest::default(); experiment.controllers()];
        let run = experiment.run_each(&mut replay);
        let pairs = self.digests.iter().zip(replay.iter().map(Digest::value)).enumerate();
        for (controller, (&session, replay)) in pairs {
            if session != replay {
                return Err(NotTheSession::Differs { controller, session, replay });
            }
        }
        if panel_digest(&run) != self.panel_digest {
            return Err(NotTheSession::PanelsDiffer);
        }
        Ok(())
    }
}
