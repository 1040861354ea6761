//! Tables of times and positions, as a firmware prints its own count of steps.
//!
//! ```text
//! time_s,position        Time [ms];Position [steps]        0.000 0
//! 0.00125,-3             1.25;-3                           0.001 1
//! ```

use super::{
    decimal::Decimal,
    fields::{Fields, separator},
    reading::Reader,
    recorder::{Names, Recorder, quoted},
    times::{TimeUnit, Times},
};
use crate::capture::{Capture, TimedPosition};

/// Positions that are being read.
pub(super) struct Positions {
    recorder: Recorder,
    fields: Fields,
    times: Times,
    /// What separates the fields, and which of them is the position; nothing before the first line.
    columns: Option<(u8, usize)>,
}

impl Positions {
    pub(super) const fn new(recorder: Recorder) -> Self {
        let times = Times::new(TimeUnit::Seconds(0));
        Self { recorder, fields: Fields::new(), times, columns: None }
    }

    /// The columns by the first line, and whether that is a head.
    fn begin(&mut self, line: &[u8]) -> Result<bool, String> {
        let separator = if line.contains(&b' ') && row(line).is_some() && !line.contains(&b',') {
            row_separator(line)
        } else {
            separator(line)
        };
        self.fields.split(line, separator)?;
        let names = self.fields.names();
        let Some(unit) = names.first().and_then(|name| TimeUnit::of_column(name)) else {
            self.columns = Some((separator, 1));
            return Ok(false);
        };
        let at = names.iter().position(|name| is_position(name)).unwrap_or(1);
        self.times = Times::new(unit);
        self.columns = Some((separator, at));
        let mut others = Names::new();
        names
            .iter()
            .enumerate()
            .filter(|(column, _)| *column != 0 && *column != at)
            .for_each(|(_, name)| others.add(name));
        if !others.is_empty() {
            self.recorder.leave_out(format!("columns besides time and position: {}", others.told()));
        }
        Ok(true)
    }
}

impl Reader for Positions {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.trim_ascii();
        if line.is_empty() || line.starts_with(b"#") {
            return Ok(());
        }
        if self.columns.is_none() && self.begin(line)? {
            return Ok(());
        }
        let (separator, at) = self.columns.unwrap_or((b',', 1));
        self.fields.split(line, separator)?;
        let tick = self.times.tick(self.fields.get(0), &mut self.recorder)?;
        let field = self.fields.get(at);
        let position = Decimal::parse(field)
            .ok_or_else(|| format!("{} is not a position; give a whole number of steps", quoted(field)))?;
        let position = position.whole().and_then(|steps| i64::try_from(steps).ok()).ok_or_else(|| {
            format!(
                "the position {} is not a whole number of steps; multiply it by the steps of a unit (of a mm, of a turn) and round it",
                quoted(field)
            )
        })?;
        self.recorder.position(TimedPosition { tick, position })
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        self.times.finish(&mut self.recorder);
        let capture = self.recorder.finish();
        let missing = if capture.is_empty() { Err("the table has no positions".into()) } else { Ok(()) };
        (capture, missing)
    }
}

/// Whether a column of this name holds positions.
pub(super) fn is_position(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    let known =
        ["pos", "step", "microstep", "angle", "count", "encoder"].iter().any(|start| name.starts_with(start));
    // STEP and STEP0 are lines.
    known && !name.strip_prefix("step").is_some_and(|rest| rest.bytes().all(|byte| byte.is_ascii_digit()))
        || ["x", "y", "z", "actual", "actual_position", "position"].contains(&name.as_str())
}

/// Time and position of a row without a head; `None` where it is none.
pub(super) fn row(line: &[u8]) -> Option<(Decimal, Decimal)> {
    let separator = row_separator(line);
    let mut fields = line.split(|byte| *byte == separator).map(<[u8]>::trim_ascii);
    let row = (Decimal::parse(fields.next()?)?, Decimal::parse(fields.next()?)?);
    fields.next().is_none().then_some(row)
}

fn row_separator(line: &[u8]) -> u8 {
    let separator = separator(line);
    if line.contains(&separator) { separator } else { b' ' }
}
