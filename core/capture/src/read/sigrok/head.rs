//! Reads the lines before the samples: comments, output of sigrok-cli, and labels.

use crate::read::decimal::{Decimal, power_of_ten, whole};
use crate::read::fields::{Fields, separator};
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

pub(super) enum Kind {
    Time,
    Trigger,
    Level(String),
    Analog(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowClock {
    Count,
    /// The time in units of 1/`units` s, of which a sample has `period`.
    Period {
        period: u64,
        units: u64,
    },
    /// The last sample that is not later than the time: for times that are truncated one by one.
    Nearest {
        units: u64,
    },
    Time,
}

impl Head {
    /// Returns false for a row of samples.
    pub(super) fn take(&mut self, line: &[u8]) -> Result<bool, String> {
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
        let separator = if line.iter().any(|byte| b",;\t|".contains(byte)) { separator(line) } else { b' ' };
        let mut fields = Fields::new();
        fields.split(line, separator)?;
        self.labels = fields.names();
        self.separator = Some(separator);
        Ok(true)
    }

    pub(super) fn separator(&self, row: &[u8]) -> u8 {
        let own = row.iter().find(|byte| b",;\t|: ".contains(byte)).copied();
        self.separator.filter(|separator| row.contains(separator)).or(own).unwrap_or(b',')
    }

    pub(super) fn columns(&self, row: &Fields) -> Vec<Kind> {
        let label = |at: usize| self.labels.get(at).map(String::as_str);
        let units = self.labels.iter().any(|label| label == "logic");
        let (count, named) = (row.len(), self.names.len());
        let is_level = |at: usize| matches!(row.get(at), b"0" | b"1");
        let first_is_time = match label(0) {
            Some("samples") => true,
            Some(label) => TimeUnit::of_column(label).is_some() && count != named,
            None => named > 0 && count > named || named == 0 && count > 1 && !is_level(0),
        };
        let start = usize::from(first_is_time);
        let channel = |at: usize| {
            let name = self.names.get(at - start).cloned();
            let name = name.or_else(|| label(at).filter(|_| !units).map(Into::into));
            name.unwrap_or_else(|| format!("D{}", at - start))
        };
        let kind = |at: usize| {
            if at < start {
                Kind::Time
            } else if at + 1 == count && (label(at) == Some("Trigger") || named > 0 && at - start >= named) {
                Kind::Trigger
            } else if units && label(at) != Some("logic") || !is_level(at) {
                Kind::Analog(channel(at))
            } else {
                Kind::Level(channel(at))
            }
        };
        (0..count).map(kind).collect()
    }

    pub(super) fn clock(&self) -> RowClock {
        // sigrok writes this if it did not know the rate; all times are then 0.
        if self.labels.first().is_some_and(|label| label == "samples") {
            return RowClock::Count;
        }
        if let Some(rate_hz) = self.rate_hz() {
            // sigrok uses the first of these units in which a sample lasts at least 1.
            let units = [0, 3, 6, 9, 12].map(|places| 10_u64.pow(places));
            if let Some(units) = units.into_iter().find(|units| *units >= rate_hz) {
                return RowClock::Period { period: units / rate_hz, units };
            }
        }
        match self.labels.first().and_then(|label| TimeUnit::of_column(label)) {
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
            let label = self.labels.first().and_then(|label| TimeUnit::of_column(label));
            return match label {
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

fn is_row(line: &[u8]) -> bool {
    let end = line.iter().position(|byte| b",;\t|: ".contains(byte)).unwrap_or(line.len());
    line.get(..end).is_some_and(|first| whole(first).is_some() || Decimal::parse(first).is_some())
}
