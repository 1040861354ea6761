//! An independent model of the stand-alone controller: slow, with panel, programs, moves, memory and axis, written
//! only from the text of Part G. Property tests compare the controller with it.
//!
//! It is simple: it runs cycle by cycle, the order of calls is that of G1, each rule is where its sentence is, and it
//! shares nothing with the core, not even CRC-32C and XXH64. `run` skips cycles only if the last one changed nothing
//! and the state has no earlier time; `run_every_cycle` skips none. A test compares the records of both.
//!
//! ```text
//! script --3 raw, axis, debounced--> 4 reactions --moves, EN, cuts--> 1 engine of the next cycles --> records (A3)
//!    position, trust, numbers <--5 begins, 2 bytes--> EEPROM;   end of the cycle before --G8--> panel records
//! ```
//!
//! Where the contract is ambiguous, a comment "Reading:" states the interpretation.

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
