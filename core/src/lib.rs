//! Stepscope: a cycle-exact model of a stepper-motion peripheral, with motion planning, experiments and analysis.
//!
//! An **experiment** (a motion, a host, a serial line, controllers) gives the same edges, bit for bit, on a PC, in a browser
//! and on a microcontroller.
//!
//! # Run a scenario
//!
//! ```
//! use stepscope_core::prelude::*;
//!
//! # #[cfg(feature = "sim")]
//! fn main() -> Result<(), Problems> {
//!     // One turn in 0.4 s by a cosine S-curve; every other field has its default.
//!     let scenario: Scenario = r#"{ "source": { "motion": { "axes": [ { "moves": [
//!         { "cosine": { "distance": { "deg": 360 }, "duration_s": 0.4, "ramp_s": 0.2 } } ] } ] } } }"#.parse()?;
//!     let due = step_times(&scenario, 0)?; // planned steps of axis 0, in cycles from the start
//!     let run = run(&scenario)?; // the actual pulses, cycle by cycle
//!     println!("{} steps, digest {:016x}", due.len(), run.digest());
//!     assert_eq!(run.positions(), [3200]);
//!     // Replace the second `due` with the steps of your own generator.
//!     assert_eq!(first_difference(&due, &due, Cycles(16)), None);
//!     Ok(())
//! }
//! # #[cfg(not(feature = "sim"))]
//! # fn main() {}
//! ```
//!
//! A scenario is JSON; every field has a default. A run has every edge with its cycle, and a digest that identifies them
//! all. A refused scenario returns all its [`Problems`](prelude), each with its path.
//!
//! # Get step times without a scenario
//!
//! ```
//! # #[cfg(feature = "motion")]
//! use stepscope_core::motion::mechanics::Distance;
//! # #[cfg(feature = "motion")]
//! use stepscope_core::motion::moves::{Axis, Cosine, Move};
//! # #[cfg(feature = "motion")]
//! use stepscope_core::motion::{Problems, plan_axis};
//!
//! # #[cfg(feature = "motion")]
//! fn main() -> Result<(), Problems> {
//!     let turn = Cosine { distance: Distance::Degrees(360.0), duration_s: 0.4, ramp_s: 0.15, ..Cosine::default() };
//!     let axis = Axis { moves: vec![Move::Cosine(turn)], ..Axis::default() };
//!     for step in plan_axis(&axis, "axis")?.due_steps(16_000_000).take(3) {
//!         println!("cycle {}, {}", step.cycle, if step.right { "right" } else { "left" });
//!     }
//!     Ok(())
//! }
//! # #[cfg(not(feature = "motion"))]
//! # fn main() {}
//! ```
//!
//! # Run with a sink of your own
//!
//! An experiment is a scenario that is validated and planned once. Its edges go to any
//! [`Sink`](peripheral::signal::Sink): a digest, a file, a check.
//!
//! ```
//! # #[cfg(feature = "inspect")] {
//! use stepscope_core::{inspect::trace::stored_run::StoredRun, sim::Experiment};
//!
//! let experiment = Experiment::from_json("{}").expect("the default motion");
//! let mut recording = StoredRun::default(); // edges, digest and packets
//! let run = experiment.run(&mut recording);
//! assert_eq!(run.positions()[0], 3200);
//! assert_eq!(format!("{:016x}", recording.digest.value()), "ed82c77232a01a3a");
//! # }
//! ```
//!
//! # Compare with your own edges
//!
//! The plan's steps and yours are matched; the result counts missing, additional and late ones.
//!
//! ```
//! # #[cfg(all(feature = "inspect", feature = "std"))] {
//! use stepscope_core::inspect::recording::{alignment::{Alignment, Side}, tolerance::Tolerance};
//! # use stepscope_core::{inspect::trace::stored_run::StoredRun, peripheral::trace::steps, sim::Experiment};
//! # let mut recording = StoredRun::default();
//! # Experiment::from_json("{}").expect("the default motion").run(&mut recording);
//! # let plan = steps(&recording.trace, 0);
//! // Your steps: here the planned steps, one of them missing.
//! let mut own = plan.clone();
//! own.remove(2000);
//! let side = |steps| Side { steps, clock_hz: 16_000_000, values: &[] };
//! let found = Alignment::of(side(&own), side(&plan), None).expect("both have steps");
//! let compared = found.comparison(Tolerance::ZERO);
//! assert_eq!((compared.missing, compared.extra), (1, 0));
//! # }
//! ```
//!
//! `capture` reads your edges from files of logic analyzers.
//!
//! # Test firmware
//!
//! Firmware reaches the peripheral through a [`RegisterBus`](registers::RegisterBus): volatile accesses on a chip, a
//! [`ModelBus`](peripheral::device::ModelBus) in its tests. No feature is required.
//!
//! ```
//! use stepscope_core::{
//!     peripheral::{config::{Bus, Config, SerialLine}, device::ModelBus, trace::Digest, units::Cycles},
//!     registers::{RegisterBus, orders, push},
//! };
//!
//! /// The firmware: five steps to the right on channel 0.
//! fn nudge(bus: &mut impl RegisterBus) {
//!     bus.write(orders::OFFSET, 0x80 | 5);
//!     bus.write(push::OFFSET, 1);
//! }
//!
//! let config = Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
//! let mut bus = ModelBus::new(&config, Cycles(8), Digest::default()); // 8 cycles per access
//! bus.wait(Cycles(2_000)); // the peripheral's self-test
//! nudge(&mut bus);
//! bus.wait(Cycles(40_000)); // a tick and more
//! assert_eq!(bus.device().positions()[0], 5);
//! ```
//!
//! `examples/` has five short programs: `turn`, `firmware_test`, `line_script`, `segment_list` and `registers`.
//!
//! # Crates
//!
//! Each module is a crate, re-exported here. A crate depends only on those to its left:
//!
//! ```text
//! registers -> peripheral -> motion, plant, controller, capture -> scenario -> sim -> inspect
//! ```
//!
//! | crate | contents | feature |
//! | --- | --- | --- |
//! | [`registers`] | the register map, its data sheet, and the bus for drivers | always |
//! | [`peripheral`] | the device: serial line, packets, frames, pulses, segments, trace, digest | always |
#![cfg_attr(
    feature = "motion",
    doc = "| [`motion`] | profiles, planners, their steps as ticks, segments and tables | `motion` |"
)]
#![cfg_attr(
    feature = "scenario",
    doc = "| [`plant`] | drivers, motors, supply and sensors behind the bus | `scenario` |"
)]
#![cfg_attr(
    feature = "scenario",
    doc = "| [`controller`] | the stand-alone controller: buttons, programs, memory | `scenario` |"
)]
#![cfg_attr(
    feature = "scenario",
    doc = "| [`scenario`] | the scenario format: files, links, the form | `scenario` |"
)]
#![cfg_attr(
    feature = "std",
    doc = "| [`capture`] | recordings of logic analyzers and logs, in cycles | `std` |"
)]
#![cfg_attr(feature = "sim", doc = "| [`sim`] | validates, plans and runs scenarios | `sim` |")]
#![cfg_attr(
    feature = "inspect",
    doc = "| [`inspect`] | analysis: packets, spectra, measures, timing, torque | `inspect` |"
)]
//!
//! A crate's feature enables the crates to its left. `std` adds the spectrum, value change dumps and recordings; without
//! it everything is `no_std` with `alloc`. All features are on by default; firmware tests need only
//! `stepscope-core = { version = "0.2", default-features = false }`.
//!
//! # Time, positions, units
//!
//! | what | how |
//! | --- | --- |
//! | time of the device | cycles of its clock since reset, `u64`: [`Instant`](peripheral::units::Instant) is a point, [`Cycles`](peripheral::units::Cycles) a span |
//! | an edge at cycle c | the old level during c - 1, the new one during c; a run of N cycles is 0 to N - 1 |
//! | positions | steps (microsteps) since reset, right positive: +1 for a rise of STEP with DIR high |
//! | intervals of segments | 1/65536 cycle, so that fractions never drift |
//! | time of a motion | seconds since its start, `f64`; speeds in steps/s, accelerations in steps/s², unrounded |
//! | all else | the unit is in the name: `pulse_width_cycles`, `lead_mm`, `supply_v` |
//!
//! # What always holds
//!
//! - Nothing that decides an edge depends on the platform: integers, and transcendental functions from one `libm`.
//! - No panic is reachable from any scenario, link, file or byte stream.
//! - Errors say what was given, what is allowed, and what to change. Enums that name errors may grow: match them with
//!   a wildcard.
#![no_std]

#[cfg(all(doctest, feature = "sim"))]
#[doc = include_str!("../README.md")]
struct Readme;

mod first_difference;
pub mod prelude;

pub use first_difference::{Timed, first_difference};
pub use stepscope_peripheral as peripheral;
pub use stepscope_registers as registers;

#[cfg(feature = "scenario")]
pub use stepscope_scenario::{Problem, Problems};
#[cfg(feature = "sim")]
pub use stepscope_sim::{ControllerRun, FinishedRun, run, step_times};

#[cfg(feature = "motion")]
pub use stepscope_motion as motion;

#[cfg(feature = "scenario")]
pub use stepscope_plant as plant;

#[cfg(feature = "scenario")]
pub use stepscope_controller as controller;

#[cfg(feature = "std")]
pub use stepscope_capture as capture;

#[cfg(feature = "scenario")]
pub use stepscope_scenario as scenario;

#[cfg(feature = "sim")]
pub use stepscope_sim as sim;

#[cfg(feature = "inspect")]
pub use stepscope_inspect as inspect;
