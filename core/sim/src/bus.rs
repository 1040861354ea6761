//! All controllers of a line and what is done to it (DESIGN A9): those of a raw line listen, each by
//! itself; those of a framed line with each other and the host.

use crate::framed_host::FramedHost;
use crate::{framed_line::FramedLine, ignored::Ignored, raw_receiver::RawReceiver};
use alloc::{boxed::Box, vec::Vec};
use stepscope_peripheral::{device::Device, signal::Sink, units::Instant, wire::Line};

/// A line with all that is on it.
#[derive(Clone, Debug)]
pub(super) enum Bus {
    /// Nobody answers. There is one controller at least, as in `Framed`.
    Raw(Vec<RawReceiver>),
    /// Controllers answer, and a host may wait for them.
    Framed(Box<FramedLine>),
}

impl Bus {
    pub(super) fn new(line: Line, host: Option<FramedHost>, devices: Vec<Device>) -> Self {
        debug_assert!(!devices.is_empty(), "a line without a controller");
        if host.is_some() || devices.iter().any(Device::answers) {
            return Self::Framed(Box::new(FramedLine::new(line, host, devices)));
        }
        Self::Raw(devices.into_iter().map(|device| RawReceiver::new(line.clone(), device)).collect())
    }

    pub(super) fn line(&self) -> &Line {
        match self {
            Self::Raw(receivers) => receivers[0].line(),
            Self::Framed(line) => line.line(),
        }
    }

    pub(super) const fn host(&self) -> Option<&FramedHost> {
        match self {
            Self::Raw(_) => None,
            Self::Framed(line) => line.host(),
        }
    }

    pub(super) fn first(&self) -> &Device {
        match self {
            Self::Raw(receivers) => receivers[0].device(),
            Self::Framed(line) => line.first(),
        }
    }

    pub(super) fn device(&self, index: usize) -> Option<&Device> {
        match self {
            Self::Raw(receivers) => receivers.get(index).map(RawReceiver::device),
            Self::Framed(line) => line.device(index),
        }
    }

    pub(super) fn devices(&self) -> impl Iterator<Item = &Device> {
        (0..).map_while(|index| self.device(index))
    }

    /// Whether nothing can change any more.
    #[inline]
    pub(super) fn is_over(&self) -> bool {
        match self {
            Self::Raw(receivers) => receivers.iter().all(RawReceiver::is_over),
            Self::Framed(line) => line.is_over(),
        }
    }

    /// Whether all have run the cycles before `end`.
    pub(super) fn has_reached(&self, end: Instant) -> bool {
        match self {
            Self::Raw(receivers) => receivers.iter().all(|receiver| receiver.has_reached(end)),
            Self::Framed(line) => line.has_reached(end),
        }
    }

    /// One of the controllers.
    #[cfg(feature = "plant")]
    pub(super) fn device_mut(&mut self, index: usize) -> Option<&mut Device> {
        match self {
            Self::Raw(receivers) => receivers.get_mut(index).map(RawReceiver::device_mut),
            Self::Framed(line) => line.device_mut(index),
        }
    }

    /// Where a run without an end of its own would end, were nothing to happen any more.
    #[cfg(feature = "plant")]
    pub(super) fn rests_from(&self) -> Instant {
        let last = match self {
            Self::Raw(receivers) => receivers.iter().map(RawReceiver::last_active).max(),
            Self::Framed(line) => Some(line.last_active()),
        };
        last.unwrap_or(Instant::RESET).next()
    }

    /// First cycle that nobody has run.
    pub(super) fn now(&self) -> Instant {
        self.devices().map(Device::now).max().unwrap_or(Instant::RESET)
    }

    /// Every line of the controllers: raw ones have one each, with the same on it.
    fn each_line(&mut self, mut change: impl FnMut(&mut Line)) {
        match self {
            Self::Raw(receivers) => receivers.iter_mut().for_each(|receiver| change(receiver.line_mut())),
            Self::Framed(line) => change(line.line_mut()),
        }
    }

    /// Adds a send, from a cycle on that nobody has run.
    pub(super) fn send(&mut self, start: Instant, bytes: &[u8]) {
        self.each_line(|line| line.send(start, bytes));
    }

    /// Adds bytes to the last send; the first of them begins in a cycle that nobody has run.
    pub(super) fn extend(&mut self, bytes: &[u8]) {
        self.each_line(|line| line.extend(bytes));
    }

    /// Forgets what has been sent.
    pub(super) fn forget_sent(&mut self) {
        self.each_line(Line::forget_sent);
    }

    /// Runs to cycle `end`, or with [`Instant::NEVER`] until nothing can change any more, or until a
    /// sink asks for a pause.
    pub(super) fn run(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        match self {
            Self::Raw(receivers) => {
                for (index, receiver) in receivers.iter_mut().enumerate() {
                    match sinks.get_mut(index) {
                        Some(sink) => receiver.run(end, sink),
                        None => receiver.run(end, &mut Ignored),
                    }
                }
            }
            Self::Framed(line) => line.run(end, sinks),
        }
        if end == Instant::NEVER && self.is_over() {
            self.finish();
        }
    }

    /// At rest: the last cycle that was run is the last one in which something happened.
    fn finish(&mut self) {
        match self {
            Self::Raw(receivers) => {
                let last = receivers.iter().map(RawReceiver::last_active).max();
                let now = last.unwrap_or(Instant::RESET).next();
                receivers.iter_mut().for_each(|receiver| receiver.finish(now));
            }
            Self::Framed(line) => {
                let now = line.last_active().next();
                line.finish(now);
            }
        }
    }

    /// One cycle.
    pub(super) fn clock(&mut self, sinks: &mut [impl Sink]) {
        match self {
            Self::Raw(receivers) => {
                for (index, receiver) in receivers.iter_mut().enumerate() {
                    match sinks.get_mut(index) {
                        Some(sink) => receiver.clock(sink),
                        None => receiver.clock(&mut Ignored),
                    }
                }
            }
            Self::Framed(line) => line.clock(sinks),
        }
    }
}
