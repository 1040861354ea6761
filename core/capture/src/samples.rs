//! Two recordings to look at, each with the scenario that it was to follow; `recordings/README.md` says how they were made
//! and what one sees in them.
//!
//! ```
//! use stepscope_capture::{read::{Limits, read}, samples::SAMPLES};
//!
//! for sample in &SAMPLES {
//!     let reading = read(std::io::Cursor::new(sample.bytes), &Limits::default(), &mut |_| true);
//!     assert!(reading.error.is_none() && !reading.capture.is_empty());
//! }
//! ```

/// A recording, and what it was to follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Its word on the command line and in the page.
    pub id: &'static str,
    /// The file's name.
    pub file: &'static str,
    /// The file.
    pub bytes: &'static [u8],
    /// The scenario, as JSON.
    pub scenario: &'static str,
}

/// A firmware that walks a step table by a timer's interrupt; a host that sends a packet too late.
pub const SAMPLES: [Sample; 2] = [
    Sample {
        id: "recorded-step-table",
        file: "step-table.vcd",
        bytes: include_bytes!("../recordings/step-table.vcd"),
        scenario: include_str!("../recordings/step-table.json"),
    },
    Sample {
        id: "recorded-late-packet",
        file: "late-packet.sr",
        bytes: include_bytes!("../recordings/late-packet.sr"),
        scenario: include_str!("../recordings/late-packet.json"),
    },
];

/// The sample of a word.
#[must_use]
pub fn sample(id: &str) -> Option<&'static Sample> {
    SAMPLES.iter().find(|sample| sample.id == id)
}
