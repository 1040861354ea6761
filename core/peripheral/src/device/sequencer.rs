//! The queue and the tick sequencer (DESIGN A7).
//!
//! The tick at the head of the queue starts at c0 = max(p + 1, e): p its commit cycle, e the end of
//! the tick before. It leaves the queue at c0 and ends at e = c0 + M*Ts; ticks_done counts there.
//! When the queue is empty at e the sequencer rests: STEP = 0, DIR keeps its level.

use crate::device::{
    Faults,
    plan::{Change, Lines, Plan, STEPS},
};
use crate::{
    config::{Config, Protocol},
    signal::{Event, Levels, MAX_CHANNELS, Record, Sink},
    units::{Cycles, Instant},
    wire::{
        packet::{ChannelCommand, Tick},
        sender::{BitStarts, NO_BIT},
    },
};
use alloc::{collections::VecDeque, vec::Vec};
use core::slice::Iter;

#[derive(Clone, Debug)]
pub(super) struct Sequencer {
    tick: Cycles,
    depth: usize,
    /// Invariant: at most `depth` ticks.
    queue: VecDeque<Tick>,
    plan: Plan,
    running: Option<Running>,
    /// What is left of a self-test, the next change last; empty where there is none.
    ///
    /// Invariant: while any is left no tick runs, as all of it is during the boot.
    self_test: Vec<Change>,
    /// STEP falls in the next cycle, after a stop.
    halt: bool,
    /// Whether a tick with steps that none follows is a fault: the framed protocol's rule.
    framed: bool,
    faults: Faults,
    /// Next cycle in which the sequencer does something: the next change of the plan or the end of
    /// the tick that runs, else the start of the queue's head; [`Instant::NEVER`] at rest.
    ///
    /// Invariant: no cycle is run past it.
    deadline: Instant,
    lines: Lines,
    /// Positions as of the end of the last tick, or of STOP.
    positions: [i32; MAX_CHANNELS],
    ticks_done: u32,
    /// Where the last tick ended, or STOP abandoned it.
    last_active: Instant,
}

/// The tick that runs: the plan's.
#[derive(Clone, Copy, Debug)]
struct Running {
    c0: Instant,
    end: Instant,
    /// Next entry of the plan's changes.
    next: usize,
}

impl Sequencer {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            tick: config.tick(),
            depth: usize::from(config.queue_depth),
            queue: VecDeque::with_capacity(usize::from(config.queue_depth)),
            plan: Plan::new(config),
            running: None,
            self_test: Vec::new(),
            halt: false,
            framed: config.protocol == Protocol::Framed,
            faults: Faults::default(),
            deadline: Instant::NEVER,
            lines: 0,
            positions: [0; MAX_CHANNELS],
            ticks_done: 0,
            last_active: Instant::RESET,
        }
    }

    /// Makes these changes, rising in time from reset on, during the boot (PLANT F7).
    pub(super) fn test(&mut self, mut changes: Vec<Change>) {
        changes.reverse();
        self.deadline = changes.last().map_or(Instant::NEVER, |first| Instant(first.offset));
        self.self_test = changes;
    }

    /// STEP and DIR now.
    pub(super) const fn lines(&self) -> Lines {
        self.lines
    }

    pub(super) const fn ticks_done(&self) -> u32 {
        self.ticks_done
    }

    /// Where the last tick ended: at rest, the last cycle in which the sequencer did
    /// something.
    pub(super) const fn last_active(&self) -> Instant {
        self.last_active
    }

    /// Positions now: those at the last tick's end and the edges of the one that runs.
    pub(super) fn positions(&self) -> [i32; MAX_CHANNELS] {
        let mut positions = self.positions;
        if let Some(running) = self.running {
            let mut before = 0;
            for change in self.plan.changes().iter().take(running.next) {
                let rising = change.lines & !before & STEPS;
                count(&mut positions, self.plan.commands(), |channel| rising >> channel & 1);
                before = change.lines;
            }
        }
        positions
    }

    /// Queues a tick that was committed in cycle `now`; the caller knows that there is a place.
    pub(super) fn push(&mut self, now: Instant, tick: Tick) {
        debug_assert!(self.queue.len() < self.depth, "no place for a tick that was admitted");
        if self.queue.is_empty() && self.running.is_none() {
            self.deadline = now.next();
        }
        self.queue.push_back(tick);
    }

    /// UNDERRUN, if it has been.
    pub(super) const fn faults(&self) -> Faults {
        self.faults
    }

    pub(super) const fn clear_faults(&mut self, which: Faults) {
        self.faults.clear(which);
    }

    /// Another timing for the ticks that start from now on; the caller knows that none runs or waits.
    pub(super) fn retime(&mut self, config: &Config) {
        debug_assert!(!self.is_moving(), "another timing while a tick runs or waits");
        self.tick = config.tick();
        self.plan = Plan::new(config);
    }

    /// Whether a tick runs or waits.
    pub(super) fn is_moving(&self) -> bool {
        self.running.is_some() || !self.queue.is_empty()
    }

    /// Free places in the queue.
    pub(super) fn free(&self) -> u8 {
        (self.depth - self.queue.len()) as u8
    }

    /// Abandons the tick that runs and those that wait: STEP falls in the cycle after `now`, DIR
    /// stays. Pulses that rose count.
    pub(super) fn stop(&mut self, now: Instant) {
        self.positions = self.positions();
        self.running = None;
        self.queue.clear();
        self.self_test.clear();
        self.halt = true;
        self.deadline = now.next();
    }

    /// Next cycle in which the sequencer does something; [`Instant::NEVER`] at rest.
    pub(super) const fn deadline(&self) -> Instant {
        self.deadline
    }

    /// Cycle `now`.
    #[inline(always)]
    pub(super) fn clock(&mut self, now: Instant, sink: &mut impl Sink) {
        debug_assert!(now <= self.deadline, "{:?} was left out", self.deadline);
        if self.deadline == now {
            self.act(now, sink);
        }
    }

    /// All that falls due in cycle `now`. Apart from [`Self::clock`], so that a cycle without needs no memory of its own in wasm.
    #[inline(never)]
    fn act(&mut self, now: Instant, sink: &mut impl Sink) {
        debug_assert!(self.queue.len() <= self.depth, "more ticks wait than the queue holds");
        while self.deadline == now {
            match self.running {
                Some(running) => self.follow(running, now, sink),
                None if self.halt => self.halt(now),
                None if !self.self_test.is_empty() => self.follow_test(now),
                None => self.begin(now, sink),
            }
        }
    }

    /// The plan's change that falls due in cycle `now`, or the tick's end.
    fn follow(&mut self, running: Running, now: Instant, sink: &mut impl Sink) {
        match self.plan.changes().get(running.next) {
            Some(change) if running.c0 + Cycles(change.offset) == now => {
                self.lines = change.lines;
                self.go_on(Running { next: running.next + 1, ..running });
            }
            _ => self.end(now, sink),
        }
    }

    /// The self-test's change that falls due in cycle `now`.
    fn follow_test(&mut self, now: Instant) {
        if let Some(Change { lines, .. }) = self.self_test.pop() {
            let rising = lines & !self.lines & STEPS;
            for (channel, position) in self.positions.iter_mut().enumerate() {
                if rising >> channel & 1 != 0 {
                    let right = lines >> Levels::DIR_SHIFT >> channel & 1 != 0;
                    *position = position.wrapping_add(if right { 1 } else { -1 });
                }
            }
            self.lines = lines;
        }
        self.last_active = now;
        self.deadline = self.self_test.last().map_or(Instant::NEVER, |next| Instant(next.offset));
    }

    fn go_on(&mut self, running: Running) {
        let change = self.plan.changes().get(running.next);
        self.deadline =
            change.map_or(running.end, |change| running.c0 + Cycles(change.offset)).min(running.end);
        self.running = Some(running);
    }

    fn halt(&mut self, now: Instant) {
        self.halt = false;
        self.lines &= !STEPS;
        self.last_active = now;
        self.deadline = if self.queue.is_empty() { Instant::NEVER } else { now };
    }

    fn end(&mut self, now: Instant, sink: &mut impl Sink) {
        sink.event(now, Event::TickEnd);
        self.last_active = now;
        let commands = self.plan.commands();
        count(&mut self.positions, commands, |channel| {
            commands.get(channel).map_or(0, |&byte| u32::from(ChannelCommand::parse(byte).steps))
        });
        self.ticks_done = self.ticks_done.wrapping_add(1);
        self.running = None;
        self.deadline = if self.queue.is_empty() { Instant::NEVER } else { now };
        if self.framed && self.queue.is_empty() && self.plan.has_steps() {
            self.faults.set(Faults::UNDERRUN);
            sink.event(now, Event::Underrun);
        }
    }

    fn begin(&mut self, now: Instant, sink: &mut impl Sink) {
        self.deadline = Instant::NEVER;
        if let Some(tick) = self.queue.pop_front() {
            sink.event(now, Event::TickStart { orders: tick });
            self.plan.set(tick);
            self.go_on(Running { c0: now, end: now + self.tick, next: 0 });
        }
    }

    /// Runs alone through the cycles before `until`, while nothing else changes: `base` are the
    /// other signals. Stops after the tick in which the sink asks for a pause. Gives the levels.
    #[inline(never)]
    pub(super) fn run(&mut self, until: Instant, base: u64, sink: &mut impl Sink) -> Levels {
        while self.deadline < until && !sink.paused() {
            self.run_pulses(until, base, sink);
            let now = self.deadline;
            if now < until {
                let lines = self.lines;
                self.clock(now, sink);
                if self.lines != lines {
                    sink.record(Record { cycle: now, levels: Levels(base | u64::from(self.lines)) });
                }
            }
        }
        Levels(base | u64::from(self.lines))
    }

    /// Whether nothing falls due before `until` but changes of the tick that runs.
    #[inline(always)]
    pub(super) fn only_pulses(&self, until: Instant) -> bool {
        self.running.map_or(self.deadline, |running| running.end) >= until
    }

    /// [`Self::run`] before `until`, where only changes of the tick that runs fall due, beside the edges of a byte: of
    /// [`ByteAhead`](crate::wire::ByteAhead) what they need, as a struct would go by way of the memory in wasm. Copied into its
    /// caller it is 5 % slower in the page, and 7 % faster natively.
    #[inline(never)]
    pub(super) fn run_beside(
        &mut self,
        start: Instant,
        edges: u32,
        bit_starts: &BitStarts,
        until: Instant,
        base: u64,
        sink: &mut impl Sink,
    ) -> Levels {
        debug_assert!(self.only_pulses(until), "a tick begins or ends beside a byte");
        let (c0, first) =
            self.running.map_or((Instant::NEVER, usize::MAX), |running| (running.c0, running.next));
        let mut changes = self.plan.changes().get(first..).unwrap_or_default().iter();
        let change_of = |changes: &Iter<'_, Change>| {
            changes.as_slice().first().map_or(Instant::NEVER, |change| c0 + Cycles(change.offset))
        };
        let edge_of = |edges: u32| start + Cycles(bit_starts[edges.trailing_zeros() as usize & NO_BIT]);
        let (mut lines, mut rx, mut edges) = (self.lines, base, edges | 1 << NO_BIT);
        // The first may be none, after the tick before it.
        if changes.as_slice().first().is_some_and(|first| first.lines == lines) {
            changes.next();
        }
        // From edge to edge, the changes before it first.
        loop {
            let edge = edge_of(edges);
            let limit = edge.min(until);
            while change_of(&changes) < limit
                && let Some(passed) = changes.next()
            {
                lines = passed.lines;
                sink.record(Record {
                    cycle: c0 + Cycles(passed.offset),
                    levels: Levels(rx | u64::from(lines)),
                });
            }
            if edge >= until {
                break;
            }
            if change_of(&changes) == edge
                && let Some(passed) = changes.next()
            {
                lines = passed.lines;
            }
            rx ^= Levels::RX;
            edges &= edges - 1;
            sink.record(Record { cycle: edge, levels: Levels(rx | u64::from(lines)) });
        }
        self.lines = lines;
        if let Some(running) = &mut self.running {
            running.next = self.plan.changes().len() - changes.len();
            self.deadline = change_of(&changes).min(running.end);
        }
        Levels(rx | u64::from(lines))
    }

    /// The changes of the tick that runs, one after another: the inner loop of a long run.
    fn run_pulses(&mut self, until: Instant, base: u64, sink: &mut impl Sink) {
        let Some(running) = &mut self.running else { return };
        let (stop, c0) = (until.min(running.end), running.c0);
        let left = self.plan.changes().get(running.next..).unwrap_or_default();
        let due = left.partition_point(|change| c0 + Cycles(change.offset) < stop);
        let (passed, left) = left.split_at(due);
        self.deadline = left.first().map_or(running.end, |next| (c0 + Cycles(next.offset)).min(running.end));
        running.next += due;
        let Some(last) = passed.last() else { return };
        // The first may be none, after the tick before it.
        let repeats = usize::from(passed.first().is_some_and(|first| first.lines == self.lines));
        self.lines = last.lines;
        let records = passed.get(repeats..).unwrap_or_default().iter();
        sink.record_all(records.map(|change| Record {
            cycle: c0 + Cycles(change.offset),
            levels: Levels(base | u64::from(change.lines)),
        }));
    }
}

/// Adds `steps` of each channel in its direction.
fn count(positions: &mut [i32; MAX_CHANNELS], commands: &Tick, steps: impl Fn(usize) -> u32) {
    for (channel, (position, command)) in positions.iter_mut().zip(commands).enumerate() {
        let steps = steps(channel) as i32;
        let change = if ChannelCommand::parse(*command).right { steps } else { -steps };
        *position = position.wrapping_add(change);
    }
}
