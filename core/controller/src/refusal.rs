//! Why controllers are refused, with the numbers (CONTROLLER.md, "Refused").

use crate::input::Signal;
use alloc::string::String;
use core::fmt;
use stepscope_peripheral::units::{Cycles, Instant};

/// Why a [`Setup`](crate::parameters::Setup) makes no machine.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Refusal {
    /// A number, or how many there are of something, is out of its range.
    Range {
        given: i128,
        least: i128,
        greatest: i128,
    },
    /// Steps at this speed would come sooner than a pulse allows.
    TooFast {
        /// The speed in Hz.
        given_hz: u32,
        /// Whole cycles from step to step at it.
        step: Cycles,
        /// W + max(H + D, 1).
        pulse: Cycles,
        /// The fastest that is allowed in Hz.
        max_hz: u64,
    },
    /// A speed is above the fastest that may be requested, or below 10 Hz.
    Speed {
        /// The speed in Hz.
        given_hz: u32,
        /// `max_speed_hz`.
        max_speed_hz: u32,
    },
    /// An interval of a `profile` is shorter than a pulse allows.
    ShortInterval {
        /// The interval in 1/65536 cycle.
        given: u64,
        /// Lm in 1/65536 cycle.
        least: u64,
    },
    /// A speed of homing is above the start-stop range.
    AboveStartSpeed {
        /// The speed in Hz.
        given_hz: u32,
        /// `start_speed_hz`.
        start_speed_hz: u32,
    },
    /// The first group of a `repeat` is not before it.
    NotBefore {
        given: u32,
        /// Number of the `repeat`.
        group: u32,
    },
    NoSuchGroup {
        given: u32,
        groups: u32,
    },
    /// A group `home` without [`Parameters::home`](crate::parameters::Parameters::home).
    NoHome,
    /// This signal cannot stand here.
    WrongSignal {
        given: Signal,
        allowed: &'static str,
    },
    /// One end of the home switch without the other.
    HalfSwitch {
        missing: &'static str,
    },
    /// The script has a switch that the axis drives.
    Driven {
        signal: Signal,
        /// The field of the axis that drives it.
        by: &'static str,
    },
    /// Power, E-stop and clear are the first controller's, for all.
    FirstControllers {
        signal: Signal,
    },
    /// An input has two entries in a cycle.
    Twice {
        /// Its name: a signal's, or `push_steps`.
        name: &'static str,
        cycle: Instant,
    },
    /// More bytes than the memory has.
    LongMemory {
        given: usize,
        bytes: usize,
    },
}

/// A refusal and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Refused {
    /// Which controller; `None` where it is about the bus or all of them.
    pub controller: Option<usize>,
    /// The field, as a scenario names it: within the controller, such as `groups[2].repeat.first`, or `clock_hz`,
    /// `bus.channels` and their like.
    pub path: String,
    pub refusal: Refusal,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Range { given, least, greatest } => {
                write!(f, "{given} is out of range; give {least} to {greatest}")
            }
            Self::TooFast { given_hz, step, pulse, max_hz } => {
                write!(
                    f,
                    "{given_hz} Hz is a step every {} cycles at this clock; W + max(H + D, 1) is {} cycles, so ",
                    step.0, pulse.0
                )?;
                if max_hz < 10 {
                    return f.write_str("no speed is slow enough: give shorter times of the pulse");
                }
                write!(f, "at most {max_hz} Hz")
            }
            Self::ShortInterval { given, least } => write!(
                f,
                "{given}/65536 cycle is shorter than a pulse allows; W + max(H + D, 1) is {least}/65536 cycle, so give at \
                 least that"
            ),
            Self::AboveStartSpeed { given_hz, start_speed_hz } => write!(
                f,
                "{given_hz} Hz is above start_speed_hz {start_speed_hz}: homing stops at once and must stay in the \
                 start-stop range"
            ),
            Self::Speed { given_hz, max_speed_hz } => {
                write!(f, "{given_hz} Hz is out of range; give 10 Hz to max_speed_hz, {max_speed_hz} Hz")
            }
            Self::NotBefore { given, group: 1 } => {
                write!(
                    f,
                    "{given} is not before this group, which is the first; give another group before it"
                )
            }
            Self::NotBefore { given, group } => {
                write!(f, "{given} is not before this group ({group}); give a group before it")
            }
            Self::NoSuchGroup { given, groups } => {
                write!(f, "{given}, but there are {groups} groups; give 1 to {groups}")
            }
            Self::NoHome => f.write_str("there is no `home`; give one or leave the group out"),
            Self::WrongSignal { given, allowed } => {
                write!(f, "{} cannot stand here; give {allowed}", given.name())
            }
            Self::HalfSwitch { missing } => {
                write!(f, "the home switch has two ends; give {missing}, too, or neither")
            }
            Self::Driven { signal, by } => {
                write!(f, "{} is driven by axis.{by}; leave one of them out", signal.name())
            }
            Self::FirstControllers { signal } => {
                write!(f, "{} is for all controllers and the first one's; leave it out here", signal.name())
            }
            Self::Twice { name, cycle } => {
                write!(f, "{name} has two levels at cycle {}; give one", cycle.0)
            }
            Self::LongMemory { given, bytes } => {
                write!(f, "{given} bytes, but the memory has {bytes}; give at most as many")
            }
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(controller) = self.controller {
            write!(f, "controller {controller}: ")?;
        }
        write!(f, "{}: {}", self.path, self.refusal)
    }
}

impl core::error::Error for Refused {}

/// What holds, but may not be meant.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Warning {
    /// With `power_loss` a cut can leave the position unknown.
    ShortHoldUp {
        /// `hold_up_cycles`.
        given: u64,
        /// 17*w - 1, which is just enough.
        enough: u64,
    },
    /// `debounce_cycles` is 0: a button that bounces is pressed several times.
    NoDebounce,
    /// Every jog jumps beyond the start-stop range, and costs trust.
    JogCostsTrust {
        /// `jog.speed_hz`.
        given_hz: u32,
        /// `start_speed_hz`.
        start_speed_hz: u32,
    },
    /// A move of the program is too short for its speed, and goes at the start-stop rate all the way.
    ShortMove {
        steps: i128,
        /// Up to its speed and down again.
        needed: u64,
        /// Its `speed_hz`.
        given_hz: u32,
        /// `start_speed_hz`.
        start_speed_hz: u32,
    },
}

/// A warning and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Warned {
    pub controller: usize,
    /// The field within it, as a scenario names it.
    pub path: String,
    pub warning: Warning,
}

impl fmt::Display for Warned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "controller {}: {}: {}", self.controller, self.path, self.warning)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ShortHoldUp { given, enough } => write!(
                f,
                "{given} cycles are less than the {enough} that a record needs for sure (17*w - 1): a cut can leave the \
                 position unknown"
            ),
            Self::NoDebounce => f.write_str("0 cycles: a button that bounces is pressed several times"),
            Self::JogCostsTrust { given_hz, start_speed_hz } => write!(
                f,
                "{given_hz} Hz is above start_speed_hz {start_speed_hz}: with `at_once` every jog costs trust"
            ),
            Self::ShortMove { steps, needed, given_hz, start_speed_hz } => write!(
                f,
                "{steps} steps are too short for {given_hz} Hz, which takes {needed} up and down: the whole move goes at \
                 {start_speed_hz} Hz; a higher level needs fewer, and short_move \"turn_round\" goes up as far as they allow"
            ),
        }
    }
}
