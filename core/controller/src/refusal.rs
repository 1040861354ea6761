//! Errors and warnings of controllers, with the numbers (CONTROLLER.md, "Refused").

use crate::{input::Signal, limits};
use alloc::string::String;
use core::fmt;
use stepscope_peripheral::units::{Cycles, Instant};

/// Why a value is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A number or a count is out of its range.
    Range {
        given: i128,
        min: i128,
        max: i128,
    },
    /// `max_speed_hz` has shorter steps than a pulse allows.
    TooFast {
        given_hz: u32,
        step: Cycles,
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
        min: u64,
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
    /// A group `home`, but no parameters for homing.
    NoHome,
    WrongSignal {
        given: Signal,
        allowed: &'static str,
    },
    /// The home switch has only one of its ends.
    HalfSwitch {
        missing: &'static str,
    },
    /// The script contains a switch that the axis drives.
    Driven {
        signal: Signal,
        axis_field: &'static str,
    },
    /// Power, emergency stop and clear apply to all controllers and belong to the first one.
    OnlyFirstController {
        signal: Signal,
    },
    /// An input has two entries in a cycle; `name` is a signal's name or `push_steps`.
    DuplicateInput {
        name: &'static str,
        cycle: Instant,
    },
    /// The initial contents are longer than the memory.
    LongMemory {
        given: usize,
        bytes: usize,
    },
}

/// A refused value and its field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// `None` for the bus or all controllers.
    pub controller: Option<usize>,
    /// As in a scenario: `groups[2].repeat.first` within the controller, or `clock_hz` or `bus.channels`.
    pub path: String,
    pub refusal: Refusal,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Range { given, min, max } => write!(f, "{given} is out of range; use {min} to {max}"),
            Self::TooFast { given_hz, step, pulse, max_hz } => {
                let (step, pulse, min_hz) = (step.0, pulse.0, *limits::SPEED_HZ.start());
                write!(
                    f,
                    "{given_hz} Hz is a step every {step} cycles, but a pulse with its pauses takes {pulse}; "
                )?;
                if i128::from(max_hz) < min_hz {
                    return f.write_str("use shorter pulse times");
                }
                write!(f, "use {min_hz} to {max_hz} Hz")
            }
            Self::ShortInterval { given, min } => {
                write!(
                    f,
                    "{given}/65536 cycle is shorter than a pulse with its pauses; use at least {min}/65536 cycle"
                )
            }
            Self::AboveStartSpeed { given_hz, start_speed_hz } => write!(
                f,
                "{given_hz} Hz is above `start_speed_hz`, but homing has no ramp; use 10 to {start_speed_hz} Hz"
            ),
            Self::Speed { given_hz, max_speed_hz } => {
                write!(f, "{given_hz} Hz is out of range; use 10 to {max_speed_hz} Hz (`max_speed_hz`)")
            }
            Self::NotBefore { given, group: 1 } => {
                write!(f, "{given} is not an earlier group; put the groups to repeat before this first group")
            }
            Self::NotBefore { given, group } => {
                write!(f, "{given} is not before this group ({group}); use 1 to {}", group - 1)
            }
            Self::NoSuchGroup { given, groups } => write!(f, "there is no group {given}; use 1 to {groups}"),
            Self::NoHome => f.write_str("the controller has no `home`; add one or remove this group"),
            Self::WrongSignal { given, allowed } => {
                write!(f, "{} is not allowed here; use {allowed}", given.name())
            }
            Self::HalfSwitch { missing } => {
                write!(f, "the home switch has only one end; add {missing} or remove the other end")
            }
            Self::Driven { signal, axis_field } => {
                write!(f, "{} is driven by axis.{axis_field}; remove one of them", signal.name())
            }
            Self::OnlyFirstController { signal } => {
                let name = signal.name();
                write!(
                    f,
                    "{name} applies to all controllers; use it only in the script of the first controller"
                )
            }
            Self::DuplicateInput { name, cycle } => {
                write!(f, "{name} has two entries at cycle {}; use one", cycle.0)
            }
            Self::LongMemory { given, bytes } => {
                write!(f, "{given} bytes are longer than the memory; use at most {bytes}")
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

/// Why a valid value may be unintended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Warning {
    /// With `power_loss` a cut can leave the position unknown.
    ShortHoldUp { given: u64, needed: u64 },
    /// `debounce_cycles` is 0: a bouncing button counts as several presses.
    NoDebounce,
    /// Every jog exceeds the start-stop rate, so the position is unknown after it.
    JogCostsTrust { given_hz: u32, start_speed_hz: u32 },
    /// A move is too short for its speed, so all of it runs at the start-stop rate.
    ShortMove { steps: i128, needed: u64, given_hz: u32, start_speed_hz: u32 },
}

/// A warning and its field.
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
            Self::ShortHoldUp { given, needed } => write!(
                f,
                "{given} cycles may be too short to save the position at a power cut; use at least {needed} (17 bytes)"
            ),
            Self::NoDebounce => {
                f.write_str("with 0 cycles a bouncing button counts as several presses; use a debounce time")
            }
            Self::JogCostsTrust { given_hz, start_speed_hz } => write!(
                f,
                "{given_hz} Hz is above `start_speed_hz`, so every jog loses the position; use at most {start_speed_hz} Hz \
                 or `release` \"ramp\""
            ),
            Self::ShortMove { steps, needed, given_hz, start_speed_hz } => write!(
                f,
                "the whole move runs at {start_speed_hz} Hz, because {given_hz} Hz needs {needed} steps and the move has {steps}; \
                 use a higher `acceleration_level` or `short_move` \"reverse\""
            ),
        }
    }
}
