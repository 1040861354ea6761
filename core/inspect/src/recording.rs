//! A recording looked at like a run: what its steps come to, its bytes, itself beside the model, and the scenario that
//! gives the same again.
//!
//! ```text
//! records in cycles  ->  figures     steps, rates, turns, pulse widths of each channel
//!                        serial      bytes of RX and TX, their rate and what they seem to be
//!                        overview    all of it at a glance, a column a pixel
//!                        packets     what RX and TX say, packet by packet
//!                        remedy      what would help, for command and page to word
//!                        replies     what TX says, for the table of packets
//!                        matching    which recorded step is which planned step
//!                        alignment   each step compared with the plan's
//!                        differences what is missing, extra, late, ...
//!                        drift       the clocks' line through how late they are
//!                        scenario    a list of segments, or a line script
//! ```
//!
//! ```
//! use stepscope_inspect::recording::{alignment::{Alignment, Side}, report::Report, tolerance::Tolerance};
//! use stepscope_peripheral::trace::{Recording, steps};
//! use stepscope_sim::Experiment;
//!
//! let recorded = |json: &str| {
//!     let mut recording = Recording::default();
//!     Experiment::from_json(json).expect("no problems").run(&mut recording);
//!     recording.trace
//! };
//! // The same move by a controller whose start-up takes longer.
//! let (own, model) = (recorded(r#"{"bus":{"boot_cycles":4000}}"#), recorded("{}"));
//! assert_eq!(Report::of(&own, 16_000_000, 1, None).channels[0].figures.steps, 3200);
//! let (own, model) = (steps(&own, 0), steps(&model, 0));
//! let side = |steps| Side { steps, clock_hz: 16_000_000, values: &[] };
//! let found = Alignment::of(side(&own), side(&model), None).expect("both have steps").comparison(Tolerance::ZERO);
//! assert!(found.is_same(), "{found:?}");
//! ```

pub mod alignment;
pub mod differences;
pub mod drift;
pub mod events;
pub mod figures;
pub mod matching;
pub mod opened;
pub mod overview;
pub mod packets;
pub mod remedy;
pub mod replies;
pub mod report;
pub mod scenario;
pub mod serial;
mod side;
pub mod tolerance;
