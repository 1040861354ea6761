//! The schema: each field has one row, from which the following is derived.
//!
//! ```text
//! /// Slots in a tick, M: the most steps a channel can make in one tick.      rustdoc, docs/scenario.md, the form's hint
//! slots: u8 => label("Slots in a tick")                                       name in JSON, type, name in the form
//!     .whole(limits::SLOTS)                                                   range: the owner's constant
//!     .term("Slot", "A tick is divided into slots. …").from(PATENT),          the help's card, and where it comes from
//! ```
//!
//! | follows | where |
//! | --- | --- |
//! | reading and writing JSON ([`Read`](crate::Read), [`Compact`](crate::Compact)) | `rows`, the macros that declare rows |
//! | judging each number and each length by itself | `judge` |
//! | docs/scenario.md | [`markdown`] |
//! | what the page's form and help are made of | [`describe`] |
//!
//! A struct of the scenario's own is declared together with its rows (`settings!`), an enum of its own with its kinds
//! (`choices!`); what peripheral and motion own only gets names (`fields!`, `kinds!`), and they judge their numbers
//! themselves, by the constants that the rows name. Words are choices without anything inside (`words!`).
//!
//! ```
//! use stepscope_scenario::schema::{Limit, Type, Typed};
//! use stepscope_peripheral::config::Bus;
//!
//! let Type::Group(bus) = Bus::TYPE else { panic!("a map of fields") };
//! let slots = bus.fields.iter().find(|field| field.name == "slots").expect("it has a row");
//! assert!(matches!(slots.limit, Limit::Whole(1, 127)), "{:?}", slots.limit);
//! ```

pub(crate) mod rows;

mod bus;
mod controller;
mod describe;
mod driver;
mod experiment;
pub(crate) mod judge;
mod line;
mod markdown;
mod mechanics;
mod motor;
mod moves;
mod plant;
mod segments;
mod source;
mod standalone;
mod types;

pub use controller::Controller;
pub use describe::describe;
pub use driver::{DriverModel, DriverTiming, TimingRules};
pub use experiment::{Analysis, Scenario};
pub use line::{Glitch, Host, Line, Noise};
pub use markdown::markdown;
pub use plant::{CurrentSensor, Encoder, PlantMotor, PlantSettings, Protection};
pub use segments::{ChannelSegments, DwellSegment, Segment, SegmentLists, StepSegment};
pub use source::{LineScript, Motion, MotionEngine, Packets, ScriptedSend, Source};
pub use standalone::{
    Eeprom, HomeGroup, Homing, Jog, JumpGroup, MoveGroup, MoveToGroup, PanelInput, ProfileGroup,
    ProgramGroup, RepeatGroup, ReturnToZero, Sensor, SetGroup, SoftLimits, StandAlone, Switch, Until,
    VirtualAxis, WaitGroup,
};
pub(crate) use types::label;
pub use types::{
    DOCUMENTS, Document, Field, Group, Limit, OWN, PATENT, Parts, SHEETS, SINE, SONG, SONOBE, ToParts, Type,
    Typed, When, Word, ZHANG,
};
