//! Drivers, motors, supply and sensors on the STEP, DIR and EN edges of a bus (PLANT.md, Part F).
//!
//! The crate depends on channels, levels and cycles, but on no packets, motions or files. It computes with + - * / on f64 in
//! the order of the contract, so every target gives the same bits.
//!
//! ```text
//! parameters, limits -> motor_constants -> driver, supply, sensors -> rotor (one sub-step) -> plant (the grid)
//! ```
//!
//! ```
//! use stepscope_peripheral::{signal::{Levels, Record}, units::Instant};
//! use stepscope_plant::{Plant, parameters::{MotorModel, Setup}};
//!
//! let motor = MotorModel { microsteps: 1, ..MotorModel::default() };
//! let mut plant = Plant::new(&Setup { motors: vec![motor], ..Setup::default() }).expect("a valid setup");
//! // One full step to the right in cycle 1600, then 100 ms to settle.
//! let levels = Levels(Levels::RESET.0 | 1 << Levels::DIR_SHIFT | 1);
//! plant.record(Record { cycle: Instant(1600), levels }, &mut ());
//! plant.advance(1_600_000, &mut ());
//! assert!((plant.state(0).expect("a motor").x - 1.0).abs() < 0.05);
//! ```
#![cfg_attr(not(test), no_std)]
#![allow(missing_docs, reason = "fields and variants whose names state meaning and unit")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod limits;
pub mod measures;
pub mod parameters;
pub mod rates;
pub mod settling;
pub mod stability;

mod digest;
mod driver;
mod energy;
mod lost_steps;
mod motor_constants;
mod plant;
mod refusal;
mod root;
mod rotor;
mod sensors;
mod sincos;
mod state;
mod supply;

pub use energy::EnergyBalance;
pub use lost_steps::Slip;
pub use plant::{Observer, Plant, PointEvents};
pub use refusal::{Refusal, Refused};
pub use sensors::SignalChain;
pub use sincos::sincos;
pub use stability::Criterion;
pub use state::State;
