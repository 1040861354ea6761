//! Reads tables of times and positions, as firmware prints its step count.
//!
//! ```text
//! time_s,position        Time [ms];Position [steps]        0.000 0
//! 0.00125,-3             1.25;-3                           0.001 1
//! ```

use super::{
    decimal::Decimal,
    fields::{Fields, separator},
    levels::{Layout, column_names, is_comment},
    reading::Reader,
    recorder::{Names, Recorder, quoted},
    times::{TimeUnit, Times},
};
use crate::capture::{Capture, TimedPosition};

pub(super) struct Positions {
    recorder: Recorder,
    /// Without a unit, whole numbers are not seconds.
    whole_times: bool,
    fields: Fields,
    times: Times,
    /// Separator, columns of time and position; `None` before the first line.
    columns: Option<(u8, usize, usize)>,
}

impl Positions {
    pub(super) const fn new(recorder: Recorder, whole_times: bool) -> Self {
        let times = Times::new(TimeUnit::Seconds(0));
        Self { recorder, whole_times, fields: Fields::new(), times, columns: None }
    }

    fn begin(&mut self, line: &[u8]) -> Result<bool, String> {
        let separator = separator(line);
        self.fields.split(line, separator)?;
        let names = column_names(&self.fields, separator);
        let Some(Layout { time, unit, .. }) = Layout::of(&names) else {
            if self.whole_times {
                self.times = Times::new(TimeUnit::Cycles);
            }
            self.columns = Some((separator, 0, 1));
            return Ok(false);
        };
        let at = position_column(&names, time).unwrap_or(usize::from(time == 0));
        if let Some((name, unit)) = names.get(at).and_then(|name| Some((name, unit_of(name)?))) {
            return Err(format!(
                "the column “{name}” is in {unit}, not in steps; multiply it by the steps per {unit}, round it, and name it \
                 position"
            ));
        }
        let is_said = !self.whole_times || TimeUnit::is_said(names.get(time));
        self.times = Times::new(if is_said { unit } else { TimeUnit::Cycles });
        self.columns = Some((separator, time, at));
        let mut others = Names::new();
        names
            .iter()
            .enumerate()
            .filter(|(column, _)| *column != time && *column != at)
            .for_each(|(_, name)| others.add(name));
        if !others.is_empty() {
            self.recorder.leave_out(format!("columns besides time and position: {}", others.told()));
        }
        Ok(true)
    }
}

pub(super) fn position_column(names: &[String], time: usize) -> Option<usize> {
    let of =
        |is: &dyn Fn(&str) -> bool| names.iter().enumerate().position(|(at, name)| at != time && is(name));
    of(&|name| name.trim().to_lowercase().starts_with("pos")).or_else(|| of(&is_position))
}

impl Reader for Positions {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        let line = line.trim_ascii();
        if line.is_empty() || is_comment(line) {
            return Ok(());
        }
        if self.columns.is_none() && self.begin(line)? {
            return Ok(());
        }
        let (separator, time, at) = self.columns.unwrap_or((b',', 0, 1));
        self.fields.split(line, separator)?;
        let tick = self.times.tick(self.fields.get(time), &mut self.recorder)?;
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

/// The unit if it is not steps: `position_mm`, `x [mm]`, `angle (deg)`.
fn unit_of(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let last =
        lower.split(|letter: char| !letter.is_alphabetic() && letter != '°').rfind(|word| !word.is_empty());
    Some(match last? {
        "mm" | "millimeter" | "millimeters" => "mm",
        "um" | "µm" | "μm" => "µm",
        "cm" => "cm",
        "m" | "meter" | "meters" => "m",
        "in" | "inch" | "inches" => "inch",
        "deg" | "degree" | "degrees" | "°" => "degree",
        "rad" | "radian" | "radians" => "radian",
        "rev" | "revs" | "revolution" | "revolutions" | "turn" | "turns" => "turn",
        _ => return None,
    })
}

pub(super) fn is_position(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    let known =
        ["pos", "step", "microstep", "angle", "count", "encoder"].iter().any(|start| name.starts_with(start));
    // STEP and STEP0 are lines.
    known && !name.strip_prefix("step").is_some_and(|rest| rest.bytes().all(|byte| byte.is_ascii_digit()))
        || ["x", "y", "z", "actual", "actual_position", "position"].contains(&name.as_str())
}
