//! What runs a scenario by itself, in place of a line: lists of segments, or stand-alone controllers.

use alloc::boxed::Box;
#[cfg(feature = "controller")]
use stepscope_controller::StandAlone;
use stepscope_peripheral::{
    device::{Faults, SegmentEngine},
    signal::{MAX_CHANNELS, Sink},
    units::Instant,
};

/// A generator of steps that hears no line.
#[derive(Clone, Debug)]
pub(crate) enum Alone {
    /// Lists of segments (DESIGN A8).
    Segments(Box<SegmentEngine>),
    /// Controllers with a panel each (CONTROLLER.md).
    #[cfg(feature = "controller")]
    Panels(StandAlone),
}

impl Alone {
    /// Controllers before cycle 0.
    #[cfg(feature = "controller")]
    pub(crate) fn panels(checked: &stepscope_controller::Checked) -> Self {
        Self::Panels(StandAlone::new(checked))
    }

    /// The controllers, if they are such.
    #[cfg(feature = "controller")]
    pub(crate) const fn stand_alone(&self) -> Option<&StandAlone> {
        match self {
            Self::Segments(_) => None,
            Self::Panels(machine) => Some(machine),
        }
    }

    /// The same, to be pressed.
    #[cfg(feature = "controller")]
    pub(crate) const fn stand_alone_mut(&mut self) -> Option<&mut StandAlone> {
        match self {
            Self::Segments(_) => None,
            Self::Panels(machine) => Some(machine),
        }
    }

    /// The first cycle that has not been run.
    pub(crate) fn now(&self) -> Instant {
        match self {
            Self::Segments(engine) => engine.now(),
            #[cfg(feature = "controller")]
            Self::Panels(machine) => machine.now(),
        }
    }

    /// Whether nothing can change any more.
    pub(crate) fn at_rest(&self) -> bool {
        match self {
            Self::Segments(engine) => engine.at_rest(),
            #[cfg(feature = "controller")]
            Self::Panels(machine) => machine.at_rest(),
        }
    }

    /// Where nothing can change any more, from which cycle on. The segment engine does not know its last change: it is `last`.
    #[cfg(feature = "plant")]
    pub(crate) fn rests_from(&self, last: Instant) -> Instant {
        match self {
            Self::Segments(_) => last.next(),
            #[cfg(feature = "controller")]
            Self::Panels(machine) => machine.rests_from(),
        }
    }

    pub(crate) fn positions(&self) -> [i32; MAX_CHANNELS] {
        match self {
            Self::Segments(engine) => engine.positions(),
            #[cfg(feature = "controller")]
            Self::Panels(machine) => machine.positions(),
        }
    }

    pub(crate) fn faults(&self) -> Faults {
        match self {
            Self::Segments(engine) => engine.faults(),
            #[cfg(feature = "controller")]
            Self::Panels(_) => Faults::from_bits(0),
        }
    }

    /// Goes on to cycle `until`; see [`SegmentEngine::run`].
    pub(crate) fn run(&mut self, until: Instant, sink: &mut impl Sink) {
        match self {
            Self::Segments(engine) => engine.run(until, sink),
            #[cfg(feature = "controller")]
            Self::Panels(machine) => machine.run(until, sink),
        }
    }

    /// One cycle.
    pub(crate) fn clock(&mut self, sink: &mut impl Sink) {
        match self {
            Self::Segments(engine) => {
                engine.clock(sink);
            }
            #[cfg(feature = "controller")]
            Self::Panels(machine) => {
                machine.clock(sink);
            }
        }
    }

    /// The plant reports an overload. Returns whether it reacts: stand-alone controllers do not (F7).
    #[cfg(feature = "plant")]
    pub(crate) fn overload(&mut self) -> bool {
        match self {
            Self::Segments(engine) => {
                engine.overload();
                true
            }
            #[cfg(feature = "controller")]
            Self::Panels(_) => false,
        }
    }
}
