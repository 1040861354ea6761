//! The plant's second reader: a slow model of drivers, motors, supply and sensors, written from the sentences of
//! Part F and from nothing else, so that property tests can hold the plant to the text bit by bit.
//!
//! It is plain on purpose: every grid point is kept, every formula stands as it is printed, and nothing is shared with
//! the core, sine, exponential and XXH64 included.
//!
//! ```text
//! records (cycle, levels) --F4 translator--> targets --F4 driver--> v --F3--> x, w, i_a, i_b, energy
//!    energies --F5--> i_load, V --F6--> low pass, ADC --F7--> overload
//!    x --F6--> encoder codes;  points 20, 40, ... --F8--> digest
//! ```
//!
//! Where the contract leaves room, the reading taken is written at the line that takes it ("Reading:").

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
/// What F8 reads off a run: delta t_p, peaks, overshoot and settling.
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
