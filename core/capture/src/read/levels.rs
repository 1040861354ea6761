//! Reads tables of levels, one row per change: exports of Saleae Logic 2, DSView, WaveForms and KingstVIS,
//! Stepscope's table of edges, and others.
//!
//! ```text
//! Time [s],Channel 0,Channel 1        ; Sample rate: 250 MHz        cycle,time_s,STEP0,DIR0,EN,RX,TX,DE
//! 0.000000000,0,1                     Time(s), STEP, DIR            0,0,0,0,1,1,1,0
//! 0.000012500,1,1                     0.000995,0,1                  24,0.0000015,1,0,1,1,1,0
//! ```

use super::fields::{Fields, fields, not_a_level, separator};
use super::recorder::{Names, Recorder, quoted};
use super::sample_rate::{SampleRate, period};
use super::times::{TimeUnit, Times};
use super::{reading::Reader, selection::select};
use crate::capture::Capture;

pub(super) struct LevelsTable {
    recorder: Recorder,
    /// Without a unit, whole numbers are not seconds.
    whole_times: bool,
    skipped_columns: u64,
    rate: SampleRate,
    /// The program writes decimal commas between fields that commas separate.
    decimal_commas: bool,
    line: u64,
    columns: Option<Columns>,
    unknown: u64,
    fields: Fields,
}

struct Columns {
    separator: u8,
    times: Times,
    list: Vec<Column>,
    is_first_row: bool,
}

enum Column {
    Time,
    Other,
    Level(Option<u8>, String),
}

impl LevelsTable {
    pub(super) fn new(recorder: Recorder, whole_times: bool, skipped_columns: u64) -> Self {
        Self {
            recorder,
            whole_times,
            skipped_columns,
            rate: SampleRate::default(),
            decimal_commas: false,
            line: 0,
            columns: None,
            unknown: 0,
            fields: Fields::new(),
        }
    }

    /// Returns false if the line is already a row; the first column is then the time.
    fn read_header(&mut self, line: &[u8]) -> Result<bool, String> {
        let separator = separator(line);
        self.fields.split(line, separator)?;
        let mut names = column_names(&self.fields, separator);
        // A separator at the end of a row adds no column.
        if names.len() > 2 && names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        let layout = Layout::of(&names);
        let has_header = layout.is_some();
        let Layout { time, unit, others } = layout.unwrap_or(Layout {
            time: 0,
            unit: if self.whole_times { TimeUnit::Cycles } else { TimeUnit::Seconds(0) },
            others: Vec::new(),
        });
        let unit = if has_header && self.whole_times && !TimeUnit::is_stated(names.get(time)) {
            TimeUnit::Cycles
        } else {
            unit
        };
        if !has_header {
            self.recorder.note(
                "the table has no column names: the first column is read as the time, all others as channels",
            );
        }
        self.columns = Some(Columns {
            separator,
            times: Times::new(unit),
            list: self.columns_of(&names, has_header, time, &others)?,
            is_first_row: true,
        });
        Ok(has_header)
    }

    /// Assigns a bit to each column of levels, as far as there are bits.
    fn columns_of(
        &mut self,
        names: &[String],
        has_header: bool,
        time: usize,
        others: &[usize],
    ) -> Result<Vec<Column>, String> {
        let (mut list, mut channels) = (Vec::new(), Vec::new());
        let mut bit = 0;
        let mut skipped = Names::new();
        for (at, name) in names.iter().enumerate() {
            if at < 64 && self.skipped_columns >> at & 1 == 1 {
                skipped.add(name);
                list.push(Column::Other);
                continue;
            }
            if at == time || others.contains(&at) {
                list.push(if at == time { Column::Time } else { Column::Other });
                continue;
            }
            let name = if has_header { name.clone() } else { format!("D{bit}") };
            let numbered = format!("Channel {bit}");
            channels.push(if name.is_empty() { numbered } else { name.clone() });
            list.push(Column::Level(None, name));
            bit += 1;
        }
        self.recorder.note_skipped("columns without levels", &skipped);
        if bit == 0 {
            return Err("the table has no column of levels; use a header such as time_us,STEP,DIR".into());
        }
        let mut bits = select(channels.iter().map(String::as_str), &mut self.recorder).into_iter();
        for column in &mut list {
            if let Column::Level(bit, _) = column {
                *bit = bits.next().flatten();
            }
        }
        Ok(list)
    }

    fn comment(&mut self, line: &[u8]) -> Result<(), String> {
        let lower = String::from_utf8_lossy(line).to_ascii_lowercase();
        self.decimal_commas |= lower.contains("libsigrok4dsl") || lower.contains("dsview");
        let keys = ["sample rate:", "samplerate:", "sample rate (hz):"];
        // The text as the file has it, for messages.
        let text = String::from_utf8_lossy(line);
        match keys.iter().find_map(|key| text.get(lower.find(key)? + key.len()..)) {
            Some(rate) => self.rate.set(rate.trim(), self.line),
            None => Ok(()),
        }
    }

    /// Whether a row after the head gives units, as `(ms),(V)`.
    fn units(columns: &mut Columns, line: &[u8]) -> bool {
        let is_unit = |field: &[u8]| matches!(field, [b'(' | b'[', .., b')' | b']'] | []);
        let all: Vec<&[u8]> = fields(line, columns.separator).collect();
        if !all.iter().all(|field| is_unit(field)) {
            return false;
        }
        let time = columns.list.iter().position(|column| matches!(column, Column::Time));
        let name = time.and_then(|at| all.get(at)).and_then(|field| core::str::from_utf8(field).ok());
        let unit = name.and_then(|name| TimeUnit::parse(name.trim_matches(['(', ')', '[', ']'])));
        if let Some(unit) = unit {
            columns.times = Times::new(unit);
        }
        unit.is_some()
    }
}

pub(super) struct Layout {
    pub(super) time: usize,
    pub(super) unit: TimeUnit,
    others: Vec<usize>,
}

impl Layout {
    pub(super) fn of(names: &[String]) -> Option<Self> {
        let named = |name: &String| TimeUnit::named(name);
        let units: Vec<Option<(TimeUnit, bool)>> = names.iter().map(named).collect();
        let of = |wanted: &dyn Fn(&(TimeUnit, bool)) -> bool| {
            units.iter().position(|unit| unit.as_ref().is_some_and(wanted))
        };
        // Our own tables have exact cycles first; in others a time is better than a sample number.
        let is_cycles = names.first().is_some_and(|name| name.trim().to_lowercase().starts_with("cycle"));
        let time = if is_cycles {
            Some(0)
        } else {
            of(&|(unit, stated)| *unit != TimeUnit::Cycles && *stated)
                .or_else(|| of(&|(unit, _)| *unit != TimeUnit::Cycles))
                .or_else(|| of(&|_| true))
        }?;
        let (unit, _) = (*units.get(time)?)?;
        let others = (0..names.len()).filter(|at| *at != time && units.get(*at).is_some_and(Option::is_some));
        Some(Self { time, unit, others: others.collect() })
    }
}

/// Between blanks, a unit in brackets belongs to the name before it.
pub(super) fn column_names(fields: &Fields, separator: u8) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for name in fields.names() {
        match names.last_mut() {
            Some(last) if separator == b' ' && name.starts_with(['(', '[']) => {
                last.push(' ');
                last.push_str(&name);
            }
            _ => names.push(name),
        }
    }
    names
}

pub(super) fn is_comment(line: &[u8]) -> bool {
    matches!(line, [b';' | b'#' | b'%', ..] | [b'/', b'/', ..])
}

impl Reader for LevelsTable {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        self.line += 1;
        let line = line.trim_ascii();
        if line.is_empty() {
            return Ok(());
        }
        if is_comment(line) {
            return self.comment(line);
        }
        if self.columns.is_none() && self.read_header(line)? {
            return Ok(());
        }
        let Some(columns) = &mut self.columns else { return Ok(()) };
        if core::mem::take(&mut columns.is_first_row) && Self::units(columns, line) {
            return Ok(());
        }
        let separator = columns.separator;
        let (time, levels) = if line.contains(&b'"') {
            self.fields.split(line, separator)?;
            row(self.fields.iter(), self.fields.len(), columns, &mut self.unknown)?
        } else {
            let count = fields(line, separator).count();
            if let Some((time, rest)) = decimal_comma(line, columns, count) {
                if !self.decimal_commas {
                    return Err(format!(
                        "{} has one field more than the header, probably because of a decimal comma; use decimal points, or semicolons between fields",
                        quoted(line)
                    ));
                }
                let all = core::iter::once(time).chain(fields(rest, separator));
                row(all, count - 1, columns, &mut self.unknown)?
            } else {
                row(fields(line, separator), count, columns, &mut self.unknown)?
            }
        };
        let tick = columns.times.tick(time, &mut self.recorder)?;
        self.recorder.levels(tick, levels)
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        let found = match self.columns {
            Some(columns) => {
                columns.times.finish(&mut self.recorder);
                Ok(())
            }
            None => Err("the table has no header; use one such as time_us,STEP,DIR".into()),
        };
        self.recorder.note_unknown_levels(self.unknown, "X: no data");
        let mut capture = self.recorder.finish();
        if capture.timebase.is_none() {
            capture.timebase = self.rate.get().and_then(period);
        }
        let found = if found.is_ok() && capture.is_empty() { Err(NO_ROWS.into()) } else { found };
        (capture, found)
    }
}

/// Joins a time that a decimal comma has split.
fn decimal_comma<'l>(line: &'l [u8], columns: &Columns, count: usize) -> Option<(&'l [u8], &'l [u8])> {
    let split = columns.separator == b',' && count == columns.list.len() + 1;
    if !split || !matches!(columns.list.first(), Some(Column::Time)) {
        return None;
    }
    let comma = line.iter().position(|byte| *byte == b',')?;
    let (before, after) = (line.get(..comma)?, line.get(comma + 1..)?);
    let end = after.iter().position(|byte| *byte == b',')?;
    let digits = after.get(..end)?;
    let is_number = |text: &[u8]| !text.is_empty() && text.iter().all(u8::is_ascii_digit);
    let sign = before.strip_prefix(b"-").unwrap_or(before);
    (is_number(sign) && is_number(digits)).then_some((line.get(..comma + 1 + end)?, after.get(end + 1..)?))
}

fn row<'l>(
    all: impl Iterator<Item = &'l [u8]>,
    count: usize,
    columns: &Columns,
    unknown: &mut u64,
) -> Result<(&'l [u8], u64), String> {
    let (mut time, mut levels) = (&[][..], 0_u64);
    let mut all = all.fuse();
    for column in &columns.list {
        let field = all.next().unwrap_or_default();
        match column {
            Column::Time => time = field,
            Column::Other => {}
            Column::Level(bit, name) => match field {
                b"0" => {}
                b"1" => levels |= bit.map_or(0, |bit| 1 << bit),
                b"X" | b"x" => *unknown += 1,
                _ => return Err(not_a_level(name, field)),
            },
        }
    }
    if count > columns.list.len() && all.any(|field| !field.is_empty()) {
        return Err(format!(
            "{count} fields, but the header has {}; use the same number",
            columns.list.len()
        ));
    }
    Ok((time, levels))
}

const NO_ROWS: &str = "the table has no rows after its header; record again or export the complete recording";
