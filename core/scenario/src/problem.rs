//! What can be wrong with a scenario: every problem with its path, what was given, what is
//! allowed, and what to change.

use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use core::fmt;
use stepscope_motion::problem as motion;
use stepscope_peripheral::config::{ConfigError, ConfigProblem};

pub use stepscope_motion::problem::ValueError;

/// One problem of a scenario, at the path of the field that has to change.
pub type Problem = motion::Problem<Cause>;

/// The collector of a scenario's problems.
pub type Validator = motion::Validator<Cause>;

/// Problems of a plan, as a scenario's.
#[must_use]
pub fn of_motion(problems: Vec<motion::Problem>) -> Vec<Problem> {
    problems.into_iter().map(motion::Problem::widen).collect()
}

/// Problems of a configuration, at the paths that its fields have in a scenario.
#[must_use]
pub fn of_config(problems: Vec<ConfigProblem>) -> Vec<Problem> {
    problems
        .into_iter()
        .map(|ConfigProblem { field, error }| Problem::new(field.to_string(), error))
        .collect()
}

/// What is wrong, with the numbers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// A value by itself.
    Value(ValueError),
    /// A motion that cannot be planned.
    Motion(motion::Cause),
    /// A peripheral that cannot be configured.
    Config(ConfigError),
    /// Not JSON.
    Syntax {
        /// Where the reader stopped, from 1.
        line: usize,
        /// Column in that line, from 1.
        column: usize,
        /// What it met.
        detail: String,
    },
    /// JSON of another type or name than the field's.
    Type {
        /// What was met and what was expected.
        detail: String,
    },
    /// Written by a newer Stepscope.
    NewerVersion {
        /// The scenario's version.
        given: u64,
        /// The newest that is read here.
        newest: u32,
    },
    /// A send begins before the one before it has ended (A9).
    Overlap {
        /// Its start.
        start: u64,
        /// First cycle after the send before it.
        free_from: u64,
    },
    /// A line that cannot carry a packet a tick (A9).
    LineTooSlow {
        /// Cycles that one tick's packet takes.
        packet_cycles: u64,
        /// Cycles of a tick.
        tick_cycles: u64,
        /// The line's rate.
        baud: u32,
        /// The least rate that does.
        needed_baud: u64,
        /// The highest rate that the receiver can hear with this clock.
        max_baud: u64,
    },
    /// Two controllers of one address.
    SameAddress {
        /// The address.
        address: u8,
    },
    /// Controllers of one raw line whose packets have different lengths: each consumes those for
    /// others by its own (A5).
    OtherPackets {
        /// This one's channels.
        channels: u8,
        /// The first one's.
        first_channels: u8,
    },
    /// Controllers that are paced together and have ticks of different lengths (A9).
    OtherTick {
        /// This one's tick in cycles.
        tick_cycles: u64,
        /// The first one's.
        first_cycles: u64,
    },
    /// A stand-alone controller that is refused (CONTROLLER.md).
    StandAlone(stepscope_controller::Refusal),
    /// A program without an end (CONTROLLER.md G5).
    Work(stepscope_controller::Work),
    /// A plant that cannot be made of these numbers (F3, F5).
    Plant(stepscope_plant::Refused),
    /// Motors of one plant on different supplies (F9).
    OtherSupply {
        /// This motor's supply in V.
        supply_v: f64,
        /// The first motor's.
        first_v: f64,
    },
    /// A boot that is too short for a self-test (F7).
    SelfTest {
        /// Its cycles.
        given: u64,
        /// Those of the self-test, and one.
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
    /// Whether it follows from several fields together, so that it means nothing while one of them
    /// cannot be read.
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
