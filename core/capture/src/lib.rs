//! Reads recordings of firmware or a host: levels of channels, bytes of a line, or positions, with times in whole
//! ticks.
//!
//! ```text
//! file -> read -> Capture: channels, ticks -> channel map -> records in clock cycles
//! ```
//!
//! ```
//! use stepscope_capture::read::{Limits, read};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0!";
//! let reading = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true);
//! assert_eq!(reading.capture.changes.iter().nth(1).map(|change| change.tick), Some(10));
//! ```

#![allow(missing_docs, reason = "a name with its unit needs no comment that repeats it")]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod capture;
pub mod changes;
pub mod channel_map;
mod generated_pulses;
mod names;
mod proposal;
pub mod read;
pub mod recorded;
pub mod samples;
mod spacing;
pub mod timebase;
pub mod uart;

pub use capture::Capture;
pub use channel_map::ChannelMap;
pub use recorded::Recorded;
