//! All that is told of a recording at once: the figures of each channel, and what is on its lines.
//!
//! ```
//! use stepscope_inspect::recording::report::Report;
//! use stepscope_peripheral::trace::Recording;
//! use stepscope_sim::Experiment;
//!
//! let mut recording = Recording::default();
//! Experiment::from_json("{}").expect("the default motion").run(&mut recording);
//! let report = Report::of(&recording.trace, 16_000_000, 1, None);
//! assert_eq!(report.channels.len(), 1);
//! assert_eq!(report.lines[0].to_text(), "RX: 115200 baud (115211 measured), 200 bytes, raw packets of 1 byte");
//! ```

use super::{
    figures::StepFigures,
    serial::{Guess, Heard, Measured, guess, hear, line_name, measured_baud},
};
use alloc::{format, string::String, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::{
    signal::{Levels, Record},
    trace::{Step, steps_in},
};

/// What a recording comes to.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Channels that step, in order.
    pub channels: Vec<ChannelReport>,
    /// RX and TX, where something was heard on them.
    pub lines: Vec<LineReport>,
}

/// A channel that steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelReport {
    /// Its number.
    pub channel: u8,
    /// What its steps come to.
    pub figures: StepFigures,
}

/// A line on which bytes were heard.
#[derive(Clone, Debug, PartialEq)]
pub struct LineReport {
    /// RX or TX.
    pub name: &'static str,
    /// The rate that its pulses have; `None` where none fits.
    pub measured: Option<Measured>,
    /// The rate that its bytes were heard at.
    pub baud: u32,
    /// Its bytes.
    pub heard: Heard,
    /// What they seem to be.
    pub guess: Guess,
}

impl Report {
    /// Of records in cycles of `clock_hz`, of a bus of so many channels. Lines are heard at `baud`, or at the rate that
    /// their pulses have.
    #[must_use]
    pub fn of(records: &[Record], clock_hz: u32, channels: u8, baud: Option<u32>) -> Self {
        let of = |channel| {
            let figures = StepFigures::of(steps_in(records, channel), clock_hz)?;
            Some(ChannelReport { channel, figures })
        };
        let line = |mask| LineReport::of(records, mask, clock_hz, baud);
        Self {
            channels: (0..channels).filter_map(of).collect(),
            lines: [Levels::RX, Levels::TX].into_iter().filter_map(line).collect(),
        }
    }

    /// Of steps alone, those of channel 0.
    #[must_use]
    pub fn of_steps(steps: &[Step], clock_hz: u32) -> Self {
        let figures = StepFigures::of(steps.iter().copied(), clock_hz);
        Self {
            channels: figures.map(|figures| ChannelReport { channel: 0, figures }).into_iter().collect(),
            lines: Vec::new(),
        }
    }

    /// What is on RX.
    #[must_use]
    pub fn rx(&self) -> Option<&LineReport> {
        self.lines.iter().find(|line| line.name == line_name(Levels::RX))
    }
}

impl LineReport {
    fn of(records: &[Record], mask: u64, clock_hz: u32, baud: Option<u32>) -> Option<Self> {
        let first = records.first()?.levels.has(mask);
        if records.iter().all(|record| record.levels.has(mask) == first) {
            return None;
        }
        let measured = measured_baud(records, mask, clock_hz);
        let baud = baud.or(measured.map(Measured::rounded))?;
        let heard = hear(records, mask, clock_hz, baud);
        let guess = guess(&heard.bytes, u64::from(clock_hz / baud.max(1)));
        Some(Self { name: line_name(mask), measured, baud, heard, guess })
    }

    /// Of bytes that were decoded already.
    #[must_use]
    pub fn of_heard(heard: Heard, clock_hz: u32, baud: u32) -> Self {
        let guess = guess(&heard.bytes, u64::from(clock_hz / baud.max(1)));
        Self { name: line_name(Levels::RX), measured: None, baud, heard, guess }
    }

    /// In one sentence.
    #[must_use]
    pub fn to_text(&self) -> String {
        let measured = self
            .measured
            .map_or_else(String::new, |measured| format!(" ({} measured)", libm::round(measured.baud)));
        let errors = match self.heard.framing_errors.len() {
            0 => String::new(),
            1 => ", 1 framing error".into(),
            more => format!(", {more} framing errors"),
        };
        let what = self.guess_text();
        format!(
            "{}: {} baud{measured}, {} bytes{errors}, {what}",
            self.name,
            self.baud,
            self.heard.bytes.len()
        )
    }

    /// What the bytes seem to be, in words.
    #[must_use]
    pub fn guess_text(&self) -> String {
        match self.guess {
            Guess::Framed { address, channels, good, bad } => {
                let channels =
                    channels.map_or_else(String::new, |channels| format!(" of {channels} channels"));
                format!("{good} frames for address {address}{channels}, {bad} broken")
            }
            Guess::Raw { length, bad, .. } => {
                let s = if length == 1 { "" } else { "s" };
                let others = if bad == 0 { String::new() } else { format!(", {bad} of another length") };
                format!("raw packets of {length} byte{s}{others}")
            }
            Guess::Other => "no packets that are known".into(),
        }
    }
}
