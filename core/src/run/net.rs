//! All controllers of a line and what is done to it (DESIGN A9): those of a raw line listen, each by
//! itself; those of a framed line talk with each other and the host.

use super::{listener::Listener, talk::Talk};
use crate::{
    device::Device,
    signal::{Record, Sink},
    units::Instant,
    wire::{Line, framed_host::FramedHost},
};
use alloc::{boxed::Box, vec::Vec};

/// A line with all that is on it.
#[derive(Clone, Debug)]
pub(super) enum Net {
    /// Nobody answers. There is one controller at least, as in `Framed`.
    Raw(Vec<Listener>),
    /// Controllers answer, and a host may wait for them.
    Framed(Box<Talk>),
}

/// Takes what no one asked for.
pub(super) struct Ignored;

impl Sink for Ignored {
    #[inline]
    fn record(&mut self, _: Record) {}
}

impl Net {
    #[inline]
    pub(super) fn new(line: Line, host: Option<FramedHost>, devices: Vec<Device>) -> Self {
        if host.is_some() || devices.iter().any(Device::answers) {
            return Self::Framed(Box::new(Talk::new(line, host, devices)));
        }
        Self::Raw(devices.into_iter().map(|device| Listener::new(line.clone(), device)).collect())
    }

    #[inline]
    pub(super) fn line(&self) -> &Line {
        match self {
            Self::Raw(listeners) => listeners[0].line(),
            Self::Framed(talk) => talk.line(),
        }
    }

    #[inline]
    pub(super) const fn host(&self) -> Option<&FramedHost> {
        match self {
            Self::Raw(_) => None,
            Self::Framed(talk) => talk.host(),
        }
    }

    #[inline]
    pub(super) fn first(&self) -> &Device {
        match self {
            Self::Raw(listeners) => listeners[0].device(),
            Self::Framed(talk) => talk.first(),
        }
    }

    #[inline]
    pub(super) fn device(&self, index: usize) -> Option<&Device> {
        match self {
            Self::Raw(listeners) => listeners.get(index).map(Listener::device),
            Self::Framed(talk) => talk.device(index),
        }
    }

    #[inline]
    pub(super) fn devices(&self) -> impl Iterator<Item = &Device> {
        (0..).map_while(|index| self.device(index))
    }

    /// Whether nothing can change any more.
    #[inline]
    pub(super) fn is_over(&self) -> bool {
        match self {
            Self::Raw(listeners) => listeners.iter().all(Listener::is_over),
            Self::Framed(talk) => talk.is_over(),
        }
    }

    /// Whether all have run the cycles before `end`.
    #[inline]
    pub(super) fn has_reached(&self, end: Instant) -> bool {
        match self {
            Self::Raw(listeners) => listeners.iter().all(|listener| listener.has_reached(end)),
            Self::Framed(talk) => talk.has_reached(end),
        }
    }

    /// First cycle that nobody has run.
    #[inline]
    pub(super) fn now(&self) -> Instant {
        self.devices().map(Device::now).max().unwrap_or(Instant::RESET)
    }

    /// Runs to cycle `end`, or with [`Instant::NEVER`] until nothing can change any more, or until a
    /// sink asks for a pause.
    #[inline]
    pub(super) fn run(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        match self {
            Self::Raw(listeners) => {
                for (index, listener) in listeners.iter_mut().enumerate() {
                    match sinks.get_mut(index) {
                        Some(sink) => listener.run(end, sink),
                        None => listener.run(end, &mut Ignored),
                    }
                }
            }
            Self::Framed(talk) => talk.run(end, sinks),
        }
        if end == Instant::NEVER && self.is_over() {
            self.settle();
        }
    }

    /// At rest: the last cycle that was run is the last one in which something happened.
    #[inline]
    fn settle(&mut self) {
        match self {
            Self::Raw(listeners) => {
                let last = listeners.iter().map(Listener::last_active).max();
                let now = last.unwrap_or(Instant::RESET).next();
                listeners.iter_mut().for_each(|listener| listener.settle(now));
            }
            Self::Framed(talk) => {
                let now = talk.last_active().next();
                talk.settle(now);
            }
        }
    }

    /// One cycle.
    #[inline]
    pub(super) fn clock(&mut self, sinks: &mut [impl Sink]) {
        match self {
            Self::Raw(listeners) => {
                for (index, listener) in listeners.iter_mut().enumerate() {
                    match sinks.get_mut(index) {
                        Some(sink) => listener.clock(sink),
                        None => listener.clock(&mut Ignored),
                    }
                }
            }
            Self::Framed(talk) => talk.clock(sinks),
        }
    }
}
