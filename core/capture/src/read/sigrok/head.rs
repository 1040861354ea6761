//! Reads the lines before the samples: comments, output of sigrok-cli, and labels.

use crate::read::decimal::{Decimal, power_of_ten, whole};
use crate::read::fields::{Fields, SEPARATORS, separator};
use crate::read::sample_rate::{SampleRate, period};
use crate::read::times::TimeUnit;
use crate::timebase::Timebase;

#[derive(Default)]
pub(in crate::read) struct Head {
    names: Vec<String>,
    rate: SampleRate,
    /// Number of the current line.
    pub(super) line: u64,
    labels: Vec<String>,
    separator: Option<u8>,
}

pub(super) enum ColumnKind {
    Time,
    Trigger,
    Level(String),
    Analog(String),
}

/// How a row's sample is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowClock {
    /// Each row is one sample.
    Count,
    /// Times are in 1/`units_per_s` s; each sample lasts `units_per_sample` of them, rounded down.
    FixedPeriod {
        units_per_s: u64,
        units_per_sample: u64,
    },
    /// Each time was rounded down on its own, so the sample is the first one not earlier than it.
    TruncatedTime {
        units_per_s: u64,
    },
    Time,
}

/// A row may also be separated by `:` or spaces, which labels may contain.
const ROW_SEPARATORS: [u8; 6] = *b",;\t|: ";

impl Head {
    /// Reads a line of the head. Returns false if the line is the first row of samples instead.
    pub(super) fn read_line(&mut self, line: &[u8]) -> Result<bool, String> {
        let text = String::from_utf8_lossy(line);
        if is_comment(line) {
            let text = text.trim_start_matches(|letter: char| letter.is_ascii_punctuation() || letter == ' ');
            if let Some(rate) =
                text.strip_prefix("Samplerate:").or_else(|| text.strip_prefix("META samplerate:"))
            {
                self.rate.set(rate.trim(), self.line)?;
            } else if let Some((_, names)) =
                text.strip_prefix("Channels (").and_then(|text| text.split_once("):"))
            {
                self.names = names.split(", ").map(|name| name.trim().into()).collect();
            }
            return Ok(true);
        }
        if !self.labels.is_empty() || is_row(line) {
            return Ok(false);
        }
        let separator =
            if line.iter().any(|byte| SEPARATORS.contains(byte)) { separator(line) } else { b' ' };
        let mut fields = Fields::new();
        fields.split(line, separator)?;
        self.labels = fields.names();
        self.separator = Some(separator);
        Ok(true)
    }

    pub(super) fn separator(&self, row: &[u8]) -> u8 {
        let own = row.iter().find(|byte| ROW_SEPARATORS.contains(byte)).copied();
        self.separator.filter(|separator| row.contains(separator)).or(own).unwrap_or(b',')
    }

    pub(super) fn columns(&self, row: &Fields) -> Vec<ColumnKind> {
        let first_channel = usize::from(self.has_time_column(row));
        (0..row.len()).map(|at| self.column_kind(at, first_channel, row)).collect()
    }

    fn label(&self, at: usize) -> Option<&str> {
        self.labels.get(at).map(String::as_str)
    }

    fn has_time_column(&self, row: &Fields) -> bool {
        let (count, named) = (row.len(), self.names.len());
        match self.label(0) {
            Some("samples") => true,
            Some(label) => TimeUnit::of_column(label).is_some() && count != named,
            None if named > 0 => count > named,
            None => count > 1 && !is_level(row.get(0)),
        }
    }

    fn column_kind(&self, at: usize, first_channel: usize, row: &Fields) -> ColumnKind {
        let Some(channel) = at.checked_sub(first_channel) else { return ColumnKind::Time };
        let (label, named) = (self.label(at), self.names.len());
        let has_no_name = named > 0 && channel >= named;
        if at + 1 == row.len() && (label == Some("Trigger") || has_no_name) {
            return ColumnKind::Trigger;
        }
        // The label row of sigrok's CSV has types (`logic`, `V DC`) instead of names.
        let labels_are_kinds = self.labels.iter().any(|label| label == "logic");
        let name = self.names.get(channel).map(String::as_str).or(label.filter(|_| !labels_are_kinds));
        let name = name.map_or_else(|| format!("D{channel}"), Into::into);
        let is_analog = labels_are_kinds && label != Some("logic") || !is_level(row.get(at));
        if is_analog { ColumnKind::Analog(name) } else { ColumnKind::Level(name) }
    }

    pub(super) fn clock(&self) -> RowClock {
        // The label `samples`: sigrok did not know the rate, and all times are 0.
        if self.label(0) == Some("samples") {
            return RowClock::Count;
        }
        if let Some(rate_hz) = self.rate_hz() {
            // sigrok uses the first of these units in which a sample lasts at least 1.
            let units = [0, 3, 6, 9, 12].map(|places| 10_u64.pow(places));
            if let Some(units_per_s) = units.into_iter().find(|units_per_s| *units_per_s >= rate_hz) {
                return RowClock::FixedPeriod { units_per_s, units_per_sample: units_per_s / rate_hz };
            }
        }
        match self.label(0).and_then(TimeUnit::of_column) {
            Some(TimeUnit::Seconds(_)) => RowClock::Time,
            _ => RowClock::Count,
        }
    }

    pub(super) fn rate_hz(&self) -> Option<u64> {
        self.rate.get().and_then(Decimal::whole).and_then(|rate| u64::try_from(rate).ok())
    }

    pub(super) fn timebase(&self, clock: RowClock) -> Option<Timebase> {
        let unit = |places: u32| u64::try_from(power_of_ten(places)?).ok();
        if clock == RowClock::Time {
            return match self.label(0).and_then(TimeUnit::of_column) {
                Some(TimeUnit::Seconds(places)) => Timebase::new(1, unit(places)?),
                _ => None,
            };
        }
        self.rate.get().and_then(period)
    }
}

/// Comments, and output of sigrok-cli in the same file: `META samplerate: 1000000`, `A0: -10.00 V DC`.
pub(in crate::read) fn is_comment(line: &[u8]) -> bool {
    if line.first().is_none_or(u8::is_ascii_digit) {
        return false;
    }
    line.starts_with(b"META ")
        || line.windows(9).any(|text| text == b"libsigrok")
        || matches!(line, [b';' | b'#' | b'%' | b'/' | b'!' | b'*', ..]) && !is_row(line)
        || is_analog_value(line)
}

fn is_analog_value(line: &[u8]) -> bool {
    let mut words = line.split(|byte| *byte == b' ');
    words.next().is_some_and(|name| name.ends_with(b":") && name.len() > 1)
        && words.next().is_some_and(|value| Decimal::parse(value).is_some())
        && words.next().is_some()
}

fn is_level(field: &[u8]) -> bool {
    matches!(field, b"0" | b"1")
}

fn is_row(line: &[u8]) -> bool {
    let end = line.iter().position(|byte| ROW_SEPARATORS.contains(byte)).unwrap_or(line.len());
    line.get(..end).is_some_and(|first| whole(first).is_some() || Decimal::parse(first).is_some())
}
