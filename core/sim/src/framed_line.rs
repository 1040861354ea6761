//! Controllers that answer, and their host, on one line (DESIGN A6, A9).
//!
//! A controller hears the AND of what the host and all other controllers send, and 1 while it sends
//! itself; the host hears the controllers while it is not sending. A level that is forced is heard by
//! all of them.
//!
//! The run goes from window to window. In a window nobody changes what he does to the line, so each
//! controller runs through it alone, as fast as its own edges allow. A window ends where the host or
//! a forced level changes, where a controller may begin or go on to drive, or where the host acts.
//!
//! Bytes of the host that nothing disturbs are passed without windows, by all controllers at once, where none of them drives
//! or begins to before the byte's end, and the host does nothing but send it. What a window would note meanwhile, who drives, hears and
//! collides, is noted anew at the start of the next one.

use crate::framed_host::FramedHost;
use crate::ignored::Ignored;
use alloc::vec::Vec;
use stepscope_peripheral::{
    device::Device,
    signal::{Event, Sink},
    units::Instant,
    wire::Line,
};

/// A framed line with all that is on it.
#[derive(Clone, Debug)]
pub(super) struct FramedLine {
    line: Line,
    host: Option<FramedHost>,
    nodes: Vec<Node>,
    /// The window that is run: its first cycle and the first one after it.
    ///
    /// Invariant: `start <= until`; both only rise.
    start: Instant,
    until: Instant,
    /// Whether bytes are heard as they are sent.
    in_step: bool,
}

/// A controller and what it hears of the others.
#[derive(Clone, Debug)]
struct Node {
    device: Device,
    /// What it does to the line in the window's first cycle, `None` where it does nothing, and what it hears then.
    drives: Option<bool>,
    hears: bool,
    collides: bool,
}

impl Node {
    /// Whether it has not come to the end of the window, and has something to do there.
    fn is_behind(&self, until: Instant) -> bool {
        self.device.now() < until && !(until == Instant::NEVER && self.device.at_rest())
    }
}

impl FramedLine {
    pub(super) fn new(line: Line, host: Option<FramedHost>, devices: Vec<Device>) -> Self {
        let in_step = devices.iter().all(|device| device.is_in_step(line.bit_starts()));
        let node = |device| Node { device, drives: None, hears: true, collides: false };
        Self {
            line,
            host,
            nodes: devices.into_iter().map(node).collect(),
            start: Instant::RESET,
            until: Instant::RESET,
            in_step,
        }
    }

    pub(super) const fn line(&self) -> &Line {
        &self.line
    }

    pub(super) const fn line_mut(&mut self) -> &mut Line {
        &mut self.line
    }

    pub(super) const fn host(&self) -> Option<&FramedHost> {
        self.host.as_ref()
    }

    pub(super) fn first(&self) -> &Device {
        // There is one at least.
        &self.nodes[0].device
    }

    pub(super) fn device(&self, index: usize) -> Option<&Device> {
        self.nodes.get(index).map(|node| &node.device)
    }

    #[cfg(feature = "plant")]
    pub(super) fn device_mut(&mut self, index: usize) -> Option<&mut Device> {
        self.nodes.get_mut(index).map(|node| &mut node.device)
    }

    /// Whether nothing can change any more.
    pub(super) fn is_over(&self) -> bool {
        self.host.as_ref().is_none_or(FramedHost::is_over)
            && self.nodes.iter().all(|node| node.device.at_rest())
            && self.line.is_over()
    }

    /// Whether all have run the cycles before `end`.
    pub(super) fn has_reached(&self, end: Instant) -> bool {
        self.start >= end
    }

    /// Enters cycle `self.start`: what each hears in it, and what the host does.
    fn enter(&mut self, sinks: &mut [impl Sink]) {
        let Self { line, host, nodes, start, .. } = self;
        let now = *start;
        // Several where all rested meanwhile, and nobody heard them.
        while line.next_change() <= now {
            line.change();
        }
        let host_sends = match host {
            Some(host) => host.is_sending(now),
            None => line.is_pulled_low(),
        };
        let (mut low, mut driving) = (0, 0);
        for node in nodes.iter_mut() {
            node.drives = node.device.driven();
            low += u32::from(node.drives == Some(false));
            driving += u32::from(node.drives.is_some());
        }
        for (index, node) in nodes.iter_mut().enumerate() {
            let others_low = low - u32::from(node.drives == Some(false));
            node.hears = line.heard(others_low == 0);
            let met = node.drives.is_some() && (host_sends || driving > 1);
            collide(node, met, now, sinks.get_mut(index));
        }
        if let Some(host) = host {
            let level = host.is_sending(now) || line.replied(low == 0);
            host.clock(now, level, line);
        }
    }

    /// First cycle after the window that begins at `self.start`, at most `end`.
    fn window(&mut self, end: Instant) -> Instant {
        let driven = |node: &mut Node| node.device.next_driven(node.hears);
        let driven = self.nodes.iter_mut().map(driven).fold(Instant::NEVER, Instant::min);
        let host = self.host.as_ref().map_or(Instant::NEVER, |host| host.deadline(self.start));
        let others = driven.min(host);
        // While nobody answers, what is forced to the level that the line has is not heard.
        let over = others == Instant::NEVER && self.line.is_over();
        let line = if over { Instant::NEVER } else { self.line.next_change() };
        line.min(others).min(end)
    }

    /// Runs to cycle `end`, or with [`Instant::NEVER`] until nothing can change any more, or until a
    /// sink asks for a pause.
    pub(super) fn run(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        while self.until < end || self.start < self.until {
            if !(self.run_bytes(end, sinks) || self.run_window(end, sinks)) {
                return;
            }
        }
    }

    /// Runs through bytes that all controllers pass whole, while nobody drives the line and the host does nothing else: whether there
    /// was any.
    fn run_bytes(&mut self, end: Instant, sinks: &mut [impl Sink]) -> bool {
        let Self { line, host, nodes, start, until, in_step } = self;
        if start != until || !*in_step {
            return false;
        }
        let end = host.as_ref().map_or(end, |host| host.deadline(*start).min(end));
        let [others @ .., last] = nodes.as_mut_slice() else { return false };
        let (other_sinks, last_sink) = sinks.split_at_mut(others.len().min(sinks.len()));
        // Where there are several, one byte that all of them pass.
        let Some(byte) = line.byte_ahead() else { return false };
        let Some(stop) = last.device.whole_byte(&byte, end) else { return false };
        let all = others.iter().all(|node| node.device.whole_byte(&byte, end) == Some(stop));
        if !all || other_sinks.iter().any(Sink::paused) || last_sink.first().is_some_and(Sink::paused) {
            return false;
        }
        let end = if others.is_empty() { end } else { stop.next() };
        for (index, node) in others.iter_mut().enumerate() {
            let line = &mut line.clone();
            match other_sinks.get_mut(index) {
                Some(sink) => node.device.run_bytes(line, end, sink),
                None => node.device.run_bytes(line, end, &mut Ignored),
            };
        }
        match last_sink.first_mut() {
            Some(sink) => last.device.run_bytes(line, end, sink),
            None => last.device.run_bytes(line, end, &mut Ignored),
        };
        (*start, *until) = (last.device.now(), last.device.now());
        debug_assert!(nodes.iter().all(|node| node.device.now() == *start), "a controller stayed behind");
        true
    }

    /// Runs to the end of a window, which may have begun; false where a sink asked for a pause.
    fn run_window(&mut self, end: Instant, sinks: &mut [impl Sink]) -> bool {
        if self.start == self.until {
            self.enter(sinks);
            self.until = self.window(end);
            debug_assert!(self.start < self.until, "something was left out before {:?}", self.start);
        }
        for (index, node) in self.nodes.iter_mut().enumerate() {
            let Node { device, hears, .. } = node;
            match sinks.get_mut(index) {
                Some(sink) => device.run(*hears, self.until, sink),
                None => device.run(*hears, self.until, &mut Ignored),
            }
        }
        let behind = self.nodes.iter().any(|node| node.is_behind(self.until));
        if !behind {
            self.start = self.until;
        }
        !behind
    }

    /// The last cycle in which something happened.
    pub(super) fn last_active(&self) -> Instant {
        let device = self.nodes.iter().map(|node| node.device.last_active()).max();
        let host = self.host.as_ref().map(FramedHost::last_active);
        device.max(host).unwrap_or(Instant::RESET)
    }

    /// At rest: cycle `now` is the first that has not been run.
    pub(super) fn finish(&mut self, now: Instant) {
        self.nodes.iter_mut().for_each(|node| node.device.finish(now));
        (self.start, self.until) = (now, Instant::NEVER);
    }

    /// One cycle.
    pub(super) fn clock(&mut self, sinks: &mut [impl Sink]) {
        self.enter(sinks);
        for (index, node) in self.nodes.iter_mut().enumerate() {
            let Node { device, hears, .. } = node;
            match sinks.get_mut(index) {
                Some(sink) => device.clock(*hears, sink),
                None => device.clock(*hears, &mut Ignored),
            };
        }
        self.start = self.start.next();
        self.until = self.start;
    }
}

/// Tells of a collision where it begins.
fn collide(node: &mut Node, collides: bool, now: Instant, sink: Option<&mut impl Sink>) {
    if collides
        && !node.collides
        && let Some(sink) = sink
    {
        sink.event(now, Event::Collision);
    }
    node.collides = collides;
}
