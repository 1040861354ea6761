//! Recordings analyzed like runs: figures, bytes, comparison with a plan, and a scenario that reproduces them.
//!
//! ```
//! use stepscope_capture::read::{Limits, read};
//! use stepscope_inspect::recording::{loaded_capture::LoadedCapture, open_options::OpenOptions};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0! #20 1!";
//! let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
//! let loaded = LoadedCapture::new(capture, &OpenOptions::default()).expect("a channel map is proposed");
//! assert_eq!(loaded.map, "STEP0=STEP");
//! assert_eq!(loaded.report.channels[0].figures.max_rate_steps_s, Some(100_000.0));
//! ```

pub mod alignment;
mod compared_data;
pub mod differences;
mod drift;
pub mod events;
pub mod figures;
pub mod loaded_capture;
mod matching;
pub mod open_options;
pub mod overview;
pub mod packets;
pub mod remedy;
pub mod replies;
pub mod report;
pub mod scenario;
pub mod serial;
#[cfg(test)]
mod test_random;
pub mod tolerance;
