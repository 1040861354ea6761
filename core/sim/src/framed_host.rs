//! The host of a framed line (DESIGN A6, A9): one frame, its reply, the next.
//!
//! ```text
//! each controller   opening: STATUS ── filling: TICKS, TICKS, … ── confirming: STATUS ── done
//! each exchange     send ── reply ── ten bit times ── the next
//!                     └── no reply in time: the same frame again, after a delimiter
//! ```
//!
//! - Opening, the host asks for the expected sequence number and for how many ticks are done. So one
//!   that comes back after it crashed goes on where it was: it waits until the controller rests, and
//!   takes up the ticks that are not done.
//! - Filling, it sends as soon as a whole frame's ticks find a place. Places are counted from the
//!   last reply on, one a tick. Of several controllers the one whose queue runs dry first comes first.
//! - A frame is repeated with the sequence number that it had, so it never runs twice. A repetition
//!   begins with a delimiter: what was left of a broken frame cannot join it.
//! - The last tick of a job has no steps, so that its end is no underrun.
//! - Confirming, it sees that every tick was done. It gives up on a controller that does not answer
//!   `attempts` times, that is stopped, or that refuses a frame for good; and on one that answers but
//!   makes no progress (a host that crashes again and again), after `attempts` frames for each place of its
//!   queue.
//!
//! ```
//! use stepscope_peripheral::signal::Record;
//! use stepscope_sim::{Experiment, framed_host::Progress};
//!
//! // The default motion over the framed protocol: opened, filled, confirmed.
//! let framed = r#"{ "line": { "protocol": "framed" } }"#;
//! let run = Experiment::from_json(framed).expect("no problems").run(&mut Vec::<Record>::new());
//! let host = run.host().expect("a framed line has one");
//! assert!(host.progress().all(|progress| progress == Progress::Done));
//! ```

mod peer;
#[cfg(test)]
mod tests;

pub use peer::{GivenUp, Job, Progress};

use crate::noise::Noise;
use alloc::vec::Vec;
use peer::Peer;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::schedule::line_time;
use stepscope_peripheral::wire::{
    Line,
    frame::{self, Deframed, Deframer, Kind, NAK_LEN, Reply, Ticks},
    uart::{Receiver, RxEvent},
};
use stepscope_scenario::{END_OF_TIME, Host as Settings};

/// Bit times from the end of a reply, or of the time for it, to the next frame: DE has fallen by then,
/// whatever the controller's clock.
const PAUSE_BITS: u64 = 10;
/// Bit times from the end of a frame in which its reply has to come, if the scenario does not say: the
/// longest one to STATUS and TICKS, which are all that it sends, takes 191.
const TIMEOUT_BITS: u64 = 256;
// The first start bit comes 11 bit times after the frame, and each byte has ten.
const _: () = assert!(TIMEOUT_BITS > 11 + 10 * NAK_LEN as u64);

/// What the host counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames sent, repetitions among them.
    pub frames: u64,
    /// Frames sent again.
    pub repeated: u64,
    /// Replies taken.
    pub replies: u64,
    /// What was heard and was no reply to the frame that waits for one.
    pub rejected: u64,
    /// Replies that refused a frame.
    pub refused: u64,
    /// How often the host crashed.
    pub crashes: u64,
}

/// No exchange begins after this cycle, so that the longest wait still ends before [`END_OF_TIME`].
const LAST_BEGIN: u64 = END_OF_TIME - (1 << 46);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing under way before `until`.
    Pausing { until: Instant },
    /// Bytes are being sent up to `end`.
    Sending { peer: usize, kind: Kind, ticks: u32, end: Instant, crashes: bool },
    /// A reply is due.
    Waiting { peer: usize, kind: Kind, ticks: u32, until: Instant },
    /// Every controller is done or given up.
    Over,
}

/// The host.
#[derive(Clone, Debug)]
pub struct FramedHost {
    clock_hz: u32,
    baud: u32,
    bit: Cycles,
    timeout: Cycles,
    attempts: u8,
    peers: Vec<Peer>,
    phase: Phase,
    receiver: Receiver,
    deframer: Deframer,
    heard: bool,
    noise: Option<Noise>,
    counts: Counts,
    last: Instant,
}

impl FramedHost {
    /// A host that begins in cycle `start`. `bit` is the bit time of its receiver.
    #[must_use]
    pub fn new(
        jobs: Vec<Job>,
        settings: &Settings,
        (clock_hz, baud, bit): (u32, u32, Cycles),
        start: Instant,
        noise: Option<Noise>,
    ) -> Self {
        let timeout = settings.reply_timeout_cycles.map_or(TIMEOUT_BITS * bit.0, u64::from);
        let peers = jobs.into_iter().map(|job| Peer::new(job, settings, start)).collect();
        Self {
            clock_hz,
            baud,
            bit,
            timeout: Cycles(timeout),
            attempts: settings.attempts,
            peers,
            phase: Phase::Pausing { until: start },
            receiver: Receiver::new(bit),
            deframer: Deframer::default(),
            heard: true,
            noise,
            counts: Counts::default(),
            last: Instant::RESET,
        }
    }

    /// How far it has come with each controller.
    pub fn progress(&self) -> impl Iterator<Item = Progress> {
        self.peers.iter().map(|peer| peer.progress)
    }

    /// Ticks that each controller has acknowledged.
    pub fn acknowledged(&self) -> impl Iterator<Item = u32> {
        self.peers.iter().map(|peer| peer.acknowledged)
    }

    /// What it has counted.
    #[must_use]
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Whether it has nothing more to do.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.phase == Phase::Over
    }

    /// The last cycle in which it did something.
    #[must_use]
    pub const fn last_active(&self) -> Instant {
        self.last
    }

    /// Whether it is sending in cycle `now`: then it hears nothing.
    #[must_use]
    pub fn is_sending(&self, now: Instant) -> bool {
        matches!(self.phase, Phase::Sending { end, .. } if now < end)
    }

    /// Next cycle after `now`, the last one that it was clocked in, in which it does something while
    /// it hears the same level; [`Instant::NEVER`] when it is over.
    #[must_use]
    pub fn deadline(&self, now: Instant) -> Instant {
        match self.phase {
            Phase::Pausing { until } => until,
            Phase::Sending { end, .. } => end,
            Phase::Waiting { until, .. } => until.min(self.receiver.deadline(now, self.heard)),
            Phase::Over => Instant::NEVER,
        }
    }

    /// Cycle `now`, in which it hears `level`.
    pub fn clock(&mut self, now: Instant, level: bool, line: &mut Line) {
        let before = core::mem::replace(&mut self.heard, level);
        if let Phase::Waiting { peer, kind, ticks, .. } = self.phase
            && let Some(RxEvent::Byte(byte)) = self.receiver.clock(now, before, level)
        {
            self.last = now;
            self.hear(byte, now, (peer, kind, ticks));
        }
        let due = match self.phase {
            Phase::Pausing { until } | Phase::Waiting { until, .. } => until <= now,
            Phase::Sending { end, .. } => end <= now,
            Phase::Over => false,
        };
        if !due {
            return;
        }
        self.last = now;
        match self.phase {
            Phase::Pausing { .. } => self.next_exchange(now, line),
            Phase::Sending { crashes: true, .. } => self.restart(now),
            Phase::Sending { peer, kind, ticks, .. } => {
                self.receiver = Receiver::new(self.bit);
                self.deframer = Deframer::default();
                self.phase = Phase::Waiting { peer, kind, ticks, until: now + self.timeout };
            }
            Phase::Waiting { peer, .. } => {
                if let Some(peer) = self.peers.get_mut(peer) {
                    peer.flush = true;
                }
                self.pause(now, peer, Cycles(0));
            }
            Phase::Over => {}
        }
    }

    /// Nothing more before `span` and the pause after a reply have passed.
    fn pause(&mut self, now: Instant, peer: usize, span: Cycles) {
        let until = now + Cycles(PAUSE_BITS * self.bit.0);
        if let Some(peer) = self.peers.get_mut(peer) {
            peer.ready_at = until.max(now + span);
        }
        self.phase = Phase::Pausing { until };
    }

    /// A host that crashed knows nothing but its ticks and where it began.
    fn restart(&mut self, now: Instant) {
        self.counts.crashes += 1;
        for peer in &mut self.peers {
            if peer.is_open() {
                peer.progress = Progress::Opening;
                peer.ready_at = now + self.timeout;
                peer.dry_at = now;
                peer.flush = true;
            }
        }
        self.phase = Phase::Pausing { until: now + self.timeout };
    }

    /// Begins what is most urgent, or waits for it.
    fn next_exchange(&mut self, now: Instant, line: &mut Line) {
        for peer in self.peers.iter_mut().filter(|peer| peer.is_open()) {
            let tired = peer.attempts >= self.attempts || peer.stalls(self.attempts);
            if now.0 >= LAST_BEGIN {
                peer.progress = Progress::GivenUp(GivenUp::OutOfTime);
            } else if tired && peer.ready_at <= now {
                peer.progress = Progress::GivenUp(GivenUp::NoReply);
            }
        }
        let waiting = || self.peers.iter().enumerate().filter(|(_, peer)| peer.is_open());
        let urgent = waiting()
            .filter(|(_, peer)| peer.ready_at <= now)
            .min_by_key(|(index, peer)| (peer.dry_at, *index))
            .map(|(index, _)| index);
        match urgent {
            Some(index) => self.begin(index, now, line),
            None => {
                self.phase = match waiting().map(|(_, peer)| peer.ready_at).min() {
                    Some(until) => Phase::Pausing { until },
                    None => Phase::Over,
                };
            }
        }
    }

    /// Sends the frame that controller `index` is due from the next cycle on.
    fn begin(&mut self, index: usize, now: Instant, line: &mut Line) {
        let Some(peer) = self.peers.get_mut(index) else { return };
        let (kind, ticks) = match peer.progress {
            Progress::Filling => (Kind::Ticks, peer.most.min(peer.free).min(peer.left()).max(1)),
            _ => (Kind::Status, 0),
        };
        let body = match kind {
            Kind::Ticks => Ticks::emit(peer.seq, peer.job.channels, peer.commands(ticks)),
            _ => Vec::new(),
        };
        let mut bytes = frame::emit(peer.job.address, kind as u8, &body);
        if peer.flush {
            bytes.insert(0, frame::DELIMITER);
        }
        self.counts.repeated += u64::from(peer.attempts > 0);
        peer.attempts = peer.attempts.saturating_add(1);
        peer.since_progress = peer.since_progress.saturating_add(1);
        self.counts.frames += 1;
        let start = now.next();
        let mut crashes = false;
        if let Some(noise) = &mut self.noise {
            let spoiled = noise.send(start, &bytes);
            (bytes, crashes) = (spoiled.bytes, spoiled.crashes);
            if let Some(forced) = spoiled.forced {
                line.force(forced);
            }
        }
        let end = start + Cycles(line_time(bytes.len() as u64, self.clock_hz, self.baud));
        line.send(start, &bytes);
        self.phase = Phase::Sending { peer: index, kind, ticks, end, crashes };
    }

    /// A byte of a reply.
    fn hear(&mut self, byte: u8, now: Instant, (index, kind, ticks): (usize, Kind, u32)) {
        let heard = match &mut self.noise {
            Some(noise) => noise.hear(byte),
            None => alloc::vec![byte],
        };
        for byte in heard {
            let reply = match self.deframer.byte(byte) {
                None => continue,
                Some(Deframed::Frame(frame)) => Reply::parse(frame),
                Some(_) => None,
            };
            let missed = self.noise.as_mut().is_some_and(Noise::misses);
            let Some(peer) = self.peers.get_mut(index) else { return };
            let reply = reply.filter(|reply| reply.address == peer.job.address && !missed);
            match reply.map(|reply| (reply.answer, reply.status)) {
                Some((Ok(taken), status)) if taken == kind && peer.fits(kind, status) => {
                    self.counts.replies += 1;
                    (peer.attempts, peer.flush) = (0, false);
                    let wait = peer.acknowledge(kind, ticks, status, now);
                    self.pause(now, index, wait);
                }
                Some((Err(reason), _)) => {
                    self.counts.refused += 1;
                    peer.attempts = 0;
                    let wait = peer.refused(reason);
                    self.pause(now, index, wait);
                }
                _ => self.counts.rejected += 1,
            }
        }
    }
}
