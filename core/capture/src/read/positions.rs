//! Reads tables of times and positions, as firmware prints its step count.
//!
//! ```text
//! time_s,position        Time [ms];Position [steps]        0.000 0
//! 0.00125,-3             1.25;-3                           0.001 1
//! ```

use super::fields::{Fields, separator};
use super::levels::{Layout, column_names, is_comment};
use super::recorder::{Names, Recorder, quoted};
use super::times::{TimeUnit, Times};
use super::{decimal::Decimal, reading::Reader};
use crate::capture::{Capture, TimedPosition};

const STEP_UNITS: [&str; 7] = ["steps", "step", "microsteps", "microstep", "usteps", "pulses", "counts"];

pub(super) struct Positions {
    recorder: Recorder,
    /// Without a unit, whole numbers are not seconds.
    whole_times: bool,
    fields: Fields,
    times: Times,
    /// `None` before the first line.
    columns: Option<Columns>,
}

#[derive(Clone, Copy)]
struct Columns {
    separator: u8,
    time: usize,
    position: usize,
}

impl Positions {
    pub(super) const fn new(recorder: Recorder, whole_times: bool) -> Self {
        let times = Times::new(TimeUnit::Seconds(0));
        Self { recorder, whole_times, fields: Fields::new(), times, columns: None }
    }

    /// Returns false if the line is already a row.
    fn read_header(&mut self, line: &[u8]) -> Result<bool, String> {
        let separator = separator(line);
        self.fields.split(line, separator)?;
        let names = column_names(&self.fields, separator);
        let Some(Layout { time, unit, .. }) = Layout::of(&names) else {
            if self.whole_times {
                self.times = Times::new(TimeUnit::Cycles);
            }
            self.columns = Some(Columns { separator, time: 0, position: 1 });
            return Ok(false);
        };
        let position = position_column(&names, time).unwrap_or(usize::from(time == 0));
        names.get(position).map_or(Ok(()), |name| check_unit(name))?;
        let is_stated = !self.whole_times || TimeUnit::is_stated(names.get(time));
        self.times = Times::new(if is_stated { unit } else { TimeUnit::Cycles });
        self.columns = Some(Columns { separator, time, position });
        let mut others = Names::new();
        names
            .iter()
            .enumerate()
            .filter(|(column, _)| *column != time && *column != position)
            .for_each(|(_, name)| others.add(name));
        self.recorder.note_skipped("columns", &others);
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
        if self.columns.is_none() && self.read_header(line)? {
            return Ok(());
        }
        let Some(columns) = self.columns else { return Ok(()) };
        self.fields.split(line, columns.separator)?;
        let tick = self.times.tick(self.fields.get(columns.time), &mut self.recorder)?;
        let field = self.fields.get(columns.position);
        let position = Decimal::parse(field)
            .ok_or_else(|| format!("{} is not a position; use a whole number of steps", quoted(field)))?;
        let position = position.whole().and_then(|steps| i64::try_from(steps).ok()).ok_or_else(|| {
            format!(
                "the position {} is not a whole number of steps; multiply it by the steps per unit (mm, turn) and round it",
                quoted(field)
            )
        })?;
        self.recorder.position(TimedPosition { tick, position })
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        self.times.finish(&mut self.recorder);
        let capture = self.recorder.finish();
        let missing = if capture.is_empty() {
            Err("the table has no positions; record or export again".into())
        } else {
            Ok(())
        };
        (capture, missing)
    }
}

/// Accepts `position`, `position_steps`, `x [steps]`. A file does not give the steps per mm, inch or turn, so
/// `position_mm` and `angle (deg)` are refused, and so is an unknown unit in brackets. A last word that is no unit belongs
/// to the name: `position_x`.
fn check_unit(name: &str) -> Result<(), String> {
    let name = name.trim();
    let bracketed = name.strip_suffix([']', ')']).and_then(|name| name.rsplit_once(['[', '(']));
    let last = bracketed.map_or_else(
        || name.split(|letter: char| !letter.is_alphabetic() && letter != '°').rfind(|word| !word.is_empty()),
        |(_, unit)| Some(unit.trim()),
    );
    let unit = match last.unwrap_or_default().to_lowercase().as_str() {
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => "mm",
        "um" | "µm" | "μm" | "micron" | "microns" => "µm",
        "cm" => "cm",
        "m" | "meter" | "meters" | "metre" | "metres" => "m",
        "in" | "inch" | "inches" | "\"" => "inch",
        "mil" | "mils" | "thou" => "mil",
        "deg" | "degree" | "degrees" | "°" => "degree",
        "rad" | "radian" | "radians" => "radian",
        "rev" | "revs" | "revolution" | "revolutions" | "turn" | "turns" => "turn",
        unit if bracketed.is_none() || unit.is_empty() || STEP_UNITS.contains(&unit) => return Ok(()),
        unit => {
            return Err(format!(
                "the column “{name}” has the unknown unit {unit}; use whole steps in a column named position, or a \
                 unit of steps: {}",
                STEP_UNITS.join(", ")
            ));
        }
    };
    Err(format!(
        "the column “{name}” is in {unit}, not in steps; multiply it by the steps per {unit}, round it, and name it position"
    ))
}

pub(super) fn is_position(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    let known =
        ["pos", "step", "microstep", "angle", "count", "encoder"].iter().any(|start| name.starts_with(start));
    // STEP and STEP0 are lines.
    known && !name.strip_prefix("step").is_some_and(|rest| rest.bytes().all(|byte| byte.is_ascii_digit()))
        || ["x", "y", "z", "actual", "actual_position", "position"].contains(&name.as_str())
}
