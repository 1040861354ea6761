#![doc = include_str!("../datasheet.md")]
//! # A driver's first words
//!
//! ```
//! use stepscope_registers::{RegisterBus, capabilities, id};
//!
//! /// How many channels the peripheral has, if it is there.
//! fn channels(bus: &mut impl RegisterBus) -> Option<u32> {
//!     let is_there = bus.read(id::OFFSET) == id::MAGIC_STEP;
//!     is_there.then(|| capabilities::CHANNELS.of(bus.read(capabilities::OFFSET)))
//! }
//!
//! struct Nothing; // a bus on which nobody answers
//! impl RegisterBus for Nothing {
//!     fn read(&mut self, _: u32) -> u32 { u32::MAX }
//!     fn write(&mut self, _: u32, _: u32) {}
//! }
//! assert_eq!(channels(&mut Nothing), None);
//! ```
#![no_std]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod bus;
mod map;
pub mod table;

pub use bus::RegisterBus;
pub use map::*;
