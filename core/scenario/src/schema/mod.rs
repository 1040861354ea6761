//! The schema: each field has one row, from which the following is derived.
//!
//! ```text
//! /// M: maximum steps per channel and tick.                           rustdoc, docs/scenario.md, hint in the form
//! slots: u8 => label("Slots per tick")                                 name in JSON, type, label in the form
//!     .whole(limits::SLOTS)                                            range
//!     .term("Slot", "A tick is divided into slots. …").from(PATENT),   help card and its source
//! ```
//!
//! `rows` derives the reader and the writer of JSON, `ranges` the check of single fields, [`markdown`] docs/scenario.md,
//! [`describe`] the page's form and help, and [`json_schema`] `stepscope schema`.
//!
//! `settings!` declares a struct with its rows, `choices!` an enum with its kinds. Types of other crates get rows by
//! `fields!` and `kinds!`; those crates check the ranges. `words!` declares choices without settings.
//!
//! ```
//! use stepscope_peripheral::config::Bus;
//! use stepscope_scenario::schema::{Limit, Type, Typed};
//!
//! let Type::Group(bus) = Bus::TYPE else { panic!("a map of fields") };
//! let slots = bus.fields.iter().find(|field| field.name == "slots").expect("a row");
//! assert!(matches!(slots.limit, Limit::Whole(1, 127)), "{:?}", slots.limit);
//! ```

pub(crate) mod rows;

mod bus;
mod controller;
mod describe;
mod driver;
mod experiment;
mod groups;
mod json_schema;
mod line;
mod markdown;
mod mechanics;
mod motor;
mod moves;
mod plant;
pub(crate) mod ranges;
mod segments;
mod source;
mod standalone;
mod types;

pub use controller::Controller;
pub use describe::describe;
pub use driver::{DriverModel, DriverTiming, TimingRules};
pub use experiment::{Analysis, Scenario};
pub use json_schema::json_schema;
pub use line::{Glitch, Host, Line, Noise};
pub use markdown::markdown;
pub use plant::{CurrentSensor, Encoder, PlantMotor, PlantSettings, Protection};
pub use segments::{ChannelSegments, DwellSegment, Segment, SegmentLists, StepSegment};
pub use source::{LineScript, Motion, MotionEngine, Packets, ScriptedSend, Source};
pub use standalone::{
    Direction, Eeprom, HomeGroup, Homing, Jog, JumpGroup, MoveGroup, MoveToGroup, PanelInput, PositionState,
    ProfileGroup, ProgramGroup, RepeatGroup, ReturnToZero, Sensor, SetGroup, SoftLimits, StandAlone, Switch,
    Until, VirtualAxis, WaitGroup,
};
pub(crate) use types::label;
pub use types::{
    DOCUMENTS, Document, Field, Group, Limit, OWN, PATENT, Parts, SHEETS, SINE, SONG, SONOBE, ToParts, Type,
    Typed, When, Word, ZHANG,
};
