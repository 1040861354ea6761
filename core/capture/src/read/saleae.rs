//! Reads Saleae Logic's tables of decoded bytes: Logic 2's data table, and the export of one analyzer.
//!
//! ```text
//! name,type,start_time,duration,data                      Time [s],Value,Parity Error,Framing Error
//! "Async Serial","data",0.00125,8.68e-05,0x55             0.001250000000000,0x55,,
//! ```
//!
//! Each analyzer is a channel. [`super::levels`] reads the table of levels.

use super::fields::{Fields, separator};
use super::reading::Reader;
use super::recorder::{Names, Recorder, quoted};
use super::times::{TimeUnit, Times};
use crate::capture::{Capture, TimedByte};

const UNNAMED: &str = "serial";

pub(super) struct DecodedBytes {
    recorder: Recorder,
    columns: Option<Columns>,
    fields: Fields,
    times: Times,
    others: Names,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Columns {
    separator: u8,
    name: Option<usize>,
    kind: Option<usize>,
    time: usize,
    unit: TimeUnit,
    value: usize,
    error: Option<usize>,
}

impl Columns {
    fn find(names: &[String], separator: u8) -> Option<Self> {
        let names: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
        let at = |wanted: &[&str]| names.iter().position(|name| wanted.contains(&name.as_str()));
        let time =
            names.iter().position(|name| name == "start_time" || TimeUnit::of_column(name).is_some())?;
        let value = at(&["data", "value", "decoded protocol result"])?;
        let error = at(&["framing error", "error", "framing_error"]);
        let (name, kind) = (at(&["name", "analyzer name"]), at(&["type", "frame type"]));
        // `t,data` alone is a table of hexadecimal bytes.
        if error.is_none() && name.is_none() {
            return None;
        }
        let unit = names.get(time).and_then(|name| TimeUnit::of_column(name)).unwrap_or(TimeUnit::Seconds(0));
        Some(Self { separator, name, kind, time, unit, value, error })
    }
}

pub(super) fn is_header(names: &[String], separator: u8) -> bool {
    Columns::find(names, separator).is_some()
}

impl DecodedBytes {
    pub(super) const fn new(recorder: Recorder) -> Self {
        let times = Times::new(TimeUnit::Seconds(0));
        Self { recorder, columns: None, fields: Fields::new(), times, others: Names::new() }
    }

    fn read_header(&mut self, line: &[u8]) -> Result<(), String> {
        let separator = separator(line);
        self.fields.split(line, separator)?;
        let columns = Columns::find(&self.fields.names(), separator).ok_or(
            "the header has no time or no value; use columns such as name,type,start_time,duration,data",
        )?;
        self.times = Times::new(columns.unit);
        self.columns = Some(columns);
        Ok(())
    }

    fn channel(&mut self, name: &str) -> Option<u8> {
        let known = self.recorder.capture.channels.iter().position(|channel| channel.name == name);
        known.and_then(|at| u8::try_from(at).ok()).or_else(|| self.recorder.channel(name))
    }
}

impl Reader for DecodedBytes {
    fn take(&mut self, line: &[u8]) -> Result<(), String> {
        if line.trim_ascii().is_empty() {
            return Ok(());
        }
        let Some(columns) = self.columns.clone() else { return self.read_header(line) };
        self.fields.split(line, columns.separator)?;
        if self.fields.len() <= columns.time.max(columns.value) {
            return Err(format!(
                "{} has {} fields, fewer than the header; export again, the row is incomplete",
                quoted(line),
                self.fields.len()
            ));
        }
        let tick = self.times.tick(self.fields.get(columns.time), &mut self.recorder)?;
        self.recorder.capture.end = tick;
        let kind = columns.kind.map_or(&b"data"[..], |at| self.fields.get(at));
        if kind != b"data" && kind != b"result" {
            self.others.add(&String::from_utf8_lossy(kind));
            return Ok(());
        }
        let field = self.fields.get(columns.value);
        let byte = value(field).ok_or_else(|| {
            format!("{} is not a byte; use hexadecimal (0x55) or decimal (0 to 255) data", quoted(field))
        })?;
        let error = columns.error.map_or(&b""[..], |at| self.fields.get(at)).to_ascii_lowercase();
        let framing_error =
            !matches!(&error[..], b"" | b"0" | b"false" | b"none") && !error.starts_with(b"parity");
        let name = columns
            .name
            .map_or_else(|| UNNAMED.into(), |at| String::from_utf8_lossy(self.fields.get(at)).into_owned());
        match self.channel(if name.is_empty() { UNNAMED } else { &name }) {
            Some(channel) => self.recorder.byte(TimedByte { tick, channel, byte, framing_error }),
            None => Ok(()),
        }
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        self.times.finish(&mut self.recorder);
        self.recorder.note_skipped("rows without bytes", &self.others);
        let capture = self.recorder.finish();
        let missing = if capture.is_empty() {
            Err("the table has no bytes; record or export again".into())
        } else {
            Ok(())
        };
        (capture, missing)
    }
}

/// `0x55`, `85`, `U (0x55)`.
fn value(field: &[u8]) -> Option<u8> {
    let field = match field.iter().rposition(|byte| *byte == b'(') {
        Some(open) if field.ends_with(b")") => field.get(open + 1..field.len() - 1)?,
        _ => field,
    };
    let text = core::str::from_utf8(field).ok()?;
    match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
        Some(digits) if digits.bytes().all(|byte| byte.is_ascii_hexdigit()) => {
            u8::from_str_radix(digits, 16).ok()
        }
        Some(_) => None,
        None => super::decimal::whole(field).and_then(|value| u8::try_from(value).ok()),
    }
}
