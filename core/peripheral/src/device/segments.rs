//! The segment engine: a generator that runs a move by itself (DESIGN A8).
//!
//! It stands in the place of the tick path: the same ways through a run, all with the same trace,
//! but no line, so EN = RX = TX = 1 and DE = 0 throughout, but for an overload.
//!
//! ```text
//!          segment begins                  DIR  at max(next >> 16, last fall + H)
//! next   ──┬───────────┬─────────┬─────    STEP at next >> 16, W long
//! DIR    __│__╱────────│─────────│─────
//! STEP   ──┐_______┌───┐_____┌───┐_____    of one channel each event comes after the one before:
//!           H ╎  D ╎ W ╎                   fall <= DIR <= rise < fall
//! ```
//!
//! A channel waits for one thing at a time, its next change of DIR or its next rise; the earliest of
//! all channels is the root of a tree. All pulses have the same width, so the falls come in the
//! order of the rises and only queue.

mod earliest;
mod falls;

use crate::{
    device::Faults,
    segment::{CheckedSegments, FRACTION_BITS, LAST_CYCLE, Segment},
    signal::{Levels, MAX_CHANNELS, Record, Sink},
    units::{Cycles, Instant},
};
use alloc::{rc::Rc, vec::Vec};
use earliest::Earliest;
use falls::FallingEdges;

// What a list can order is due in a cycle that the tree can hold.
const _: () = assert!(LAST_CYCLE.0 <= Earliest::LAST.0);

/// The engine.
///
/// ```
/// use std::rc::Rc;
/// use stepscope_peripheral::{
///     device::SegmentEngine,
///     segment::{CheckedSegments, PulseTimes, Segment, SegmentList},
///     signal::Record,
///     units::{Cycles, Instant},
/// };
///
/// let pulse = PulseTimes { width: Cycles(4), setup: Cycles(2), hold: Cycles(0) };
/// let steps = Segment::Steps { count: 3, interval: 10 << 16, add: 0, right: true };
/// let list = SegmentList { start: Instant(1), segments: vec![steps] };
/// let lists = CheckedSegments::new(pulse, vec![list], 1).expect("it keeps the rules");
/// let mut engine = SegmentEngine::new(Rc::new(lists));
/// let mut trace: Vec<Record> = Vec::new();
/// engine.run(Instant::NEVER, &mut trace);
/// assert_eq!(engine.positions()[0], 3);
/// assert_eq!(engine.now(), Instant(1 + 30 + 4 + 1));
/// ```
#[derive(Clone, Debug)]
pub struct SegmentEngine {
    lists: Rc<CheckedSegments>,
    /// The cycle that the next call of `clock` is.
    now: Instant,
    levels: Levels,
    channels: Vec<Channel>,
    /// When each channel's DIR changes or its STEP rises next.
    due: Earliest,
    /// When the pulses that are high fall.
    falls: FallingEdges,
    positions: [i32; MAX_CHANNELS],
    /// The cycle in which EN and STEP fall, after an overload; [`Instant::NEVER`] without one.
    halt: Instant,
}

/// One channel's place in its list.
#[derive(Clone, Debug)]
struct Channel {
    /// Segments that have begun.
    begun: usize,
    /// Steps of this segment after the one that comes next.
    left: u32,
    interval: u64,
    add: i64,
    /// A8's `next`: while a step is to come, its time.
    next: u64,
    /// Level of DIR that the list has ordered so far.
    right: bool,
    /// Whether DIR changes before the next step.
    turns: bool,
    /// Last fall + H, 0 before the first pulse: DIR is held until then.
    held: Instant,
}

impl Channel {
    /// The next step of this segment: its cycle.
    fn step(&mut self) -> Instant {
        debug_assert!(self.next.checked_add(self.interval).is_some(), "a step leaves 48.16 fixed point");
        self.next = self.next.wrapping_add(self.interval);
        self.interval = self.interval.wrapping_add_signed(self.add);
        self.rise()
    }

    /// Cycle of the step that comes next.
    const fn rise(&self) -> Instant {
        Instant(self.next >> FRACTION_BITS)
    }

    /// Goes on to the next segment with steps: the cycle of its change of DIR, where there is one,
    /// or of its first step; [`Instant::NEVER`] at the list's end.
    fn begin(&mut self, segments: &[Segment]) -> Instant {
        while let Some(segment) = segments.get(self.begun) {
            self.begun += 1;
            match *segment {
                Segment::Dwell(dwell) => self.next = self.next.wrapping_add(dwell),
                Segment::Steps { count, interval, add, right } => {
                    let turn = self.rise().max(self.held);
                    self.turns = right != self.right;
                    (self.left, self.interval, self.add, self.right) =
                        (count.saturating_sub(1), interval, add, right);
                    let rise = self.step();
                    debug_assert!(turn <= rise, "DIR changes in {turn:?}, after the rise in {rise:?}");
                    return if self.turns { turn } else { rise };
                }
            }
        }
        Instant::NEVER
    }
}

impl SegmentEngine {
    /// An engine before cycle 0.
    #[must_use]
    pub fn new(lists: Rc<CheckedSegments>) -> Self {
        let mut due = Earliest::new(lists.lists().len());
        let channels = lists.lists().iter().enumerate().map(|(index, list)| {
            let mut channel = Channel {
                begun: 0,
                left: 0,
                interval: 0,
                add: 0,
                next: list.start.0 << FRACTION_BITS,
                right: false,
                turns: false,
                held: Instant::RESET,
            };
            due.set(index, channel.begin(&list.segments));
            channel
        });
        let channels = channels.collect();
        let positions = [0; MAX_CHANNELS];
        let (now, levels) = (Instant::RESET, Levels::RESET);
        Self {
            lists,
            now,
            levels,
            channels,
            due,
            falls: FallingEdges::default(),
            positions,
            halt: Instant::NEVER,
        }
    }

    /// The cycle that the next call of [`Self::clock`] is; as many have passed.
    #[must_use]
    pub const fn now(&self) -> Instant {
        self.now
    }

    /// Position counters: rising STEP edges, +1 where DIR is 1, -1 where it is 0.
    #[must_use]
    pub const fn positions(&self) -> [i32; MAX_CHANNELS] {
        self.positions
    }

    /// Advances one cycle and gives the levels of all signals in it.
    pub fn clock(&mut self, sink: &mut impl Sink) -> Levels {
        let now = self.now;
        if now == self.deadline() {
            if now != Instant::RESET {
                self.act(now);
            }
            sink.record(Record { cycle: now, levels: self.levels });
        }
        self.now = now.next();
        self.levels
    }

    /// Next cycle in which a signal changes, cycle 0 for the first; [`Instant::NEVER`] at the end.
    fn deadline(&self) -> Instant {
        if self.now == Instant::RESET {
            self.now
        } else {
            self.due.cycle().min(self.falls.cycle()).min(self.halt)
        }
    }

    /// The supply current was too great for too long (PLANT F7): in the cycle after the one that was run last EN and STEP
    /// fall, DIR stays, and no step of any list follows. Before cycle 0 nothing.
    pub fn overload(&mut self) {
        if self.now == Instant::RESET || !self.levels.has(Levels::EN) {
            return;
        }
        self.due = Earliest::new(self.channels.len());
        self.falls = FallingEdges::default();
        self.halt = self.now;
    }

    /// Faults so far: none but OVERLOAD.
    #[must_use]
    pub const fn faults(&self) -> Faults {
        if self.levels.has(Levels::EN) && self.halt.0 == Instant::NEVER.0 {
            Faults::from_bits(0)
        } else {
            Faults::OVERLOAD
        }
    }

    /// All that falls due in cycle `now`; at least one signal changes.
    fn act(&mut self, now: Instant) {
        if now == self.halt {
            self.halt = Instant::NEVER;
            self.levels.0 &= !(Levels::EN | u64::from(u16::MAX));
            return;
        }
        let mut levels = self.levels.0;
        if self.falls.cycle() == now {
            levels &= !u64::from(self.falls.pop());
        }
        let pulse = self.lists.pulse();
        let mut rising = 0_u16;
        while self.due.cycle() == now {
            let index = self.due.channel();
            let Some(channel) = self.channels.get_mut(index) else { break };
            let next = if channel.turns {
                channel.turns = false;
                levels ^= 1 << (Levels::DIR_SHIFT as usize + index);
                channel.rise()
            } else {
                rising |= 1 << index;
                if let Some(position) = self.positions.get_mut(index) {
                    *position = position.wrapping_add(if channel.right { 1 } else { -1 });
                }
                if channel.left > 0 {
                    channel.left -= 1;
                    channel.step()
                } else {
                    channel.held = now + pulse.width + pulse.hold;
                    channel.begin(self.lists.lists().get(index).map_or(&[], |list| &list.segments))
                }
            };
            self.due.set(index, next);
        }
        if rising != 0 {
            levels |= u64::from(rising);
            self.falls.push(now + pulse.width, rising);
        }
        debug_assert!(self.levels.0 != levels, "no signal changes in {now:?}");
        self.levels = Levels(levels);
    }

    /// For how many cycles nothing can change; `None` if it is for ever.
    #[must_use]
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        match self.deadline() {
            Instant::NEVER => None,
            deadline => Some(deadline - self.now),
        }
    }

    /// Passes cycles in which nothing changes: no more than [`Self::cycles_until_event`] says. What goes beyond
    /// is not skipped.
    pub fn advance(&mut self, cycles: Cycles) {
        let target = Instant(self.now.0.saturating_add(cycles.0));
        self.now = target.min(self.deadline());
    }

    /// Runs until cycle `until` is the next, as fast as the edges allow; with [`Instant::NEVER`],
    /// until nothing can change any more: then the last cycle run is the last in which something
    /// did. Stops early where the sink asks for a pause.
    pub fn run(&mut self, until: Instant, sink: &mut impl Sink) {
        if self.now == Instant::RESET && self.now < until {
            self.clock(sink);
        }
        loop {
            let cycle = self.deadline();
            if sink.paused() {
                return;
            }
            if cycle >= until {
                break;
            }
            self.act(cycle);
            self.now = cycle.next();
            sink.record(Record { cycle, levels: self.levels });
        }
        if until != Instant::NEVER {
            self.now = self.now.max(until);
        }
    }

    /// Whether nothing can change any more.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.deadline() == Instant::NEVER
    }
}
