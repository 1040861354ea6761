//! The motion peripheral, to the clock cycle (DESIGN A1 to A8): serial line, packet decoder, queue, step-pulse
//! generator and a driver bus of 16 channels. It knows no motion, no file and no host.
//!
//! The way of the data, and the order of the modules; each may use what stands to its left:
//!
//! ```text
//! units, protocol, signal, segment, config -> wire -> device -> trace
//! ```
//!
//! Bytes go over [`wire`] into a [`device::Device`], which tells a [`signal::Sink`] what its signals do; [`trace`] has
//! sinks that keep it, and the digest by which two runs are compared.
//!
//! ```
//! use stepscope_peripheral::{config::{Bus, Config, SerialLine}, device::Device, signal::Record, units::Instant};
//!
//! let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
//! let (mut device, mut trace) = (Device::new(&config), Vec::<Record>::new());
//! device.run(true, Instant(1000), &mut trace);
//! assert_eq!(trace.len(), 1); // nothing but reset: nobody sends
//! ```
#![cfg_attr(not(test), no_std)]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod units;

pub mod protocol;

pub mod signal;

pub mod segment;

pub mod config;

pub mod wire;

pub mod device;

pub mod trace;
