//! The stand-alone controller's second reader: a slow model of its panel, programs, moves, memory and axis, written
//! from the sentences of Part G and from nothing else, so that property tests can hold the product to the text.
//!
//! It is plain on purpose: one cycle after another, G1's order is the order of the calls, every rule stands where its
//! sentence stands, and nothing is shared with the core, CRC-32C and XXH64 included. Cycles may be passed over only
//! where one has just changed nothing and no time that the state holds comes before: `run` does, `run_every_cycle`
//! does not, and a test holds both to the same records.
//!
//! ```text
//! script --3 raw, axis, debounced--> 4 reactions --moves, EN, cuts--> 1 engine of the next cycles --> records (A3)
//!    position, trust, numbers <--5 begins, 2 bytes--> EEPROM;   end of the cycle before --G8--> panel records
//! ```
//!
//! Where the contract leaves room, the reading taken is written at the line that takes it ("Reading:").

mod arithmetic;
mod axis;
mod buttons;
mod crc32c;
mod eeprom;
mod engine;
mod format;
mod homing;
mod inputs;
mod journal;
mod numbers;
mod panel;
mod parameters;
mod power;
mod programs;
mod random;
mod reactions;
mod refusals;
mod room;
mod run;

#[cfg(test)]
mod tests;

pub use eeprom::{Content, Record, journal_record, numbers_bank};
pub use format::to_json;
pub use panel::PanelRecord;
pub use parameters::{
    Axis, Case, Controller, Entry, Group, Home, Initial, Input, Jog, Memory, Move, Policy, Profile, Release,
    Return, ShortMove, SoftLimits, Until, What,
};
pub use random::{SplitMix64, random_case};
pub use refusals::refused;
pub use room::{Alarm, State};
pub use run::{ControllerOutcome, Outcome, run, run_every_cycle, run_up_to};
