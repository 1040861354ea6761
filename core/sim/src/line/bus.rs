//! The controllers and the host of a line (DESIGN A6, A9).
//!
//! A controller receives the AND of what the host and all other controllers send, and 1 while it sends; the host receives
//! the controllers while it is not sending. All receive a forced level.
//!
//! A run is a sequence of windows in which no sender changes its level, so that each controller can run separately. A window
//! ends where a level of the line changes or may change, and where the host has an event.

use crate::hosts::framed_host::FramedHost;
use alloc::vec::Vec;
use stepscope_peripheral::signal::{Event, Sink};
use stepscope_peripheral::{device::Device, units::Instant, wire::Line};

#[derive(Clone, Debug)]
pub(crate) struct Bus {
    line: Line,
    host: Option<FramedHost>,
    /// Invariant: at least one.
    nodes: Vec<Node>,
    /// The current window: its first cycle and the first one after it. Invariant: `start <= until`; both only rise.
    start: Instant,
    until: Instant,
}

/// A controller and the level that it receives.
#[derive(Clone, Debug)]
struct Node {
    device: Device,
    /// TX in the window's first cycle; `None` while it does not drive.
    drives: Option<bool>,
    received_level: bool,
    collides: bool,
}

impl Bus {
    pub(crate) fn new(line: Line, host: Option<FramedHost>, devices: Vec<Device>) -> Self {
        debug_assert!(!devices.is_empty(), "a line without a controller");
        let node = |device| Node { device, drives: None, received_level: true, collides: false };
        let nodes = devices.into_iter().map(node).collect();
        Self { line, host, nodes, start: Instant::RESET, until: Instant::RESET }
    }

    pub(crate) const fn line(&self) -> &Line {
        &self.line
    }

    pub(crate) const fn line_mut(&mut self) -> &mut Line {
        &mut self.line
    }

    pub(crate) const fn host(&self) -> Option<&FramedHost> {
        self.host.as_ref()
    }

    pub(crate) fn first(&self) -> &Device {
        &self.nodes[0].device
    }

    pub(crate) fn devices(&self) -> impl Iterator<Item = &Device> {
        self.nodes.iter().map(|node| &node.device)
    }

    pub(crate) fn device_mut(&mut self, index: usize) -> Option<&mut Device> {
        self.nodes.get_mut(index).map(|node| &mut node.device)
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.host.as_ref().is_none_or(|host| host.conversation().is_over())
            && self.devices().all(Device::is_idle)
            && self.line.is_over()
    }

    pub(crate) fn has_reached(&self, end: Instant) -> bool {
        self.start >= end
    }

    pub(crate) fn now(&self) -> Instant {
        self.devices().map(Device::now).max().unwrap_or(Instant::RESET)
    }

    /// The cycle after the last event.
    pub(crate) fn idle_since(&self) -> Instant {
        let device = self.devices().map(Device::last_active).max();
        let host = self.host.as_ref().map(FramedHost::last_active);
        device.max(host).unwrap_or(Instant::RESET).next()
    }

    /// Begins cycle `self.start`: updates the levels that the controllers receive, and runs the host.
    fn enter(&mut self, sinks: &mut [impl Sink]) {
        let Self { line, host, nodes, start, .. } = self;
        let now = *start;
        // After an idle time, several changes may have passed.
        while line.next_change() <= now {
            line.change();
        }
        let host_sends = host.as_ref().map_or(line.is_pulled_low(), |host| host.is_sending(now));
        let (mut low, mut driving) = (0, 0);
        for node in nodes.iter_mut() {
            node.drives = node.device.driven();
            low += u32::from(node.drives == Some(false));
            driving += u32::from(node.drives.is_some());
        }
        for (index, node) in nodes.iter_mut().enumerate() {
            let others_low = low - u32::from(node.drives == Some(false));
            node.received_level = line.level(others_low == 0);
            let collides = node.drives.is_some() && (host_sends || driving > 1);
            if collides && !node.collides {
                sinks.get_mut(index).event(now, Event::Collision);
            }
            node.collides = collides;
        }
        if let Some(host) = host {
            let level = host.is_sending(now) || line.host_level(low == 0);
            host.clock(now, level, line);
        }
    }

    /// The end of the window that begins in `self.start`.
    fn window(&self, end: Instant) -> Instant {
        let driven = self.nodes.iter().map(|node| node.device.next_driven(node.received_level));
        let host = self.host.as_ref().map_or(Instant::NEVER, |host| host.deadline(self.start));
        driven.fold(self.line.next_change().min(host).min(end), Instant::min)
    }

    /// Runs to cycle `end`, or with [`Instant::NEVER`] until no event follows. Stops early when a sink pauses.
    pub(crate) fn run(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        while self.start < end {
            if self.start == self.until {
                self.enter(sinks);
                self.until = self.window(end);
                debug_assert!(self.start < self.until, "an event before {:?} was skipped", self.start);
            }
            for (index, node) in self.nodes.iter_mut().enumerate() {
                node.device.run(node.received_level, self.until, &mut sinks.get_mut(index));
            }
            let is_behind = |device: &Device| {
                device.now() < self.until && !(self.until == Instant::NEVER && device.is_idle())
            };
            if self.devices().any(is_behind) {
                break;
            }
            self.start = self.until;
        }
        if end == Instant::NEVER && self.is_idle() {
            let now = self.idle_since();
            self.nodes.iter_mut().for_each(|node| node.device.finish(now));
            (self.start, self.until) = (now, Instant::NEVER);
        }
    }

    pub(crate) fn clock(&mut self, sinks: &mut [impl Sink]) {
        self.enter(sinks);
        for (index, node) in self.nodes.iter_mut().enumerate() {
            node.device.clock(node.received_level, &mut sinks.get_mut(index));
        }
        self.start = self.start.next();
        self.until = self.start;
    }
}
