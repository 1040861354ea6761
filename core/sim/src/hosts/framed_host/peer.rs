//! The host's state of one controller on a framed line: its job, its progress, and what its replies change.

use super::tick_sums::TickSums;
use alloc::{sync::Arc, vec::Vec};
use core::fmt;
use stepscope_peripheral::signal::Positions;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::frame::{self, Kind, Reason, State, Status};
use stepscope_peripheral::wire::packet::MAX_STEPS;
use stepscope_scenario::Host as Settings;

/// The ticks for a controller.
#[derive(Clone, Debug)]
pub struct Job {
    pub address: u8,
    /// Channels of the controller, which are the bytes of a tick.
    pub channels: u8,
    pub tick: Cycles,
    /// Ticks that the controller can queue.
    pub queue_depth: u8,
    /// One byte per channel, tick after tick.
    pub commands: Arc<[u8]>,
}

impl Job {
    pub fn ticks(&self) -> u32 {
        (self.commands.len() / usize::from(self.channels.max(1))) as u32
    }

    /// Maximum ticks per frame: half of the queue, so that the other half runs while a frame is sent.
    pub fn ticks_per_frame(&self, settings: &Settings) -> u8 {
        settings.ticks_per_frame.min(frame::MAX_TICKS).min(self.queue_depth / 2).max(1)
    }
}

/// The host's progress with one controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Reads the sequence number and the ticks done.
    Opening,
    /// Reads the positions before the next tick.
    Locating,
    /// Real lines only: sends a tick without steps and waits until it is done.
    Starting,
    /// Sends ticks.
    Filling,
    /// All ticks are acknowledged; checks that they were done.
    Confirming,
    /// Checks that the positions are the sums of the ticks.
    Verifying,
    /// Every tick was done, and the positions confirm it.
    Done,
    /// Every tick was done by the controller's own count; it does not support POSITIONS.
    Counted,
    /// Sends STOP until it is acknowledged, then STATUS and POSITIONS.
    Stopping,
    /// No more is sent.
    GivenUp(GivenUp),
}

/// Why the host gave up on a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GivenUp {
    /// No reply to any attempt.
    NoReply,
    /// The controller is stopped.
    Stopped,
    /// It refused a frame.
    Refused(Reason),
    /// Idle, with fewer ticks done than acknowledged.
    TicksMissing,
    /// Its positions are not the sums of its ticks.
    Displaced {
        channel: u8,
        ticks: u32,
        /// The sums of these ticks.
        expected: i32,
        reported: i32,
    },
    /// It has done more ticks than were commanded: it was reset, or another host drives it.
    OtherTicks {
        /// Its count since the first tick, wrapping.
        done: u32,
        commanded: u32,
    },
    /// Its sequence number or its count of ticks went back.
    Reset,
    /// It has another number of channels than the ticks.
    OtherChannels { expected: u8, reported: u8 },
    /// The host was stopped, and the controller has acknowledged STOP.
    Interrupted,
    /// The run reached its maximum length.
    OutOfTime,
}

impl Progress {
    /// The name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Opening => "opening",
            Self::Locating => "locating",
            Self::Starting => "starting",
            Self::Filling => "filling",
            Self::Confirming => "confirming",
            Self::Verifying => "verifying",
            Self::Done => "done",
            Self::Counted => "counted",
            Self::Stopping => "stopping",
            Self::GivenUp(_) => "given_up",
        }
    }
}

impl fmt::Display for GivenUp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoReply => f.write_str("no reply"),
            Self::Stopped => f.write_str("the controller is stopped; send ENABLE or reset it"),
            Self::Refused(reason) => write!(f, "the controller refused a frame: {}", reason.name()),
            Self::TicksMissing => f.write_str("the controller executed fewer ticks than it acknowledged"),
            Self::Displaced { channel, ticks, expected, reported } => {
                let s = if *ticks == 1 { "" } else { "s" };
                write!(f, "after {ticks} tick{s} channel {channel} is at {reported} instead of {expected}")
            }
            Self::OtherTicks { done, commanded } => {
                write!(
                    f,
                    "the controller executed {done} ticks, but {commanded} were sent: it was reset, or another host controls it"
                )
            }
            Self::Reset => {
                f.write_str("the controller was reset during the job, or another host controls it")
            }
            Self::OtherChannels { expected, reported } => {
                write!(
                    f,
                    "the controller reports positions of {reported} channels, but its ticks are for {expected}"
                )
            }
            Self::Interrupted => f.write_str("the host was stopped"),
            Self::OutOfTime => f.write_str("the run reached its maximum length"),
        }
    }
}

impl fmt::Display for Progress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::GivenUp(why) => write!(f, "given up: {why}"),
            Self::Counted => {
                f.write_str("all ticks are counted, but the controller does not report positions")
            }
            progress => f.write_str(progress.name()),
        }
    }
}

/// What the host has learned about a controller from its replies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Known {
    /// The first status while it was idle.
    pub opening: Option<Status>,
    /// The status after the opening tick of a real line.
    pub started: Option<Status>,
    pub last: Option<Status>,
    /// Ticks of the job that are done, by the last plausible reply.
    done: Option<u32>,
    /// The positions before the first tick.
    pub opening_positions: Option<Positions>,
    pub positions: Option<Positions>,
    /// Whether it does not support POSITIONS.
    pub hides_positions: bool,
    pub stop_acknowledged: bool,
}

impl Known {
    /// Ticks of the job that the controller reported as done; after a reset, those reported before.
    pub const fn ticks_done(&self) -> Option<u32> {
        self.done
    }

    /// Ticks done since the start of the job.
    fn counted(&self, status: Status) -> Option<u32> {
        let began = self.started.or(self.opening)?;
        Some(status.ticks_done.wrapping_sub(began.ticks_done))
    }
}

#[derive(Clone, Debug)]
pub(super) struct Peer {
    pub(super) job: Job,
    sums: TickSums,
    max_ticks_per_frame: u32,
    pub(super) progress: Progress,
    /// The frame that is due while the controller is being stopped.
    stop_stage: Kind,
    pub(super) known: Known,
    /// Invariant: at most the ticks of the job.
    pub(super) acknowledged: u32,
    pub(super) seq: u8,
    /// Free entries of the controller's queue.
    pub(super) free: u32,
    pub(super) ready_at: Instant,
    pub(super) queue_empty_at: Instant,
    pub(super) attempts: u8,
    pub(super) frames_without_progress: u32,
    /// Whether the next frame must begin with a delimiter, which ends an incomplete frame in the receiver.
    pub(super) needs_delimiter: bool,
    pub(super) opening_tick: bool,
    /// Acknowledged opening ticks, and whether the last one is not done yet.
    opening_ticks: u32,
    awaits_opening_tick: bool,
}

impl Peer {
    pub(super) fn new(job: Job, settings: &Settings, start: Instant) -> Self {
        Self {
            max_ticks_per_frame: job.ticks_per_frame(settings).into(),
            sums: TickSums::new(Arc::clone(&job.commands), job.channels),
            progress: Progress::Opening,
            stop_stage: Kind::Stop,
            known: Known::default(),
            acknowledged: 0,
            seq: 0,
            free: 0,
            ready_at: start,
            queue_empty_at: start,
            attempts: 0,
            frames_without_progress: 0,
            needs_delimiter: false,
            opening_tick: false,
            opening_ticks: 0,
            awaits_opening_tick: false,
            job,
        }
    }

    /// Whether too many frames brought no progress: `attempts` per entry of the queue, which may have to run empty first,
    /// and per exchange before and after it.
    pub(super) fn is_stalled(&self, attempts: u8) -> bool {
        self.frames_without_progress > u32::from(attempts) * (u32::from(self.job.queue_depth) + 5)
    }

    pub(super) const fn is_open(&self) -> bool {
        !matches!(self.progress, Progress::Done | Progress::Counted | Progress::GivenUp(_))
    }

    pub(super) fn left(&self) -> u32 {
        self.job.ticks() - self.acknowledged
    }

    /// Kind and number of ticks of the frame that is due.
    pub(super) fn due_frame(&self) -> (Kind, u32) {
        match self.progress {
            Progress::Filling => {
                (Kind::Ticks, self.max_ticks_per_frame.min(self.free).min(self.left()).max(1))
            }
            // The opening tick.
            Progress::Starting if !self.awaits_opening_tick => (Kind::Ticks, 0),
            Progress::Locating | Progress::Verifying => (Kind::Positions, 0),
            Progress::Stopping => (self.stop_stage, 0),
            _ => (Kind::Status, 0),
        }
    }

    /// Commands of the next ticks; for 0 ticks the commands of the opening tick.
    pub(super) fn commands(&self, ticks: u32) -> Vec<u8> {
        let channels = usize::from(self.job.channels);
        let commands = &self.job.commands;
        if ticks == 0 {
            // The directions of the first tick, so that DIR does not change more often.
            return commands.iter().take(channels).map(|byte| byte & !MAX_STEPS).collect();
        }
        let from = self.acknowledged as usize * channels;
        commands.get(from..from + ticks as usize * channels).unwrap_or_default().to_vec()
    }

    /// Time until the queue is empty.
    const fn queued(&self, free: u32) -> Cycles {
        Cycles((self.job.queue_depth as u64).saturating_sub(free as u64) * self.job.tick.0)
    }

    /// Whether this is the reply to the pending frame. A late reply to the previous one has another sequence number.
    pub(super) fn is_current(&self, kind: Kind, status: Status) -> bool {
        kind != Kind::Ticks || status.expected_seq == self.seq.wrapping_add(1)
    }

    pub(super) fn stop(&mut self, now: Instant) {
        (self.progress, self.stop_stage) = (Progress::Stopping, Kind::Stop);
        (self.attempts, self.frames_without_progress, self.ready_at) = (0, 0, now);
    }

    pub(super) fn restart(&mut self, now: Instant, until: Instant) {
        self.progress = Progress::Opening;
        (self.ready_at, self.queue_empty_at, self.needs_delimiter) = (until, now, true);
    }

    /// Handles a reply to the pending frame; returns the time until the next frame.
    pub(super) fn acknowledge(
        &mut self,
        (kind, ticks): (Kind, u32),
        (status, positions): (Status, Option<Positions>),
        now: Instant,
    ) -> Cycles {
        self.known.positions = positions.or(self.known.positions);
        if kind == Kind::Ticks {
            self.acknowledged += ticks;
            debug_assert!(self.acknowledged <= self.job.ticks(), "more ticks are acknowledged than sent");
            self.seq = self.seq.wrapping_add(1);
            if ticks > 0 {
                self.frames_without_progress = 0;
            } else {
                self.opening_ticks += 1;
                self.awaits_opening_tick = true;
            }
        }
        let before = self.known.done;
        let counted = self.store_status(status);
        if self.progress == Progress::Stopping {
            self.after_stop(kind);
            return Cycles(0);
        }
        if status.state == State::Stopped {
            self.progress = Progress::GivenUp(GivenUp::Stopped);
        }
        let ready = status.state == State::Ready;
        match self.progress {
            Progress::Opening if ready => self.open(status),
            Progress::Locating if ready && self.has_not_moved(status) => {
                self.progress = self.check_positions(positions).map_or(self.first_stage(), Progress::GivenUp);
            }
            Progress::Starting if kind == Kind::Ticks || !ready => {
                return Cycles(self.queued(status.free.into()).0 + self.job.tick.0);
            }
            Progress::Starting if self.did_opening_ticks(status) => self.start(status),
            Progress::Starting => {
                self.start_over();
                return self.job.tick;
            }
            // A reset empties the queue: the controller reports fewer ticks than before, or more than it accepted.
            Progress::Filling if counted < before || counted > Some(self.acknowledged) => {
                self.progress = Progress::GivenUp(GivenUp::Reset);
            }
            Progress::Confirming if ready && status.expected_seq != self.seq => {
                self.progress = Progress::GivenUp(GivenUp::Reset);
            }
            Progress::Confirming if counted == Some(self.job.ticks()) => {
                let verified = !self.known.hides_positions;
                self.progress = if verified { Progress::Verifying } else { Progress::Counted };
            }
            Progress::Confirming if ready => {
                let (done, commanded) = (counted.unwrap_or(0), self.job.ticks());
                let other = GivenUp::OtherTicks { done, commanded };
                self.progress =
                    Progress::GivenUp(if done < commanded { GivenUp::TicksMissing } else { other });
            }
            Progress::Verifying if ready && self.has_not_moved(status) => {
                self.progress = self.check_positions(positions).map_or(Progress::Done, Progress::GivenUp);
            }
            // Another host moves the controller: open or confirm again when it is idle.
            Progress::Locating => {
                self.progress = Progress::Opening;
                if self.known.opening_positions.is_none() {
                    self.start_over();
                }
                return self.job.tick;
            }
            Progress::Verifying => {
                self.progress = Progress::Confirming;
                return self.job.tick;
            }
            Progress::Opening | Progress::Confirming => return self.job.tick,
            _ => {}
        }
        self.free = status.free.into();
        self.queue_empty_at = now + self.queued(self.free);
        self.time_to_next_frame()
    }

    /// The controller is idle: finds its sequence number and the first tick that is not done.
    fn open(&mut self, status: Status) {
        let base = self.known.opening.get_or_insert(status).ticks_done;
        let (known, commanded) = (self.acknowledged, self.job.ticks());
        let done = status.ticks_done.wrapping_sub(base);
        self.acknowledged = done.min(commanded);
        if self.acknowledged > known {
            self.frames_without_progress = 0;
        }
        self.seq = status.expected_seq;
        self.known.done = Some(self.acknowledged);
        self.progress = match self.known.hides_positions {
            _ if done > commanded => Progress::GivenUp(GivenUp::OtherTicks { done, commanded }),
            true => self.first_stage(),
            false => Progress::Locating,
        };
    }

    const fn first_stage(&self) -> Progress {
        if self.opening_tick && self.known.started.is_none() { Progress::Starting } else { Progress::Filling }
    }

    /// Whether the controller has done the opening ticks and no others.
    fn did_opening_ticks(&self, status: Status) -> bool {
        let done = self.known.opening.map(|opening| status.ticks_done.wrapping_sub(opening.ticks_done));
        done == Some(self.opening_ticks) && status.expected_seq == self.seq
    }

    /// A controller that was reset expects sequence number 0 and has done 0 ticks. If this one reports the same, another
    /// opening tick is needed to distinguish them.
    fn start(&mut self, status: Status) {
        self.awaits_opening_tick = false;
        if status.expected_seq != 0 && status.ticks_done != 0 {
            (self.known.started, self.known.done) = (Some(status), Some(0));
            (self.progress, self.frames_without_progress) = (Progress::Filling, 0);
        }
    }

    /// Starts over, because no tick of the job has been sent.
    fn start_over(&mut self) {
        self.progress = Progress::Opening;
        (self.known.opening, self.known.opening_positions, self.known.done) = (None, None, None);
        (self.acknowledged, self.opening_ticks, self.awaits_opening_tick) = (0, 0, false);
    }

    /// Stores a status; returns its count of ticks since the first one.
    fn store_status(&mut self, status: Status) -> Option<u32> {
        self.known.last = Some(status);
        let counted = self.known.counted(status);
        // The controller may have accepted the last ticks although the host received no reply.
        let knows_less = matches!(self.progress, Progress::Opening | Progress::Stopping);
        let max = if knows_less { self.job.ticks() } else { self.acknowledged };
        let is_plausible = knows_less || status.expected_seq == self.seq;
        if is_plausible && counted.is_some_and(|counted| counted <= max) {
            self.known.done = counted;
        }
        counted
    }

    fn has_not_moved(&self, status: Status) -> bool {
        self.known.counted(status) == Some(self.acknowledged) && status.expected_seq == self.seq
    }

    /// Compares the reported positions with the sums of the acknowledged ticks. The first reported positions are the start.
    fn check_positions(&mut self, reported: Option<Positions>) -> Option<GivenUp> {
        let reported = reported?;
        let (expected, reported_channels) = (self.job.channels, reported.as_slice().len() as u8);
        if reported_channels != expected {
            return Some(GivenUp::OtherChannels { expected, reported: reported_channels });
        }
        self.known.opening_positions.get_or_insert(reported);
        let ticks = self.acknowledged;
        let expected = self.expected(ticks)?;
        let mut channels = (0..).zip(reported.as_slice().iter().zip(expected));
        channels
            .find(|(_, (reported, expected))| **reported != *expected)
            .map(|(channel, (&reported, expected))| GivenUp::Displaced { channel, ticks, expected, reported })
    }

    pub(super) fn sums(&mut self, ticks: u32) -> Vec<i32> {
        self.sums.after(ticks).to_vec()
    }

    pub(super) fn expected(&mut self, ticks: u32) -> Option<Vec<i32>> {
        let began = self.known.opening_positions?;
        let sums = self.sums.after(ticks).iter();
        Some(began.as_slice().iter().zip(sums).map(|(began, sum)| began.wrapping_add(*sum)).collect())
    }

    fn after_stop(&mut self, kind: Kind) {
        match kind {
            Kind::Stop => {
                self.known.stop_acknowledged = true;
                self.stop_stage = Kind::Status;
            }
            Kind::Status if self.stop_stage == Kind::Status && !self.known.hides_positions => {
                self.stop_stage = Kind::Positions;
            }
            Kind::Status | Kind::Positions if self.stop_stage == kind => {
                self.progress = Progress::GivenUp(GivenUp::Interrupted);
            }
            // A late reply to a frame from before the stop.
            _ => {}
        }
    }

    fn time_to_next_frame(&mut self) -> Cycles {
        if self.progress != Progress::Filling {
            return Cycles(0);
        }
        if self.left() == 0 {
            self.progress = Progress::Confirming;
            // The queue, and the tick that runs.
            return Cycles(self.queued(self.free).0 + self.job.tick.0);
        }
        let wanted = self.max_ticks_per_frame.min(self.left());
        let missing = wanted.saturating_sub(self.free);
        self.free = self.free.max(wanted);
        Cycles(u64::from(missing) * self.job.tick.0)
    }

    /// Handles a refusal; returns the time until the next frame.
    pub(super) fn refused(&mut self, kind: Kind, reason: Reason, status: Status) -> Cycles {
        self.store_status(status);
        let unknown = kind == Kind::Positions && reason == Reason::UnknownKind;
        self.known.hides_positions |= unknown;
        match (self.progress, reason) {
            (Progress::Locating, _) if unknown => {
                self.progress = self.first_stage();
                return self.time_to_next_frame();
            }
            (Progress::Verifying, _) if unknown => self.progress = Progress::Counted,
            (Progress::Stopping, _) if unknown || kind != self.stop_stage => {
                self.after_stop(kind);
                return Cycles(0);
            }
            (_, Reason::QueueFull | Reason::Busy) => {}
            (Progress::Starting, Reason::BadSeq) => self.start_over(),
            (_, Reason::BadSeq) => self.progress = Progress::GivenUp(GivenUp::Reset),
            (_, Reason::Stopped) => self.progress = Progress::GivenUp(GivenUp::Stopped),
            (_, other) => self.progress = Progress::GivenUp(GivenUp::Refused(other)),
        }
        self.job.tick
    }
}
