//! Errors and warnings of controllers, with the numbers (CONTROLLER.md, "Refused").

use crate::input::Signal;
use alloc::string::String;
use core::fmt;
use stepscope_peripheral::units::{Cycles, Instant};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A number or a count is out of its range.
    Range {
        given: i128,
        least: i128,
        greatest: i128,
    },
    TooFast {
        given_hz: u32,
        step: Cycles,
        /// W + max(H + D, 1).
        pulse: Cycles,
        max_hz: u64,
    },
    /// A speed is above `max_speed_hz` or below 10 Hz.
    Speed {
        given_hz: u32,
        max_speed_hz: u32,
    },
    /// An interval of a `profile` is shorter than a pulse allows; both in 1/65536 cycle.
    ShortInterval {
        given: u64,
        least: u64,
    },
    /// A speed of homing is above the start-stop rate.
    AboveStartSpeed {
        given_hz: u32,
        start_speed_hz: u32,
    },
    /// The first group of a `repeat` is not before it.
    NotBefore {
        given: u32,
        group: u32,
    },
    NoSuchGroup {
        given: u32,
        groups: u32,
    },
    NoHome,
    /// This signal is not allowed here.
    WrongSignal {
        given: Signal,
        allowed: &'static str,
    },
    /// One end of the home switch without the other.
    HalfSwitch {
        missing: &'static str,
    },
    /// The script contains a switch that the axis drives.
    Driven {
        signal: Signal,
        /// The field of the axis.
        by: &'static str,
    },
    /// Only the first controller has power, E-stop and clear, for all.
    FirstControllers {
        signal: Signal,
    },
    /// An input has two entries in a cycle.
    Twice {
        /// A signal's name, or `push_steps`.
        name: &'static str,
        cycle: Instant,
    },
    LongMemory {
        given: usize,
        bytes: usize,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// `None` for the bus or all controllers.
    pub controller: Option<usize>,
    /// The field as in a scenario: within the controller, such as `groups[2].repeat.first`, or `clock_hz` or
    /// `bus.channels`.
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

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Warning {
    /// With `power_loss` a cut can leave the position unknown.
    ShortHoldUp {
        given: u64,
        /// 17*w - 1, the minimum.
        enough: u64,
    },
    /// `debounce_cycles` is 0: a bouncing button counts as several presses.
    NoDebounce,
    /// Every jog exceeds the start-stop rate, which costs trust.
    JogCostsTrust { given_hz: u32, start_speed_hz: u32 },
    /// A move is too short for its speed, so all of it runs at the start-stop rate.
    ShortMove {
        steps: i128,
        /// Steps to its speed and down again.
        needed: u64,
        given_hz: u32,
        start_speed_hz: u32,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warned {
    pub controller: usize,
    /// The field within the controller, as in a scenario.
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
                 {start_speed_hz} Hz; a higher level needs fewer, and short_move \"reverse\" goes up as far as they allow"
            ),
        }
    }
}
