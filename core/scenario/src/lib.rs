//! The scenario format: one experiment, as a file, a link or the page's form has it.
//!
//! Every field has a default, so `{}` is a scenario. Units are in the names. A choice is a map with one key, the name
//! of the choice, with its settings inside:
//!
//! ```json
//! { "source": { "motion": { "axes": [ { "moves": [
//!     { "cosine": { "distance": { "steps": 6400 }, "duration_s": 0.4, "ramp_s": 0.2 } } ] } ] } } }
//! ```
//!
//! [`Scenario::check`] returns a [`CheckedScenario`], or every problem with its path.
//!
//! ```
//! use stepscope_scenario::Scenario;
//!
//! let scenario = Scenario::from_json(r#"{ "clock_hz": 20000000 }"#).expect("it reads");
//! assert_eq!((scenario.clock_hz, scenario.bus.slots), (20_000_000, 100));
//! assert!(scenario.check().is_ok());
//!
//! let broken = Scenario::from_json(r#"{ "bus": { "slots": 200 }, "line": { "baud": 0 } }"#).expect("it reads");
//! let problems = broken.check().unwrap_err();
//! assert_eq!(problems.iter().map(|problem| problem.path.as_str()).collect::<Vec<_>>(), ["bus.slots", "line.baud"]);
//! ```

#![cfg_attr(not(test), no_std)]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod check;
mod compact;
mod hex;
mod json;
mod limits;
pub mod link;
mod plant;
mod points;
pub mod presets;
mod problem;
mod read;
mod reader;
mod recorded;
pub mod schema;
mod segments;
mod standalone;
mod table;
mod upgrade;

pub use check::CheckedScenario;
pub use compact::{Compact, Kinds};
pub use hex::Hex;
pub use json::Json;
pub use limits::{END_OF_TIME, MAX_CONTROLLERS, MAX_TEXT_BYTES};
pub use plant::Plants;
pub use points::points_of_table;
pub use problem::{Cause, Problem, Problems, Validator, ValueError, of_config, of_motion};
pub use read::{part_from_json, to_json};
pub use reader::{JsonReader, ReadJson};
pub use schema::{
    Analysis, ChannelSegments, Controller, DriverModel, DriverTiming, DwellSegment, Glitch, Host, Line,
    LineScript, Motion, MotionEngine, Noise, Packets, Scenario, ScriptedSend, Segment, SegmentLists, Source,
    StepSegment, TimingRules,
};
pub use schema::{CurrentSensor, Encoder, PlantMotor, PlantSettings, Protection};
pub use schema::{
    Direction, Eeprom, HomeGroup, Homing, Jog, JumpGroup, MoveGroup, MoveToGroup, PanelInput, PositionState,
    ProfileGroup, ProgramGroup, RepeatGroup, ReturnToZero, Sensor, SetGroup, SoftLimits, StandAlone, Switch,
    Until, VirtualAxis, WaitGroup,
};
pub use schema::{Parts, ToParts};
pub use table::{BadTable, MAX_TABLE_BYTES};

/// The newest scenario version, which is written.
pub const VERSION: u32 = 3;
