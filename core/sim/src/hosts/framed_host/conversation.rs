//! The host's protocol on a framed line, in bytes and cycles (DESIGN A6, A9).
//!
//! ```text
//! poll ── a frame ── sent ── receive, byte by byte ── a reply ── ten bit times ── poll
//!                      └── time-out ── ten bit times ── poll: the same frame, after a delimiter
//! ```
//!
//! It has no line, port or clock. The caller polls at the [`deadline`](Conversation::deadline), sends the frame, and reports
//! the end of its last stop bit and the received bytes.

use super::peer::{GivenUp, Job, Known, Peer, Progress};
use alloc::vec::Vec;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::bit_times::BYTE_BITS;
use stepscope_peripheral::wire::frame::{self, Deframed, Deframer, Kind, NAK_LEN, Reply, Ticks, reply_len};
use stepscope_scenario::{END_OF_TIME, Host as Settings};

/// Bit times from the end of an exchange to the next frame: DE has fallen by then, whatever the controller's clock.
const PAUSE_BITS: u64 = 10;
/// Default time-out for a reply of [`NAK_LEN`] bytes, which takes 191 bit times; each additional byte adds ten.
const TIMEOUT_BITS: u64 = 256;
// The first start bit comes 11 bit times after the frame, and each byte has ten.
const _: () = assert!(TIMEOUT_BITS > 11 + BYTE_BITS * NAK_LEN as u64);

/// No exchange begins later, so that the longest wait ends before [`END_OF_TIME`].
const LAST_BEGIN: u64 = END_OF_TIME - (1 << 46);

/// The host's counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    pub frames: u64,
    pub repeated: u64,
    pub replies: u64,
    /// Received frames that were no reply to the pending frame.
    pub rejected: u64,
    pub refused: u64,
    pub crashes: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Exchange {
    peer: usize,
    kind: Kind,
    ticks: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Pausing { until: Instant },
    Sending(Exchange),
    Waiting { exchange: Exchange, until: Instant },
    Over,
}

/// The host's side of the protocol with all controllers of a line.
///
/// ```
/// use stepscope_peripheral::units::{Cycles, Instant};
/// use stepscope_sim::Experiment;
///
/// let experiment = Experiment::from_json(r#"{ "line": { "protocol": "framed" } }"#).expect("no problems");
/// let mut host = experiment.conversation(Instant(1)).expect("a framed host");
/// while !host.is_over() {
///     let now = host.deadline(); // wait until then, or for a byte
///     let Some(frame) = host.poll(now) else { continue };
///     // Write `frame` to your port. A byte takes 1389 cycles here.
///     host.sent(now + Cycles(1389 * frame.len() as u64));
///     // Pass each byte that you read: host.receive(byte, now).
/// }
/// assert_eq!(host.progress().next().expect("one job").to_string(), "given up: no reply");
/// ```
#[derive(Clone, Debug)]
pub struct Conversation {
    bit: Cycles,
    timeout: Cycles,
    attempts: u8,
    pub(super) peers: Vec<Peer>,
    phase: Phase,
    /// When the line is idle: ten bit times after the last exchange.
    idle_from: Instant,
    deframer: Deframer,
    counts: Counts,
}

impl Conversation {
    /// A conversation that begins in cycle `start`. `bit` is the bit time of the line.
    pub fn new(jobs: Vec<Job>, settings: &Settings, bit: Cycles, start: Instant) -> Self {
        let timeout = settings.reply_timeout_cycles.map_or(TIMEOUT_BITS * bit.0, u64::from);
        Self {
            bit,
            timeout: Cycles(timeout),
            attempts: settings.max_attempts,
            peers: jobs.into_iter().map(|job| Peer::new(job, settings, start)).collect(),
            phase: Phase::Pausing { until: start },
            idle_from: start,
            deframer: Deframer::default(),
            counts: Counts::default(),
        }
    }

    /// Adds a delay of the operating system to the time-out.
    pub fn with_slack(mut self, slack: Cycles) -> Self {
        self.timeout = Cycles(self.timeout.0 + slack.0);
        self
    }

    /// Begins each job with a tick without steps: after it, a reset of a real controller shows in its counts.
    pub fn with_opening_tick(mut self) -> Self {
        self.peers.iter_mut().for_each(|peer| peer.opening_tick = true);
        self
    }

    pub fn progress(&self) -> impl Iterator<Item = Progress> {
        self.peers.iter().map(|peer| peer.progress)
    }

    pub fn acknowledged(&self) -> impl Iterator<Item = u32> {
        self.peers.iter().map(|peer| peer.acknowledged)
    }

    /// Each job with the reports of its controller.
    pub fn known(&self) -> impl Iterator<Item = (&Job, &Known)> {
        self.peers.iter().map(|peer| (&peer.job, &peer.known))
    }

    /// Expected positions after the first `ticks` ticks of a job; `None` before the controller has reported its positions.
    pub fn expected(&mut self, job: usize, ticks: u32) -> Option<Vec<i32>> {
        self.peers.get_mut(job)?.expected(ticks)
    }

    /// Steps per channel of the first `ticks` ticks of a job, right positive.
    pub fn sums(&mut self, job: usize, ticks: u32) -> Vec<i32> {
        self.peers.get_mut(job).map_or_else(Vec::new, |peer| peer.sums(ticks))
    }

    pub const fn counts(&self) -> Counts {
        self.counts
    }

    pub fn is_over(&self) -> bool {
        self.phase == Phase::Over
    }

    /// Whether a reply is pending.
    pub const fn is_waiting(&self) -> bool {
        matches!(self.phase, Phase::Waiting { .. })
    }

    /// The job whose frame is being sent or waits for its reply, and the frame's kind.
    pub const fn pending_frame(&self) -> Option<(usize, Kind)> {
        match self.phase {
            Phase::Sending(exchange) | Phase::Waiting { exchange, .. } => {
                Some((exchange.peer, exchange.kind))
            }
            Phase::Pausing { .. } | Phase::Over => None,
        }
    }

    /// The cycle of the next [`Self::poll`] unless a byte comes; [`Instant::NEVER`] while a frame is sent and at the end.
    pub const fn deadline(&self) -> Instant {
        match self.phase {
            Phase::Pausing { until } | Phase::Waiting { until, .. } => until,
            Phase::Sending(_) | Phase::Over => Instant::NEVER,
        }
    }

    /// The frame to send from the next cycle on, if one is due in cycle `now`.
    pub fn poll(&mut self, now: Instant) -> Option<Vec<u8>> {
        match self.phase {
            Phase::Pausing { until } if until <= now => self.next_exchange(now),
            Phase::Waiting { exchange, until } if until <= now => {
                if let Some(peer) = self.peers.get_mut(exchange.peer) {
                    peer.needs_delimiter = true;
                }
                self.pause(now, exchange.peer, Cycles(0));
                None
            }
            _ => None,
        }
    }

    /// Reports that the frame was sent; `end` is the first cycle after its last stop bit.
    pub fn sent(&mut self, end: Instant) {
        let Phase::Sending(exchange) = self.phase else { return };
        self.deframer = Deframer::default();
        let channels = self.peers.get(exchange.peer).map_or(0, |peer| peer.job.channels);
        self.phase = Phase::Waiting { exchange, until: end + self.timeout_of(exchange.kind, channels) };
    }

    pub(super) fn timeout_of(&self, kind: Kind, channels: u8) -> Cycles {
        let additional = (reply_len(kind, channels) - NAK_LEN) as u64;
        Cycles(self.timeout.0 + BYTE_BITS * additional * self.bit.0)
    }

    /// Reports a byte that was received in cycle `now`.
    pub fn receive(&mut self, byte: u8, now: Instant) {
        self.receive_unless(byte, now, || false);
    }

    /// As [`Self::receive`]; drops a reply if `misses_reply` returns true.
    pub(super) fn receive_unless(&mut self, byte: u8, now: Instant, misses_reply: impl FnOnce() -> bool) {
        let Phase::Waiting { exchange: Exchange { peer: index, kind, ticks }, .. } = self.phase else {
            return;
        };
        let reply = match self.deframer.byte(byte) {
            None => return,
            Some(Deframed::Frame(frame)) => Reply::parse(frame).map(|reply| (reply, frame.positions())),
            Some(_) => None,
        };
        let missed = misses_reply();
        let Some(peer) = self.peers.get_mut(index) else { return };
        let reply = reply.filter(|(reply, _)| reply.address == peer.job.address && !missed);
        match reply.map(|(reply, positions)| (reply.result, reply.status, positions)) {
            Some((Ok(taken), status, positions)) if taken == kind && peer.is_current(kind, status) => {
                self.counts.replies += 1;
                (peer.attempts, peer.needs_delimiter) = (0, false);
                let wait = peer.acknowledge((kind, ticks), (status, positions), now);
                self.pause(now, index, wait);
            }
            Some((Err(reason), status, _)) => {
                self.counts.refused += 1;
                peer.attempts = 0;
                let wait = peer.refused(kind, reason, status);
                self.pause(now, index, wait);
            }
            _ => self.counts.rejected += 1,
        }
    }

    /// Stops all unfinished jobs: each controller gets STOP until it acknowledges, then STATUS and POSITIONS.
    pub fn stop(&mut self, now: Instant) {
        self.peers.iter_mut().filter(|peer| peer.is_open()).for_each(|peer| peer.stop(now));
        if let Phase::Pausing { .. } = self.phase {
            self.phase = Phase::Pausing { until: self.idle_from.max(now) };
        }
    }

    /// The host crashes and starts over; it still has its ticks and the first reports.
    pub(super) fn crash(&mut self, now: Instant) {
        self.counts.crashes += 1;
        // The longest reply may be on the line.
        let channels = self.peers.iter().map(|peer| peer.job.channels).max().unwrap_or(0);
        let until = now + self.timeout_of(Kind::Positions, channels);
        self.peers.iter_mut().filter(|peer| peer.is_open()).for_each(|peer| peer.restart(now, until));
        self.phase = Phase::Pausing { until };
    }

    fn pause(&mut self, now: Instant, peer: usize, span: Cycles) {
        let until = now + Cycles(PAUSE_BITS * self.bit.0);
        if let Some(peer) = self.peers.get_mut(peer) {
            peer.ready_at = until.max(now + span);
        }
        self.idle_from = until;
        self.phase = Phase::Pausing { until };
    }

    fn next_exchange(&mut self, now: Instant) -> Option<Vec<u8>> {
        for peer in self.peers.iter_mut().filter(|peer| peer.is_open()) {
            let has_no_attempt_left = peer.attempts >= self.attempts || peer.is_stalled(self.attempts);
            if now.0 >= LAST_BEGIN {
                peer.progress = Progress::GivenUp(GivenUp::OutOfTime);
            } else if has_no_attempt_left && peer.ready_at <= now {
                peer.progress = Progress::GivenUp(GivenUp::NoReply);
            }
        }
        let open = || self.peers.iter().enumerate().filter(|(_, peer)| peer.is_open());
        let urgent = open()
            .filter(|(_, peer)| peer.ready_at <= now)
            .min_by_key(|(index, peer)| (peer.queue_empty_at, *index))
            .map(|(index, _)| index);
        if let Some(index) = urgent {
            return self.begin(index);
        }
        self.phase = match open().map(|(_, peer)| peer.ready_at).min() {
            Some(until) => Phase::Pausing { until },
            None => Phase::Over,
        };
        None
    }

    fn begin(&mut self, index: usize) -> Option<Vec<u8>> {
        let peer = self.peers.get_mut(index)?;
        let (kind, ticks) = peer.due_frame();
        let body = match kind {
            Kind::Ticks => Ticks::emit(peer.seq, peer.job.channels, &peer.commands(ticks)),
            _ => Vec::new(),
        };
        let mut bytes = frame::emit(peer.job.address, kind as u8, &body);
        if peer.needs_delimiter {
            bytes.insert(0, frame::DELIMITER);
        }
        self.counts.repeated += u64::from(peer.attempts > 0);
        peer.attempts = peer.attempts.saturating_add(1);
        peer.frames_without_progress = peer.frames_without_progress.saturating_add(1);
        self.counts.frames += 1;
        self.phase = Phase::Sending(Exchange { peer: index, kind, ticks });
        Some(bytes)
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_job_of_one_tick_is_done() {
        use crate::framed_host::{Conversation, Job, Progress};
        use stepscope_peripheral::{
            protocol::{Kind, Reply, State, Status},
            signal::Positions,
            units::{Cycles, Instant},
        };
        use stepscope_scenario::Host;

        // One tick without steps, for a controller that replies immediately.
        let job =
            Job { address: 0, channels: 1, tick: Cycles(100), queue_depth: 16, commands: [0x80].into() };
        let mut host = Conversation::new(vec![job], &Host::default(), Cycles(16), Instant(1));
        let (mut seq, mut asked) = (0, Vec::new());
        while !host.is_over() {
            let now = host.deadline();
            let Some(frame) = host.poll(now) else { continue };
            host.sent(now + Cycles(160 * frame.len() as u64));
            let kind =
                [Kind::Status, Kind::Positions, Kind::Ticks, Kind::Status, Kind::Positions][asked.len()];
            seq += u8::from(kind == Kind::Ticks);
            let status = Status {
                state: State::Ready,
                free: 16,
                expected_seq: seq,
                faults: 0,
                ticks_done: seq.into(),
            };
            let positions = (kind == Kind::Positions).then(|| Positions::new(&[7]).expect("one channel"));
            for byte in (Reply { address: 0, result: Ok(kind), status }).emit(positions.as_ref()) {
                host.receive(byte, now + Cycles(9000));
            }
            asked.push(kind);
        }
        assert_eq!(host.progress().next(), Some(Progress::Done));
    }
}
