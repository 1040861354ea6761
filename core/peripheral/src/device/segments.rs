//! The segment engine: a pulse generator that runs a move without a serial line (DESIGN A8).
//!
//! ```text
//!          segment begins                  DIR  at max(next >> 16, last fall + H)
//! next   ──┬───────────┬─────────┬─────    STEP at next >> 16, W long
//! DIR    __│__╱────────│─────────│─────
//! STEP   ──┐_______┌───┐_____┌───┐_____    order of the events of a channel:
//!           H ╎  D ╎ W ╎                   fall <= DIR <= rise < fall
//! ```

use crate::device::Faults;
use crate::segment::{CheckedSegments, FRACTION_BITS, Segment, SegmentList};
use crate::signal::{Levels, MAX_CHANNELS, Record, Sink};
use crate::units::{Cycles, Instant};
use alloc::{sync::Arc, vec::Vec};

/// Runs validated segments.
///
/// ```
/// use std::sync::Arc;
/// use stepscope_peripheral::{device::SegmentEngine, segment::{CheckedSegments, PulseTimes, Segment, SegmentList},
///     signal::Record, units::{Cycles, Instant}};
///
/// let pulse = PulseTimes { width: Cycles(4), setup: Cycles(2), hold: Cycles(0) };
/// let steps = Segment::Steps { count: 3, interval: 10 << 16, add: 0, right: true };
/// let list = SegmentList { start: Instant(1), segments: vec![steps] };
/// let lists = CheckedSegments::new(pulse, vec![list], 1).expect("valid segments");
/// let mut engine = SegmentEngine::new(Arc::new(lists));
/// let mut trace: Vec<Record> = Vec::new();
/// engine.run(Instant::NEVER, &mut trace);
/// assert_eq!(engine.positions()[0], 3);
/// assert_eq!(engine.now(), Instant(1 + 30 + 4 + 1));
/// ```
#[derive(Clone, Debug)]
pub struct SegmentEngine {
    lists: Arc<CheckedSegments>,
    now: Instant,
    levels: Levels,
    channels: Vec<Channel>,
    /// Next cycle in which a signal changes; [`Instant::NEVER`] at the end.
    deadline: Instant,
    overloaded: bool,
}

#[derive(Clone, Copy, Debug)]
struct Channel {
    begun: usize,
    /// Steps of the current segment that are not scheduled yet.
    remaining: u32,
    interval: u64,
    add: i64,
    /// Time of the pending step (A8's `next`).
    next: u64,
    position: i32,
    right: bool,
    dir_change: Instant,
    rise: Instant,
    fall: Instant,
    /// Last fall + H: DIR must not change before.
    held: Instant,
}

impl Channel {
    fn new(list: &SegmentList) -> Self {
        let mut channel = Self {
            begun: 0,
            remaining: 0,
            interval: 0,
            add: 0,
            next: list.start.0 << FRACTION_BITS,
            position: 0,
            right: false,
            dir_change: Instant::NEVER,
            rise: Instant::NEVER,
            fall: Instant::NEVER,
            held: Instant::RESET,
        };
        channel.schedule_step(&list.segments);
        channel
    }

    fn due(&self) -> Instant {
        self.fall.min(self.dir_change).min(self.rise)
    }

    fn schedule_step(&mut self, segments: &[Segment]) {
        self.rise = Instant::NEVER;
        while self.remaining == 0 {
            let Some(segment) = segments.get(self.begun) else { return };
            self.begun += 1;
            match *segment {
                Segment::Dwell(dwell) => self.next += dwell,
                Segment::Steps { count, interval, add, right } => {
                    (self.remaining, self.interval, self.add) = (count, interval, add);
                    if right != self.right {
                        self.right = right;
                        self.dir_change = Instant(self.next >> FRACTION_BITS).max(self.held);
                    }
                }
            }
        }
        self.remaining -= 1;
        self.next += self.interval;
        self.interval = self.interval.wrapping_add_signed(self.add);
        self.rise = Instant(self.next >> FRACTION_BITS);
        debug_assert!(
            self.dir_change == Instant::NEVER || self.dir_change <= self.rise,
            "DIR changes after the rise"
        );
    }
}

impl SegmentEngine {
    /// An engine before cycle 0.
    pub fn new(lists: Arc<CheckedSegments>) -> Self {
        Self {
            channels: lists.lists().iter().map(Channel::new).collect(),
            lists,
            now: Instant::RESET,
            levels: Levels::RESET,
            deadline: Instant::RESET,
            overloaded: false,
        }
    }

    /// The next cycle to run.
    pub const fn now(&self) -> Instant {
        self.now
    }

    /// Position counters in steps since reset.
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        let mut positions = [0; MAX_CHANNELS];
        positions.iter_mut().zip(&self.channels).for_each(|(position, channel)| *position = channel.position);
        positions
    }

    /// Runs one cycle and returns its levels.
    pub fn clock(&mut self, sink: &mut impl Sink) -> Levels {
        let now = self.now;
        debug_assert!(now <= self.deadline, "{:?} was skipped", self.deadline);
        if now == self.deadline {
            self.act(now);
            sink.record(Record { cycle: now, levels: self.levels });
        }
        self.now = now.next();
        self.levels
    }

    /// Applies everything due in cycle `now`: at least one signal changes, except at reset.
    fn act(&mut self, now: Instant) {
        let pulse = self.lists.pulse();
        self.deadline = Instant::NEVER;
        if self.overloaded && self.levels.has(Levels::EN) {
            self.levels.0 &= !(Levels::EN | u64::from(u16::MAX));
        }
        for (index, (channel, list)) in self.channels.iter_mut().zip(self.lists.lists()).enumerate() {
            if channel.due() == now {
                let step = 1_u64 << index;
                if channel.fall == now {
                    channel.fall = Instant::NEVER;
                    self.levels.0 &= !step;
                }
                if channel.dir_change == now {
                    channel.dir_change = Instant::NEVER;
                    self.levels.0 ^= step << Levels::DIR_SHIFT;
                }
                if channel.rise == now {
                    self.levels.0 |= step;
                    channel.position = channel.position.wrapping_add(if channel.right { 1 } else { -1 });
                    channel.fall = now + pulse.width;
                    channel.held = channel.fall + pulse.hold;
                    channel.schedule_step(&list.segments);
                }
            }
            self.deadline = self.deadline.min(channel.due());
        }
    }

    /// The supply current was too high for too long: in the next cycle EN and STEP fall, DIR keeps its level, and
    /// no step follows. Has no effect before cycle 0.
    pub fn stop_on_overload(&mut self) {
        if self.now == Instant::RESET || self.overloaded {
            return;
        }
        self.overloaded = true;
        for channel in &mut self.channels {
            (channel.dir_change, channel.rise, channel.fall) =
                (Instant::NEVER, Instant::NEVER, Instant::NEVER);
        }
        self.deadline = self.now;
    }

    /// OVERLOAD after [`Self::stop_on_overload`], else none.
    pub const fn faults(&self) -> Faults {
        if self.overloaded { Faults::OVERLOAD } else { Faults::from_bits(0) }
    }

    /// Number of cycles without change; `None` without a limit.
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        match self.deadline {
            Instant::NEVER => None,
            deadline => Some(deadline - self.now),
        }
    }

    /// Skips cycles without change, at most [`Self::cycles_until_event`].
    pub fn advance(&mut self, cycles: Cycles) {
        let target = Instant(self.now.0.saturating_add(cycles.0));
        self.now = target.min(self.deadline);
    }

    /// Runs up to cycle `until`; with [`Instant::NEVER`], up to and including the last change. Stops early when the
    /// sink pauses.
    pub fn run(&mut self, until: Instant, sink: &mut impl Sink) {
        while self.now < until && !sink.is_paused() {
            if self.deadline >= until {
                if until != Instant::NEVER {
                    self.now = until;
                }
                return;
            }
            self.now = self.deadline;
            self.clock(sink);
        }
    }

    /// Whether nothing can change any more.
    pub const fn is_idle(&self) -> bool {
        self.deadline.0 == Instant::NEVER.0
    }
}
