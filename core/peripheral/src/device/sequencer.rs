//! The queue and the tick sequencer (DESIGN A7).
//!
//! The tick at the head of the queue starts at c0 = max(p + 1, e), where p is its commit cycle and e the end of the tick
//! before. It leaves the queue at c0 and ends at e = c0 + M*Ts, where ticks_done counts. With the queue empty at e, the
//! sequencer is idle: STEP = 0, DIR keeps its level.

use crate::config::{Config, Protocol};
use crate::device::Faults;
use crate::device::plan::{Change, Lines, Plan, STEPS};
use crate::signal::{Event, Levels, MAX_CHANNELS, Sink};
use crate::units::{Cycles, Instant};
use crate::wire::packet::Tick;
use alloc::{collections::VecDeque, vec::Vec};

#[derive(Clone, Debug)]
pub(super) struct Sequencer {
    tick: Cycles,
    depth: usize,
    /// Invariant: at most `depth` ticks.
    queue: VecDeque<Tick>,
    plan: Plan,
    running: Option<Running>,
    /// Remaining changes of a self-test, the next one last.
    /// Invariant: no tick runs until it is empty, because the self-test ends with the boot.
    self_test: Vec<Change>,
    /// STOP came in the last cycle, so STEP falls in this one.
    halts: bool,
    /// On a framed line an underrun is a fault.
    is_framed: bool,
    faults: Faults,
    /// Next cycle in which the sequencer acts; [`Instant::NEVER`] when idle.
    /// Invariant: no later cycle is clocked.
    deadline: Instant,
    lines: Lines,
    positions: [i32; MAX_CHANNELS],
    ticks_done: u32,
}

#[derive(Clone, Copy, Debug)]
struct Running {
    start: Instant,
    end: Instant,
    /// Index of the next change of the plan.
    next: usize,
}

impl Sequencer {
    pub(super) fn new(config: &Config) -> Self {
        Self {
            tick: config.tick(),
            depth: usize::from(config.queue_depth()),
            queue: VecDeque::with_capacity(usize::from(config.queue_depth())),
            plan: Plan::new(config),
            running: None,
            self_test: Vec::new(),
            halts: false,
            is_framed: config.protocol() == Protocol::Framed,
            faults: Faults::default(),
            deadline: Instant::NEVER,
            lines: 0,
            positions: [0; MAX_CHANNELS],
            ticks_done: 0,
        }
    }

    /// Plays these changes during boot; their offsets count from reset.
    pub(super) fn start_self_test(&mut self, mut changes: Vec<Change>) {
        changes.reverse();
        self.deadline = changes.last().map_or(Instant::NEVER, |first| Instant(first.offset));
        self.self_test = changes;
    }

    pub(super) const fn lines(&self) -> Lines {
        self.lines
    }

    pub(super) const fn ticks_done(&self) -> u32 {
        self.ticks_done
    }

    pub(super) const fn positions(&self) -> &[i32; MAX_CHANNELS] {
        &self.positions
    }

    /// Queues a tick committed in cycle `now`; the caller has checked that there is room.
    pub(super) fn push(&mut self, now: Instant, tick: Tick) {
        debug_assert!(self.queue.len() < self.depth, "no room for a tick that was admitted");
        if !self.is_moving() {
            self.deadline = now.next();
        }
        self.queue.push_back(tick);
    }

    pub(super) const fn faults(&self) -> Faults {
        self.faults
    }

    pub(super) const fn clear_faults(&mut self, which: Faults) {
        self.faults.clear(which);
    }

    /// Changes the timing; the caller has checked that no tick runs or waits.
    pub(super) fn retime(&mut self, config: &Config) {
        debug_assert!(!self.is_moving(), "the timing changes while a tick runs or waits");
        self.tick = config.tick();
        self.plan = Plan::new(config);
    }

    pub(super) fn is_moving(&self) -> bool {
        self.running.is_some() || !self.queue.is_empty()
    }

    pub(super) fn free(&self) -> u8 {
        (self.depth - self.queue.len()) as u8
    }

    /// Drops all ticks: STEP falls in the cycle after `now`, DIR keeps its level.
    pub(super) fn stop(&mut self, now: Instant) {
        self.running = None;
        self.queue.clear();
        self.self_test.clear();
        self.halts = true;
        self.deadline = now.next();
    }

    pub(super) const fn deadline(&self) -> Instant {
        self.deadline
    }

    pub(super) fn clock(&mut self, now: Instant, sink: &mut impl Sink) {
        debug_assert!(now <= self.deadline, "{:?} was skipped", self.deadline);
        debug_assert!(self.queue.len() <= self.depth, "more ticks wait than the queue holds");
        while self.deadline == now {
            match self.running {
                Some(running) => self.apply_change(running, now, sink),
                None if self.halts => self.halt(now),
                None if !self.self_test.is_empty() => self.apply_test_change(),
                None => self.start_tick(now, sink),
            }
        }
    }

    /// Applies the change of the plan due in cycle `now`, or ends the tick.
    fn apply_change(&mut self, running: Running, now: Instant, sink: &mut impl Sink) {
        match self.plan.changes().get(running.next) {
            Some(change) if running.start + Cycles(change.offset) == now => {
                self.set_lines(change.lines);
                self.schedule_change(Running { next: running.next + 1, ..running });
            }
            _ => self.end_tick(now, sink),
        }
    }

    fn apply_test_change(&mut self) {
        if let Some(change) = self.self_test.pop() {
            self.set_lines(change.lines);
        }
        self.deadline = self.self_test.last().map_or(Instant::NEVER, |next| Instant(next.offset));
    }

    /// Sets STEP and DIR, and counts rising edges of STEP.
    fn set_lines(&mut self, lines: Lines) {
        let mut rising = lines & !self.lines & STEPS;
        while rising != 0 {
            let channel = rising.trailing_zeros();
            let right = lines >> Levels::DIR_SHIFT >> channel & 1 != 0;
            let position = &mut self.positions[channel as usize];
            *position = position.wrapping_add(if right { 1 } else { -1 });
            rising &= rising - 1;
        }
        self.lines = lines;
    }

    fn schedule_change(&mut self, running: Running) {
        let change = self.plan.changes().get(running.next);
        self.deadline =
            change.map_or(running.end, |change| running.start + Cycles(change.offset)).min(running.end);
        self.running = Some(running);
    }

    fn halt(&mut self, now: Instant) {
        self.halts = false;
        self.lines &= !STEPS;
        self.schedule_tick(now);
    }

    fn schedule_tick(&mut self, now: Instant) {
        self.deadline = if self.queue.is_empty() { Instant::NEVER } else { now };
    }

    fn end_tick(&mut self, now: Instant, sink: &mut impl Sink) {
        sink.event(now, Event::TickEnd);
        self.ticks_done = self.ticks_done.wrapping_add(1);
        self.running = None;
        self.schedule_tick(now);
        if self.is_framed && self.queue.is_empty() && self.plan.has_steps() {
            self.faults.set(Faults::UNDERRUN);
            sink.event(now, Event::Underrun);
        }
    }

    fn start_tick(&mut self, now: Instant, sink: &mut impl Sink) {
        self.deadline = Instant::NEVER;
        if let Some(tick) = self.queue.pop_front() {
            sink.event(now, Event::TickStart { commands: tick });
            self.plan.set(tick);
            self.schedule_change(Running { start: now, end: now + self.tick, next: 0 });
        }
    }
}
