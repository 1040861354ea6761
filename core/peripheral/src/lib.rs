//! The motion peripheral, to the clock cycle (DESIGN A1 to A8): serial line, packet decoder, queue, step-pulse
//! generator and a driver bus of 16 channels. It depends on no motion, file or host.
//!
//! Modules in order; each may use those to its left:
//!
//! ```text
//! units, protocol, signal, segment, config -> wire -> device -> trace
//! ```
//!
//! Bytes go over [`wire`] into a [`device::Device`], which reports its signals to a [`signal::Sink`]; [`trace`] has the
//! digest by which two runs are compared.
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
#![allow(missing_docs, reason = "a name with its unit needs no comment that repeats it")]

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
