//! An independent model of the plant: drivers, motors, supply and sensors, slow and written only from the text of
//! Part F. Property tests compare the plant with it, bit by bit.
//!
//! It is simple: it stores every grid point, has every formula as printed, and shares nothing with
//! the core, not even sine, exponential and XXH64.
//!
//! ```text
//! records (cycle, levels) --F4 translator--> targets --F4 driver--> v --F3--> x, w, i_a, i_b, energy
//!    energies --F5--> i_load, V --F6--> low pass, ADC --F7--> overload
//!    x --F6--> encoder codes;  points 20, 40, ... --F8--> digest
//! ```
//!
//! Where the contract is ambiguous, a comment "Reading:" states the interpretation.

mod driver;
mod ledger;
mod motor;
mod numbers;
mod parameters;
mod random;
mod refusals;
mod run;
mod sensors;
mod supply;

/// Records (A3) from lists of segments (A8) and from the self-test (F7).
pub mod edges;
/// Results of F8: delta t_p, peaks, overshoot and settling.
pub mod results;

#[cfg(test)]
mod tests;

pub use ledger::Ledger;
pub use numbers::{SplitMix64, nearest, sincos};
pub use parameters::{
    Case, CurrentSensor, Decay, Drive, Encoder, Motor, MotorConstants, Plant, Protection, Regulator,
    grid_step,
};
pub use random::{drawn_case, random_case};
pub use refusals::{Refusal, is_refused};
pub use run::{LostStep, MotorPoint, Point, Run, run};
pub use sensors::low_pass_factor;
