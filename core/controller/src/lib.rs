//! The stand-alone controller (CONTROLLER.md): buttons, programs, jogs, homing, limits, and a memory that survives power
//! cuts, cycle-exact. It generates STEP, DIR and EN by itself, without a serial line.
//!
//! It computes in integers only, so every target gives the same bits. [`StandAlone`] simulates controllers; [`Runner`] runs
//! one on a [`Chip`](chip::Chip).
//!
//! ```text
//! limits, input, parameters -> refusal, check, checked -> table, motion, pins, debounce, axis, numbers, eeprom, journal,
//! script, panel -> controller (state, one cycle) -> pulses, store, power, buttons, moves, homing, program (effects)
//! -> machine (all controllers of a bus), enter, report -> powered_up, chip (hardware), runner (a machine on a chip)
//! ```
//!
//! ```
//! use stepscope_controller::{StandAlone, State, input::{Change, Signal}, parameters::{Parameters, Setup}};
//! use stepscope_peripheral::{signal::Record, units::Instant};
//!
//! let controller = Parameters { self_test_cycles: 100, debounce_cycles: 0, ..Parameters::default() };
//! let checked = Setup { controllers: vec![controller], ..Setup::default() }.check().expect("valid");
//! let (mut machine, mut trace) = (StandAlone::new(&checked), Vec::<Record>::new());
//! machine.run(Instant::NEVER, &mut trace);
//! assert_eq!(machine.state(0), Some(State::Ready));
//!
//! // Hold the button for 0.1 s. A jog runs at 1000 Hz, and its first step comes immediately.
//! let now = machine.now().0;
//! machine.enter(Instant(now), 0, Change::Level(Signal::JogPlus, true)).expect("not in the past");
//! machine.enter(Instant(now + 1_600_000), 0, Change::Level(Signal::JogPlus, false)).expect("not in the past");
//! machine.run(Instant::NEVER, &mut trace);
//! assert_eq!(machine.position(0), Some(100));
//! ```
#![cfg_attr(not(test), no_std)]
#![allow(missing_docs, reason = "a name that has its meaning and unit needs no comment")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod chip;
pub mod input;
pub mod limits;
pub mod panel;
pub mod parameters;

mod axis;
mod buttons;
mod check;
mod checked;
mod controller;
mod debounce;
mod eeprom;
mod enter;
mod homing;
mod journal;
mod machine;
mod motion;
mod moves;
mod named;
mod numbers;
mod pins;
mod power;
mod powered_up;
mod program;
mod pulses;
mod reactions;
mod refusal;
mod report;
mod runner;
mod script;
mod state;
mod store;
mod table;
mod too_many_groups;

pub use checked::CheckedSetup;
pub use controller::Press;
pub use enter::NotEntered;
pub use machine::StandAlone;
pub use refusal::{Refusal, Refused, Warned, Warning};
pub use runner::{Lateness, NotRunnable, Runner};
pub use state::{Alarm, State, trust_name};
pub use too_many_groups::TooManyGroups;
