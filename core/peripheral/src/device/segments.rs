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
use alloc::rc::Rc;
use earliest::Earliest;
use falls::FallingEdges;

// What a list can order is due in a cycle that the tree can hold.
const _: () = assert!(LAST_CYCLE.0 < Earliest::NONE.0);

/// The engine. It has room for all channels, whatever the lists: 1.6 kB beside them.
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
    channels: [Channel; MAX_CHANNELS],
    /// When each channel's DIR changes or its STEP rises next.
    due: Earliest,
    /// When the pulses that are high fall; after an overload, EN with them.
    falls: FallingEdges,
    overloaded: bool,
    /// From the rise of a pulse to its fall, and to where DIR may change again.
    width: Cycles,
    held_for: Cycles,
}

/// One channel's place in its list.
///
/// Of 64 bytes on every machine, so that it is found by a shift: 8 % for 16 channels that step at once in a browser.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Channel {
    /// Segments that have begun.
    begun: usize,
    /// Steps of this segment that are to come; while DIR is to change before them, they are `turning`.
    ///
    /// Invariant: one of the two is 0.
    left: u32,
    turning: u32,
    interval: u64,
    add: i64,
    /// A8's `next`: while a step is to come, its time.
    next: u64,
    /// Position counter at the end of this segment.
    target: i32,
    /// What a step adds to it: 1 where the list has ordered DIR = 1 last, else -1.
    sign: i32,
    /// Its bit of STEP.
    step: u32,
    /// Last fall + H, 0 before the first pulse: DIR is held until then.
    held: Instant,
}

const _: () = assert!(size_of::<Channel>() == 64);

impl Channel {
    /// A channel before its list, which starts in cycle `start`.
    const fn new(index: usize, start: Instant) -> Self {
        Self {
            begun: 0,
            left: 0,
            turning: 0,
            interval: 0,
            add: 0,
            next: start.0 << FRACTION_BITS,
            target: 0,
            sign: -1,
            step: 1 << index,
            held: Instant::RESET,
        }
    }

    /// Position counter: what is to come is taken from what it will be, so that a step has nothing to count.
    const fn position(&self) -> i32 {
        self.target.wrapping_sub(self.sign.wrapping_mul((self.left + self.turning) as i32))
    }

    /// The next step of this segment: its cycle.
    fn go_on(&mut self) -> Instant {
        debug_assert!(self.next.checked_add(self.interval).is_some(), "a step leaves 48.16 fixed point");
        self.next = self.next.wrapping_add(self.interval);
        self.interval = self.interval.wrapping_add_signed(self.add);
        self.rise()
    }

    /// Cycle of the step that comes next.
    const fn rise(&self) -> Instant {
        Instant(self.next >> FRACTION_BITS)
    }

    /// DIR changes: the cycle of the step after it.
    const fn turn(&mut self) -> Instant {
        (self.left, self.turning) = (self.turning, 0);
        self.rise()
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
                    let sign = if right { 1 } else { -1 };
                    let turns = sign != self.sign;
                    (self.left, self.turning) = if turns { (0, count) } else { (count, 0) };
                    (self.interval, self.add, self.sign) = (interval, add, sign);
                    self.target = self.target.wrapping_add(sign.wrapping_mul(count as i32));
                    let rise = self.go_on();
                    debug_assert!(turn <= rise, "DIR changes in {turn:?}, after the rise in {rise:?}");
                    return if turns { turn } else { rise };
                }
            }
        }
        self.left = 0;
        Instant::NEVER
    }
}

impl SegmentEngine {
    /// An engine before cycle 0.
    #[must_use]
    pub fn new(lists: Rc<CheckedSegments>) -> Self {
        let pulse = lists.pulse();
        let mut due = Earliest::new();
        let mut channels = core::array::from_fn(|index| Channel::new(index, Instant::RESET));
        for (index, (list, channel)) in lists.lists().iter().zip(&mut channels).enumerate() {
            *channel = Channel::new(index, list.start);
            due.set(index, channel.begin(&list.segments));
        }
        Self {
            lists,
            now: Instant::RESET,
            levels: Levels::RESET,
            channels,
            due,
            falls: FallingEdges::default(),
            overloaded: false,
            width: pulse.width,
            held_for: Cycles(pulse.width.0.saturating_add(pulse.hold.0)),
        }
    }

    /// The cycle that the next call of [`Self::clock`] is; as many have passed.
    #[must_use]
    pub const fn now(&self) -> Instant {
        self.now
    }

    /// Position counters: rising STEP edges, +1 where DIR is 1, -1 where it is 0.
    #[must_use]
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        self.channels.map(|channel| channel.position())
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
        match self.next() {
            _ if self.now == Instant::RESET => self.now,
            Earliest::NONE => Instant::NEVER,
            next => next,
        }
    }

    /// The same after cycle 0; [`Earliest::NONE`] at the end.
    #[inline(always)]
    fn next(&self) -> Instant {
        self.due.cycle().min(self.falls.cycle())
    }

    /// The supply current was too great for too long (PLANT F7): in the cycle after the one that was run last EN and STEP
    /// fall, DIR stays, and no step of any list follows. Before cycle 0 nothing, nor from cycle 2^60 - 1 on, long after the
    /// end of every list.
    pub fn overload(&mut self) {
        let runs = self.now != Instant::RESET && self.now < Earliest::NONE;
        if !runs || !self.levels.has(Levels::EN) {
            return;
        }
        self.due = Earliest::new();
        self.falls = FallingEdges::default();
        self.falls.push(self.now, Levels::EN | u64::from(u16::MAX));
        self.overloaded = true;
    }

    /// Faults so far: none but OVERLOAD.
    #[must_use]
    pub const fn faults(&self) -> Faults {
        if self.overloaded { Faults::OVERLOAD } else { Faults::from_bits(0) }
    }

    /// All that falls due in cycle `now`; at least one signal changes.
    #[inline(always)]
    fn act(&mut self, now: Instant) {
        let before = self.levels;
        if self.falls.cycle() == now {
            self.levels.0 &= !self.falls.pop();
        }
        let mut rising = 0;
        while self.due.cycle() == now {
            let index = self.due.channel();
            let channel = &mut self.channels[index];
            let next = if channel.left > 1 {
                channel.left -= 1;
                rising |= u64::from(channel.step);
                channel.go_on()
            } else if channel.turning > 0 {
                self.levels.0 ^= u64::from(channel.step) << Levels::DIR_SHIFT;
                channel.turn()
            } else {
                rising |= u64::from(channel.step);
                channel.held = now + self.held_for;
                channel.begin(self.lists.lists().get(index).map_or(&[], |list| &list.segments))
            };
            self.due.set(index, next);
        }
        if rising != 0 {
            self.levels.0 |= rising;
            self.falls.push(now + self.width, rising);
        }
        debug_assert!(self.levels != before, "no signal changes in {now:?}");
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
        let end = until.min(Earliest::NONE);
        let mut now = self.now;
        while !sink.paused() {
            let cycle = self.next();
            if cycle >= end {
                now = if until == Instant::NEVER { now } else { now.max(until) };
                break;
            }
            self.act(cycle);
            now = cycle.next();
            sink.record(Record { cycle, levels: self.levels });
        }
        self.now = now;
    }

    /// Whether nothing can change any more.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.deadline() == Instant::NEVER
    }
}
