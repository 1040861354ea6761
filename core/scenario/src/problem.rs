//! Problems of a scenario: path, given value, allowed values, remedy.

use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use stepscope_motion::problem as motion;
use stepscope_peripheral::config::{ConfigError, ConfigProblem};
use stepscope_peripheral::signal::MAX_CHANNELS;

pub use stepscope_motion::problem::ValueError;

/// A problem at the path of the field that has to change.
pub type Problem = motion::Problem<Cause>;

/// Why a scenario is refused: 1 to 100 problems.
pub type Problems = stepscope_motion::Problems<Cause>;

/// Collects problems of a scenario.
pub type Validator = stepscope_motion::Validator<Cause>;

/// Converts the problems of a plan.
pub fn of_motion(problems: stepscope_motion::Problems) -> Problems {
    problems.widen()
}

/// Converts the problems of a configuration.
pub fn of_config(problems: Vec<ConfigProblem>) -> Problems {
    let convert = |ConfigProblem { field, error }: ConfigProblem| Problem::new(field.to_string(), error);
    // A refused configuration has at least one problem.
    let unknown =
        || Problem::new("bus", ValueError::Conflict { detail: "not valid; use the defaults" }).into();
    Problems::new(problems.into_iter().map(convert).collect()).unwrap_or_else(unknown)
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[allow(missing_docs, reason = "fields are named as in the message")]
pub enum Cause {
    /// A value of any kind is wrong.
    Value(ValueError),
    /// A motion cannot be planned.
    Motion(motion::Cause),
    /// The bus or the line breaks a rule.
    Config(ConfigError),
    /// The text is not JSON.
    Syntax { line: usize, column: usize, detail: String },
    /// A wrong type or name.
    Type { detail: String },
    /// The version is newer than this reader.
    NewerVersion { given: u64, newest: u32 },
    /// A send overlaps the one before (A9).
    Overlap { start: u64, free_from: u64 },
    /// The line cannot carry one packet per tick (A9).
    LineTooSlow { packet_cycles: u64, tick_cycles: u64, baud: u32, needed_baud: u64, max_baud: u64 },
    /// More axes, lists or controllers than channels.
    Channels { given: usize, of: &'static str, channels: u8, path: String },
    /// A packet of the wrong length (A5).
    PacketLength { given: usize, channels: u8, is_addressed: bool, path: String },
    /// Two controllers have one address.
    SameAddress { address: u8 },
    /// Different packet lengths on a raw line, where a controller skips packets by its own length (A5).
    OtherPackets { channels: u8, first_channels: u8 },
    /// Different tick lengths of controllers with common ticks (A9).
    OtherTick { tick_cycles: u64, first_cycles: u64 },
    /// A stand-alone controller breaks a rule.
    StandAlone(stepscope_controller::Refusal),
    /// An endless program (CONTROLLER.md G5).
    TooManyGroups(stepscope_controller::TooManyGroups),
    /// A plant that cannot be simulated (F3, F5).
    Plant(stepscope_plant::Refused),
    /// Different supplies of the motors of one controller (F9).
    OtherSupply { supply_v: f64, first_v: f64 },
    /// A boot that is too short for its self-test (F7).
    SelfTest { given: u64, needed: u64 },
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
            ConfigError::Range { given, min: least, max: most, unit } => {
                let (given, least, most) = (given as f64, least as f64, most as f64);
                Self::Value(ValueError::Range { given, min: least, max: most, unit })
            }
            error => Self::Config(error),
        }
    }
}

impl stepscope_motion::WiderCause for Cause {}

impl Cause {
    /// Whether the check used several fields. Such a problem is skipped if one of them is unreadable.
    pub const fn depends_on_several_fields(&self) -> bool {
        match self {
            Self::Motion(cause) => cause.depends_on_several_fields(),
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
                write!(f, "invalid JSON at line {line}, column {column}: {detail}")
            }
            Self::Type { detail } => f.write_str(detail),
            Self::NewerVersion { given, newest } => {
                write!(f, "version {given} needs a newer Stepscope; this one reads versions 1 to {newest}")
            }
            Self::Overlap { start, free_from } => write!(
                f,
                "starts at cycle {start}, but the bytes before it end at cycle {}; use cycle {free_from} or later",
                free_from - 1
            ),
            Self::LineTooSlow { packet_cycles, tick_cycles, baud, needed_baud, max_baud } => {
                write!(
                    f,
                    "at {baud} baud the bytes of a tick take {packet_cycles} cycles, but a tick has {tick_cycles}; use "
                )?;
                if needed_baud <= max_baud {
                    write!(
                        f,
                        "at least {needed_baud} baud, longer ticks or fewer channels; on a framed line also more ticks per frame and a deeper queue"
                    )
                } else {
                    write!(
                        f,
                        "longer ticks or fewer channels: {needed_baud} baud would be needed, and this clock allows at most {max_baud}"
                    )
                }
            }
            Self::Channels { given: 0, of, .. } => write!(f, "0 {of}; use at least 1"),
            Self::Channels { given, of, channels, path } => {
                let surplus = given.saturating_sub(usize::from(*channels));
                write!(f, "{given} {of}, but `{path}` is {channels}; remove {surplus}")?;
                if *given <= MAX_CHANNELS {
                    write!(f, ", or set `{path}` to {given}")?;
                }
                Ok(())
            }
            Self::PacketLength { given, channels, is_addressed, path } => {
                let (needed, address) = match is_addressed {
                    true => (u16::from(*channels) + 1, "the address and "),
                    false => (u16::from(*channels), ""),
                };
                write!(f, "{given} bytes; use {needed}: {address}one per channel (`{path}` is {channels})")
            }
            Self::SameAddress { address } => {
                write!(
                    f,
                    "address {address} is already used; use a different address for each controller, 0 to 254"
                )
            }
            Self::OtherPackets { channels, first_channels } => write!(
                f,
                "{channels} channels, but the first controller has {first_channels}; on a raw line all controllers need the same number; use {first_channels}, or the framed protocol"
            ),
            Self::StandAlone(refusal) => refusal.fmt(f),
            Self::TooManyGroups(error) => error.fmt(f),
            Self::Plant(refused) => refused.fmt(f),
            Self::OtherSupply { supply_v, first_v } => write!(
                f,
                "{supply_v} V, but the first motor has {first_v} V; all motors of a controller share one supply; use {first_v} V"
            ),
            Self::SelfTest { given, needed } => write!(
                f,
                "{given} cycles are too short for the self-test; use at least {needed}, or set `plant.self_test` to false"
            ),
            Self::OtherTick { tick_cycles, first_cycles } => write!(
                f,
                "ticks of {tick_cycles} cycles, but the first controller has ticks of {first_cycles}; on a raw line all ticks need the same length (slots × slot); use {first_cycles} cycles, or the framed protocol"
            ),
        }
    }
}
