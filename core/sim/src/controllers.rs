//! The edge generators of a run: controllers on a serial line, lists of segments, or controllers without a line.

use crate::line::bus::Bus;
use alloc::boxed::Box;
use stepscope_controller::StandAlone;
use stepscope_peripheral::device::{Faults, SegmentEngine};
use stepscope_peripheral::signal::{MAX_CHANNELS, Sink};
use stepscope_peripheral::units::{Cycles, Instant};

/// Limits of a part of a run; by default none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunLimits {
    /// The first cycle that is not run.
    pub cycle: Instant,
    /// Maximum number of records of a controller.
    pub records: u64,
}

impl Default for RunLimits {
    fn default() -> Self {
        Self { cycle: Instant::NEVER, records: u64::MAX }
    }
}

#[derive(Clone, Debug)]
pub(crate) enum Generator {
    Bus,
    Segments(Box<SegmentEngine>),
    StandAlone(StandAlone),
}

#[derive(Clone, Debug)]
pub(crate) struct Controllers {
    /// Not run (stays at reset) unless `generator` is `Bus`.
    pub(crate) bus: Bus,
    pub(crate) generator: Generator,
    /// The first cycle that is not run; `None` to run until no event follows.
    pub(crate) end: Option<Instant>,
}

impl Controllers {
    /// The first cycle that no controller has run. Controllers whose sinks paused may be behind it.
    pub(crate) fn furthest_cycle(&self) -> Instant {
        match &self.generator {
            Generator::Bus => self.bus.now(),
            Generator::Segments(engine) => engine.now(),
            Generator::StandAlone(machine) => machine.now(),
        }
    }

    pub(crate) fn all_have_reached(&self, end: Instant) -> bool {
        match &self.generator {
            Generator::Bus => self.bus.has_reached(end),
            _ => self.furthest_cycle() >= end,
        }
    }

    pub(crate) fn is_done(&self) -> bool {
        self.end.map_or_else(|| self.is_idle(), |end| self.all_have_reached(end))
    }

    pub(crate) fn is_idle(&self) -> bool {
        match &self.generator {
            Generator::Bus => self.bus.is_idle(),
            Generator::Segments(engine) => engine.is_idle(),
            Generator::StandAlone(machine) => machine.is_idle(),
        }
    }

    /// Runs to cycle `end` or until a sink pauses; with [`Instant::NEVER`] until no event follows.
    pub(crate) fn run_to(&mut self, end: Instant, sinks: &mut [impl Sink]) {
        match &mut self.generator {
            Generator::Bus => self.bus.run(end, sinks),
            Generator::Segments(engine) => engine.run(end, &mut sinks.first_mut()),
            Generator::StandAlone(machine) => machine.run(end, &mut sinks.first_mut()),
        }
    }

    /// Runs one cycle. The levels that the generators return also reach the sinks.
    pub(crate) fn clock(&mut self, sinks: &mut [impl Sink]) {
        match &mut self.generator {
            Generator::Bus => self.bus.clock(sinks),
            Generator::Segments(engine) => _ = engine.clock(&mut sinks.first_mut()),
            Generator::StandAlone(machine) => _ = machine.clock(&mut sinks.first_mut()),
        }
    }

    pub(crate) fn positions(&self) -> [i32; MAX_CHANNELS] {
        match &self.generator {
            Generator::Bus => {
                let mut positions = [0; MAX_CHANNELS];
                positions.iter_mut().zip(self.bus.first().positions()).for_each(|(to, from)| *to = *from);
                positions
            }
            Generator::Segments(engine) => engine.positions(),
            Generator::StandAlone(machine) => machine.positions(),
        }
    }

    pub(crate) fn faults(&self) -> Faults {
        match &self.generator {
            Generator::Bus => self.bus.first().faults(),
            Generator::Segments(engine) => engine.faults(),
            Generator::StandAlone(_) => Faults::default(),
        }
    }

    /// The cycle after the last event, if the run is idle. `last_edge` is only needed for segments.
    pub(crate) fn idle_since(&self, last_edge: Instant) -> Option<Instant> {
        self.is_idle().then(|| match &self.generator {
            Generator::Bus => self.bus.idle_since(),
            Generator::Segments(_) => last_edge.next(),
            Generator::StandAlone(machine) => machine.idle_since(),
        })
    }

    /// Reports an overload at the end of the latest cycle. Returns false for stand-alone controllers.
    pub(crate) fn stop_on_overload(&mut self, controller: usize, sink: &mut impl Sink) -> bool {
        match &mut self.generator {
            Generator::Bus => {
                let device = self.bus.device_mut(controller);
                device.map(|device| device.stop_on_overload(sink)).is_some()
            }
            Generator::Segments(engine) => {
                engine.stop_on_overload();
                true
            }
            Generator::StandAlone(_) => false,
        }
    }

    /// Reports the result of a self-test to a controller. Only controllers on a line have a self-test.
    pub(crate) fn set_settling_time(&mut self, controller: usize, time: Option<Cycles>) {
        if let Some(device) = self.bus.device_mut(controller) {
            device.set_settling_time(time);
        }
    }
}
