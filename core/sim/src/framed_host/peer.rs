//! A controller as the host of a framed line knows it: its job, how far it is, and what follows from
//! its replies.

use alloc::rc::Rc;
use core::fmt;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::frame::{self, Kind, Reason, State, Status};
use stepscope_scenario::Host as Settings;

/// What one controller is to do.
#[derive(Clone, Debug)]
pub struct Job {
    /// Its address.
    pub address: u8,
    /// Its channels: the bytes of a tick.
    pub channels: u8,
    /// Length of a tick.
    pub tick: Cycles,
    /// Ticks that its queue holds.
    pub queue_depth: u8,
    /// The commands, a byte a channel, tick after tick.
    pub commands: Rc<[u8]>,
}

impl Job {
    /// How many ticks.
    #[must_use]
    pub fn ticks(&self) -> u32 {
        (self.commands.len() / usize::from(self.channels.max(1))) as u32
    }

    /// Most ticks that go into one frame: half of the queue, so that the other half runs meanwhile.
    #[must_use]
    pub fn ticks_per_frame(&self, settings: &Settings) -> u8 {
        settings.ticks_per_frame.min(frame::MAX_TICKS).min(self.queue_depth / 2).max(1)
    }
}

/// How far the host has come with one controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// It asks what the controller expects.
    Opening,
    /// It sends ticks.
    Filling,
    /// All ticks are acknowledged; it asks whether they were done.
    Confirming,
    /// Every tick was done.
    Done,
    /// No more is sent, and why.
    GivenUp(GivenUp),
}

/// Why the host gave up on a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivenUp {
    /// It did not answer, as often as it was tried.
    NoReply,
    /// It is stopped.
    Stopped,
    /// It refused a frame for good.
    Refused(Reason),
    /// It rests and has done fewer ticks than it acknowledged.
    TicksMissing,
    /// The longest time that a run can be is over.
    OutOfTime,
}

impl Progress {
    /// Its name: `opening`, `filling`, `confirming`, `done` or `given_up`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Opening => "opening",
            Self::Filling => "filling",
            Self::Confirming => "confirming",
            Self::Done => "done",
            Self::GivenUp(_) => "given_up",
        }
    }
}

impl fmt::Display for GivenUp {
    /// Why, as the command's status and the page say it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoReply => f.write_str("no reply"),
            Self::Stopped => f.write_str("it is stopped"),
            Self::Refused(reason) => write!(f, "it refused a frame: {}", reason.name()),
            Self::TicksMissing => f.write_str("it did fewer ticks than it acknowledged"),
            Self::OutOfTime => f.write_str("the longest time of a run is over"),
        }
    }
}

impl fmt::Display for Progress {
    /// As the command's status and the page say it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::GivenUp(why) => write!(f, "given up: {why}"),
            progress => f.write_str(progress.name()),
        }
    }
}

/// A controller as the host knows it.
#[derive(Clone, Debug)]
pub(super) struct Peer {
    pub(super) job: Job,
    pub(super) most: u32,
    pub(super) progress: Progress,
    /// Ticks that the controller had done before the first was sent.
    pub(super) base: Option<u32>,
    /// Invariant: at most the ticks of the job.
    pub(super) acknowledged: u32,
    pub(super) seq: u8,
    pub(super) free: u32,
    /// When the next frame may be sent to it, and when its queue runs dry.
    pub(super) ready_at: Instant,
    pub(super) dry_at: Instant,
    /// How often the frame that is due was sent.
    pub(super) attempts: u8,
    /// Frames since ticks were last acknowledged.
    pub(super) since_progress: u32,
    /// What was left of a broken frame may wait at the controller for a delimiter.
    pub(super) flush: bool,
}

impl Peer {
    pub(super) fn new(job: Job, settings: &Settings, start: Instant) -> Self {
        Self {
            most: job.ticks_per_frame(settings).into(),
            progress: Progress::Opening,
            base: None,
            acknowledged: 0,
            seq: 0,
            free: 0,
            ready_at: start,
            dry_at: start,
            attempts: 0,
            since_progress: 0,
            flush: false,
            job,
        }
    }

    /// Whether nothing came of so many frames that nothing will: `attempts` for each place of its
    /// queue, which may have to run empty before it goes on, and for the exchanges around it.
    pub(super) fn stalls(&self, attempts: u8) -> bool {
        self.since_progress > u32::from(attempts) * (u32::from(self.job.queue_depth) + 3)
    }

    /// Whether there is more to say to it.
    pub(super) const fn is_open(&self) -> bool {
        !matches!(self.progress, Progress::Done | Progress::GivenUp(_))
    }

    /// Ticks that are not acknowledged.
    pub(super) fn left(&self) -> u32 {
        self.job.ticks() - self.acknowledged
    }

    /// The next so many ticks' commands.
    pub(super) fn commands(&self, ticks: u32) -> &[u8] {
        let channels = usize::from(self.job.channels);
        let from = self.acknowledged as usize * channels;
        self.job.commands.get(from..from + ticks as usize * channels).unwrap_or_default()
    }

    /// Ticks that the queue still holds take so long.
    const fn queued(&self, free: u32) -> Cycles {
        Cycles((self.job.queue_depth as u64).saturating_sub(free as u64) * self.job.tick.0)
    }

    /// Whether a status can follow the frame that was sent. A late answer to the frame before tells of
    /// another sequence number.
    pub(super) fn fits(&self, kind: Kind, status: Status) -> bool {
        kind != Kind::Ticks || status.expected_seq == self.seq.wrapping_add(1)
    }

    /// Takes a reply to a frame that was taken; gives the time until the next one is due.
    pub(super) fn acknowledge(&mut self, kind: Kind, ticks: u32, status: Status, now: Instant) -> Cycles {
        if kind == Kind::Ticks {
            self.acknowledged += ticks;
            debug_assert!(self.acknowledged <= self.job.ticks(), "more ticks are acknowledged than sent");
            self.since_progress = 0;
            self.seq = self.seq.wrapping_add(1);
        } else if status.state == State::Stopped {
            self.progress = Progress::GivenUp(GivenUp::Stopped);
        } else if self.progress == Progress::Opening {
            if status.state != State::Ready {
                return self.job.tick;
            }
            let base = *self.base.get_or_insert(status.ticks_done);
            let known = self.acknowledged;
            self.acknowledged = status.ticks_done.wrapping_sub(base).min(self.job.ticks());
            if self.acknowledged > known {
                self.since_progress = 0;
            }
            self.seq = status.expected_seq;
            self.progress = Progress::Filling;
        } else {
            let done = status.ticks_done.wrapping_sub(self.base.unwrap_or(0));
            self.progress = match status.state {
                _ if done == self.job.ticks() => Progress::Done,
                State::Ready => Progress::GivenUp(GivenUp::TicksMissing),
                _ => return self.job.tick,
            };
        }
        self.free = status.free.into();
        self.dry_at = now + self.queued(self.free);
        if self.progress != Progress::Filling {
            return Cycles(0);
        }
        if self.left() == 0 {
            self.progress = Progress::Confirming;
            // Those that wait, and one for the tick that runs.
            let waiting = self.queued(self.free);
            return Cycles(waiting.0 + self.job.tick.0);
        }
        let wanted = self.most.min(self.left());
        let missing = wanted.saturating_sub(self.free);
        self.free = self.free.max(wanted);
        Cycles(u64::from(missing) * self.job.tick.0)
    }

    /// Takes a refusal; gives the time until the frame is sent again.
    pub(super) fn refused(&mut self, reason: Reason) -> Cycles {
        match reason {
            Reason::QueueFull | Reason::Busy => {}
            Reason::Stopped => self.progress = Progress::GivenUp(GivenUp::Stopped),
            other => self.progress = Progress::GivenUp(GivenUp::Refused(other)),
        }
        self.job.tick
    }
}
