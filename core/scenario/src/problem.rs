//! Problems of a scenario: path, given value, allowed values, remedy.

use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use core::fmt;
use stepscope_motion::problem as motion;
use stepscope_peripheral::config::{ConfigError, ConfigProblem};

pub use stepscope_motion::problem::ValueError;

/// A problem at the path of the field that has to change.
pub type Problem = motion::Problem<Cause>;

/// Collects a scenario's problems.
pub type Validator = motion::Validator<Cause>;

/// Converts a plan's problems.
#[must_use]
pub fn of_motion(problems: Vec<motion::Problem>) -> Vec<Problem> {
    problems.into_iter().map(motion::Problem::widen).collect()
}

/// Converts a configuration's problems to the paths of a scenario.
#[must_use]
pub fn of_config(problems: Vec<ConfigProblem>) -> Vec<Problem> {
    problems
        .into_iter()
        .map(|ConfigProblem { field, error }| Problem::new(field.to_string(), error))
        .collect()
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// A single value.
    Value(ValueError),
    /// A motion that cannot be planned.
    Motion(motion::Cause),
    /// A peripheral that cannot be configured.
    Config(ConfigError),
    /// Not JSON.
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found.
        detail: String,
    },
    /// A wrong type or name.
    Type {
        /// What was found and expected.
        detail: String,
    },
    /// Written by a newer Stepscope.
    NewerVersion {
        /// The scenario's version.
        given: u64,
        /// The newest readable version.
        newest: u32,
    },
    /// A send overlaps the one before (A9).
    Overlap {
        /// Its start.
        start: u64,
        /// First free cycle.
        free_from: u64,
    },
    /// The line cannot carry one packet per tick (A9).
    LineTooSlow {
        /// Cycles per packet.
        packet_cycles: u64,
        /// Cycles per tick.
        tick_cycles: u64,
        /// The line's rate.
        baud: u32,
        /// The minimum rate.
        needed_baud: u64,
        /// The receiver's maximum rate at this clock.
        max_baud: u64,
    },
    /// Two controllers of one address.
    SameAddress {
        /// The address.
        address: u8,
    },
    /// Packet lengths differ on a raw line, where each controller also skips the others' packets by its own length
    /// (A5).
    OtherPackets {
        /// This controller's channels.
        channels: u8,
        /// The first controller's channels.
        first_channels: u8,
    },
    /// Controllers with common ticks have different tick lengths (A9).
    OtherTick {
        /// This controller's cycles per tick.
        tick_cycles: u64,
        /// The first controller's cycles per tick.
        first_cycles: u64,
    },
    /// A refused stand-alone controller (CONTROLLER.md).
    StandAlone(stepscope_controller::Refusal),
    /// An endless program (CONTROLLER.md G5).
    Work(stepscope_controller::Work),
    /// A plant with impossible numbers (F3, F5).
    Plant(stepscope_plant::Refused),
    /// Motors of one plant have different supplies (F9).
    OtherSupply {
        /// This motor's supply in V.
        supply_v: f64,
        /// The first motor's supply in V.
        first_v: f64,
    },
    /// A boot is too short for its self-test (F7).
    SelfTest {
        /// Its cycles.
        given: u64,
        /// The minimum cycles.
        needed: u64,
    },
}

impl From<ValueError> for Cause {
    fn from(error: ValueError) -> Self {
        Self::Value(error)
    }
}

impl From<motion::Cause> for Cause {
    fn from(cause: motion::Cause) -> Self {
        match cause {
            motion::Cause::Value(error) => Self::Value(error),
            cause => Self::Motion(cause),
        }
    }
}

impl From<ConfigError> for Cause {
    fn from(error: ConfigError) -> Self {
        match error {
            ConfigError::Range { given, least, most, unit } => {
                let (given, least, most) = (given as f64, least as f64, most as f64);
                Self::Value(ValueError::Range { given, least, most, unit })
            }
            error => Self::Config(error),
        }
    }
}

impl Cause {
    /// Whether it involves several fields and so means nothing if one of them cannot be read.
    #[must_use]
    pub const fn joins_fields(&self) -> bool {
        match self {
            Self::Motion(cause) => cause.joins_fields(),
            Self::Value(ValueError::Range { .. })
            | Self::Syntax { .. }
            | Self::Type { .. }
            | Self::NewerVersion { .. } => false,
            _ => true,
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(error) => error.fmt(f),
            Self::Motion(cause) => cause.fmt(f),
            Self::Config(error) => error.fmt(f),
            Self::Syntax { line, column, detail } => {
                write!(f, "not JSON at line {line}, column {column}: {detail}")
            }
            Self::Type { detail } => f.write_str(detail),
            Self::NewerVersion { given, newest } => write!(
                f,
                "version {given} was made with a newer Stepscope; this one reads up to version {newest}"
            ),
            Self::Overlap { start, free_from } => write!(
                f,
                "starts at cycle {start} while the bytes before it last to cycle {}; start at {free_from} or later",
                free_from - 1
            ),
            Self::LineTooSlow { packet_cycles, tick_cycles, baud, needed_baud, max_baud } => {
                write!(
                    f,
                    "at {baud} baud what is sent for a tick takes {packet_cycles} cycles, a tick has {tick_cycles}; give "
                )?;
                if needed_baud <= max_baud {
                    write!(
                        f,
                        "at least {needed_baud} baud, longer ticks or fewer channels; on a framed line also more ticks a frame and a deeper queue"
                    )
                } else {
                    write!(
                        f,
                        "longer ticks or fewer channels: it would need {needed_baud} baud, and this clock hears at most {max_baud}"
                    )
                }
            }
            Self::SameAddress { address } => {
                write!(f, "another controller has address {address} already; give each its own, 0 to 254")
            }
            Self::OtherPackets { channels, first_channels } => write!(
                f,
                "{channels} channels beside {first_channels} on the first controller; a raw packet has a byte a channel and no end mark, so all controllers of a raw line need as many: change one of them, or choose the framed protocol"
            ),
            Self::StandAlone(refusal) => refusal.fmt(f),
            Self::Work(work) => work.fmt(f),
            Self::Plant(refused) => refused.fmt(f),
            Self::OtherSupply { supply_v, first_v } => write!(
                f,
                "{supply_v} V beside {first_v} V of the first motor; all motors of a plant hang on one supply: give {first_v}"
            ),
            Self::SelfTest { given, needed } => write!(
                f,
                "a self-test takes {needed} cycles and the boot has {given}; give at least {needed}, or no plant.self_test"
            ),
            Self::OtherTick { tick_cycles, first_cycles } => write!(
                f,
                "ticks of {tick_cycles} cycles beside ticks of {first_cycles} on the first controller; paced packets need one length (slots x step period): change one of them, or choose the framed protocol"
            ),
        }
    }
}
