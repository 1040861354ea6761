//! The door to Stepscope: a stepper-motion peripheral to the clock cycle, and the motions that drive it.
//!
//! Each room is a crate of its own, re-exported here by features. The way of the data is one line; a room may use what
//! stands to its left, never what stands to its right:
//!
//! ```text
//! registers -> peripheral -> motion -> scenario -> sim -> inspect
//! ```
//!
//! | room | what it holds | feature |
//! | --- | --- | --- |
//! | [`registers`] | the register map, and the bus that drivers are written against | always |
//! | [`peripheral`] | the device: serial line, packets, pulses, trace, digest | always |
//! | [`motion`] | profiles, planners, their steps as ticks, segments and tables | `motion` |
//! | [`scenario`] | what a file, a link and the form hold | `scenario` |
//! | [`sim`] | a scenario judged, planned and run | `sim` |
//! | [`inspect`] | what one looks at: packets, spectra, measures, timing, torque | `inspect` |
//!
//! Invariants that hold everywhere: time is an integer count of clock cycles; nothing that decides an edge depends on
//! the platform (transcendental functions come from `libm`); no panic is reachable from any scenario, link, file or byte
//! stream.
#![no_std]

pub use stepscope_peripheral as peripheral;
pub use stepscope_registers as registers;

#[cfg(feature = "motion")]
pub use stepscope_motion as motion;

#[cfg(feature = "scenario")]
pub use stepscope_scenario as scenario;

#[cfg(feature = "sim")]
pub use stepscope_sim as sim;

#[cfg(feature = "inspect")]
pub use stepscope_inspect as inspect;
