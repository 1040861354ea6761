//! Two sample recordings, each with its scenario; `recordings/README.md` describes them.
//!
//! ```
//! use stepscope_capture::{read::{Limits, read}, samples::SAMPLES};
//!
//! for sample in &SAMPLES {
//!     let reading = read(std::io::Cursor::new(sample.bytes), &Limits::default(), &mut |_| true);
//!     assert!(reading.error.is_none() && !reading.capture.is_empty());
//! }
//! ```

/// A sample recording with the scenario of its plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    pub id: &'static str,
    pub file: &'static str,
    pub bytes: &'static [u8],
    /// The planned scenario, as JSON.
    pub scenario: &'static str,
}

/// A firmware with a step table and a timer interrupt, and a host that sends a packet too late.
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

pub fn sample(id: &str) -> Option<&'static Sample> {
    SAMPLES.iter().find(|sample| sample.id == id)
}
