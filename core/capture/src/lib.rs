//! Reads recordings of firmware or a host: levels of channels, bytes of a line, or positions.
//!
//! ```text
//! file -> read -> Capture: channels, times in ticks of the file -> channel map -> records in clock cycles
//! ```
//!
//! ```
//! use stepscope_capture::{ChannelMap, RecordedSignals, read::{Limits, read}};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0!";
//! let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
//! assert_eq!(capture.changes.iter().nth(1).map(|change| change.tick), Some(10));
//!
//! let (map, timebase) = (ChannelMap::proposed(&capture), capture.timebase.expect("the dump has a time scale"));
//! let signals = RecordedSignals::new(capture, &map, timebase, 16_000_000).expect("the recording is short");
//! assert_eq!(signals.records[1].cycle.0, 160);
//! ```
#![allow(missing_docs, reason = "a name that has its meaning and unit needs no comment")]

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
mod short_sort;
mod spacing;
pub mod timebase;
pub mod uart;

pub use capture::Capture;
pub use channel_map::ChannelMap;
pub use recorded::RecordedSignals;
