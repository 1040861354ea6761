//! Reads Stepscope's own trace: per line a cycle and the levels of all signals, in hexadecimal.
//!
//! ```text
//! 0 700000000
//! 1f4a 700000001
//! ```
//!
//! [`super::levels`] reads the table of edges.

use super::reading::Reader;
use super::recorder::{Recorder, quoted};
use crate::capture::Capture;
use stepscope_peripheral::signal;

pub(super) struct TraceText {
    recorder: Recorder,
    signals: u32,
    has_record: bool,
}

impl TraceText {
    pub(super) fn new(mut recorder: Recorder) -> Self {
        let names = (0..64).map_while(signal::name);
        let signals = names.filter_map(|name| recorder.channel(&name)).count() as u32;
        Self { recorder, signals, has_record: false }
    }
}

impl Reader for TraceText {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.trim_ascii();
        if line.is_empty() {
            return Ok(());
        }
        let (cycle, levels) = record(line).ok_or_else(|| {
            format!(
                "{} is not a record; use a cycle and the levels in hexadecimal, such as 1f4a 700000001",
                quoted(line)
            )
        })?;
        if levels >> self.signals != 0 {
            return Err(format!(
                "{} has more than {} signals; use a trace of Stepscope",
                quoted(line),
                self.signals
            ));
        }
        if self.has_record && cycle <= self.recorder.capture.end {
            let before = self.recorder.capture.end;
            return Err(format!("cycle {cycle:x} follows cycle {before:x}; sort the records by cycle"));
        }
        self.has_record = true;
        self.recorder.levels(cycle, levels)
    }

    fn finish(self) -> (Capture, Result<(), String>) {
        (self.recorder.finish(), Ok(()))
    }
}

pub(super) fn record(line: &[u8]) -> Option<(u64, u64)> {
    let gap = line.iter().position(|byte| *byte == b' ')?;
    let (cycle, levels) = line.split_at(gap);
    Some((hexadecimal(cycle)?, hexadecimal(levels.trim_ascii())?))
}

fn hexadecimal(text: &[u8]) -> Option<u64> {
    if !(1..=16).contains(&text.len()) {
        return None;
    }
    text.iter().try_fold(0, |value, byte| Some(value << 4 | u64::from(char::from(*byte).to_digit(16)?)))
}
