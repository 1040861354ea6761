//! The model behind Stepscope: a stepper-motion peripheral to the clock cycle, and the motions that
//! drive it.
//!
//! The way of the data is one line, and the modules stand in its order. A module may use what
//! stands to its left or below the line, never what stands to its right:
//!
//! ```text
//! scenario -> motion -> quantise -> wire -> device -> trace -> analysis -> run
//! below: units, signal, segment, protocol
//! ```
//!
//! `device` never learns of motions and `motion` never of devices: they meet in ticks and in
//! segments. `run` is the front that walks the whole line, from a scenario to its trace.
//!
//! Invariants that hold everywhere: time is an integer count of clock cycles; nothing that decides
//! an edge depends on the platform (transcendental functions come from `libm`); no panic is
//! reachable from any scenario, link, file or byte stream.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

pub mod scenario;

pub mod motion;

pub mod quantise;

pub mod wire;

pub mod device;

pub mod trace;

pub mod analysis;

pub mod run;

pub mod protocol;
pub mod segment;
pub mod signal;
pub mod units;
