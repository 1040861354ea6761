//! Tables of levels, a row a change: Saleae Logic 2's export, Stepscope's table of edges, and what is like them.
//!
//! ```text
//! Time [s],Channel 0,Channel 1          cycle,time_s,STEP0,DIR0,EN,RX,TX,DE
//! 0.000000000,0,1                       0,0,0,0,1,1,1,0
//! 0.000012500,1,1                       24,0.0000015,1,0,1,1,1,0
//! ```

use super::{
    fields::{Fields, separator},
    reading::Reader,
    recorder::{Recorder, quoted},
    times::{TimeUnit, Times},
};
use crate::capture::Capture;

/// A table of levels that is being read.
pub(super) struct LevelsTable {
    recorder: Recorder,
    /// What the head of the table says; nothing before it is read.
    columns: Option<Columns>,
    /// Levels of channels that have no bit, or no data (`X`).
    unknown: u64,
}

struct Columns {
    separator: u8,
    times: Times,
    /// Whether a column of times in s comes after the one of cycles, from which it follows.
    skip: bool,
    names: Vec<String>,
}

impl LevelsTable {
    pub(super) const fn new(recorder: Recorder) -> Self {
        Self { recorder, columns: None, unknown: 0 }
    }

    fn head(&mut self, line: &[u8]) -> Result<(), String> {
        let separator = separator(line);
        let mut fields = Fields::new();
        fields.split(line, separator)?;
        let names = fields.names();
        let unit = names.first().and_then(|name| TimeUnit::of_column(name)).unwrap_or(TimeUnit::Seconds(0));
        let skip =
            unit == TimeUnit::Cycles && names.get(1).is_some_and(|name| TimeUnit::of_column(name).is_some());
        let names: Vec<String> = names.into_iter().skip(1 + usize::from(skip)).collect();
        for (at, name) in names.iter().enumerate() {
            let numbered = format!("Channel {at}");
            self.recorder.channel(if name.is_empty() { &numbered } else { name });
        }
        if names.is_empty() {
            return Err(
                "the head of the table names no channel; it names the time and then each channel".into()
            );
        }
        self.columns = Some(Columns { separator, times: Times::new(unit), skip, names });
        Ok(())
    }
}

impl Reader for LevelsTable {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        if line.trim_ascii().is_empty() {
            return Ok(());
        }
        let Some(columns) = &mut self.columns else { return self.head(line) };
        let separator = columns.separator;
        let end_of_time = line.iter().position(|byte| *byte == separator).unwrap_or(line.len());
        let (time, mut rest) = line.split_at(end_of_time);
        let tick = columns.times.tick(time.trim_ascii(), &mut self.recorder)?;
        if columns.skip {
            let second = rest.iter().skip(1).position(|byte| *byte == separator);
            rest = second.and_then(|length| rest.get(1 + length..)).unwrap_or_default();
        }
        let mut levels = 0_u64;
        for (bit, name) in columns.names.iter().enumerate() {
            let (field, after) = match rest {
                // Nearly every row is of this form.
                [_, level @ (b'0' | b'1'), after @ ..]
                    if after.first().is_none_or(|byte| *byte == separator) =>
                {
                    (core::slice::from_ref(level), after)
                }
                [_, after @ ..] => {
                    let length = after.iter().position(|byte| *byte == separator).unwrap_or(after.len());
                    let (field, after) = after.split_at(length);
                    (field.trim_ascii(), after)
                }
                [] => (&[][..], &[][..]),
            };
            rest = after;
            match field {
                b"0" => {}
                b"1" => levels |= 1_u64.checked_shl(bit as u32).unwrap_or(0),
                b"X" | b"x" => self.unknown += 1,
                _ => return Err(not_a_level(name, field)),
            }
        }
        if !rest.is_empty() {
            return Err(format!(
                "more fields than the head of the table names, which are {}",
                columns.names.len()
            ));
        }
        self.recorder.levels(tick, levels)
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        let found = match self.columns {
            Some(columns) => {
                columns.times.finish(&mut self.recorder);
                Ok(())
            }
            None => Err("the table has no head".into()),
        };
        self.recorder.leave_out_unknown(self.unknown, "X: no data");
        let capture = self.recorder.finish();
        let found = if found.is_ok() && capture.is_empty() { Err(NO_ROWS.into()) } else { found };
        (capture, found)
    }
}

const NO_ROWS: &str = "the table has a head and no rows; record again, or export the whole of the recording";

/// What is wrong with a field that should be a level.
pub(super) fn not_a_level(name: &str, field: &[u8]) -> String {
    format!(
        "{} is {}; a level is 0 or 1: export digital channels only",
        if name.is_empty() { "a level" } else { name },
        quoted(field)
    )
}
