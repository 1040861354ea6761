//! A model of the motion peripheral with clock-cycle accuracy (DESIGN A1 to A8): serial line, packet decoder, queue,
//! step-pulse generator and a driver bus of 16 channels. It depends on no motion, file or host.
//!
//! Modules in order; each may use those to its left:
//!
//! ```text
//! units, protocol, signal, segment, config -> wire -> device -> trace
//! ```
//!
//! Bytes arrive over [`wire`] at a [`device::Device`], which sends its signals to a [`signal::Sink`]; [`trace`] has the
//! digest that identifies a run.
//!
//! ```
//! use stepscope_peripheral::{config::{Bus, Config, SerialLine}, device::Device, signal::Record, units::Instant};
//!
//! let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
//! let (mut device, mut trace) = (Device::new(&config), Vec::<Record>::new());
//! device.run(true, Instant(1000), &mut trace);
//! assert_eq!(trace.len(), 1); // only reset: no sender
//! ```
#![cfg_attr(not(test), no_std)]
#![allow(missing_docs, reason = "fields and variants whose names state meaning and unit")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod config;
pub mod device;
mod parameters;
pub mod protocol;
pub mod segment;
pub mod signal;
pub mod trace;
pub mod units;
pub mod wire;
