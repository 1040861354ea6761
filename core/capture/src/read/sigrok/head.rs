//! What stands before the samples: comments, what sigrok-cli says beside them, and a row of labels.

use crate::{
    read::{
        decimal::{Decimal, power_of_ten, whole},
        fields::{Fields, separator},
        times::TimeUnit,
    },
    timebase::Timebase,
};

/// What was said before the first row.
pub(in crate::read) struct Head {
    /// Names of the channels, by the comment.
    names: Vec<String>,
    rate: Option<Decimal>,
    /// The row of labels: units of the columns, or names.
    labels: Vec<String>,
    separator: Option<u8>,
}

/// What a column is.
pub(super) enum Kind {
    Time,
    Trigger,
    Level(String),
    Analogue(String),
}

/// Which sample a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowClock {
    /// The next.
    Count,
    /// Its time in units of 1/`units` s, by this many of them for a sample.
    Period { period: u64, units: u64 },
    /// The last that is not after its time: for times that are cut off one by one.
    Nearest { units: u64 },
    /// Its time itself.
    Time,
}

impl Head {
    pub(super) const fn new() -> Self {
        Self { names: Vec::new(), rate: None, labels: Vec::new(), separator: None }
    }

    /// Takes a line; false where it is a row of samples.
    pub(super) fn take(&mut self, line: &[u8]) -> Result<bool, String> {
        let text = String::from_utf8_lossy(line);
        if is_comment(line) {
            let text = text.trim_start_matches(|letter: char| letter.is_ascii_punctuation() || letter == ' ');
            if let Some(rate) =
                text.strip_prefix("Samplerate:").or_else(|| text.strip_prefix("META samplerate:"))
            {
                let rate = parse_rate(rate.trim());
                if self.rate.is_some() && rate != self.rate {
                    return Err("the head gives two sample rates; export again".into());
                }
                self.rate = rate;
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

    /// What separates the fields of the rows.
    pub(super) fn separator(&self, row: &[u8]) -> u8 {
        let own = row.iter().find(|byte| b",;\t|: ".contains(byte)).copied();
        self.separator.filter(|separator| row.contains(separator)).or(own).unwrap_or(b',')
    }

    /// What the columns are, by the labels, and by the first row where labels do not tell.
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
                Kind::Analogue(channel(at))
            } else {
                Kind::Level(channel(at))
            }
        };
        (0..count).map(kind).collect()
    }

    /// How a column of times tells the sample.
    pub(super) fn clock(&self) -> RowClock {
        // sigrok writes this where it did not know the rate in time; its times are then all 0.
        if self.labels.first().is_some_and(|label| label == "samples") {
            return RowClock::Count;
        }
        if let Some(rate_hz) = self.rate_hz() {
            // sigrok's unit is the first of s, ms, us, ns and ps in which a sample lasts at least 1.
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

    /// The sample rate where it is a whole number of Hz.
    pub(super) fn rate_hz(&self) -> Option<u64> {
        self.rate.and_then(Decimal::whole).and_then(|rate| u64::try_from(rate).ok())
    }

    /// How long a tick is.
    pub(super) fn timebase(&self, clock: RowClock) -> Option<Timebase> {
        let unit = |places: u32| u64::try_from(power_of_ten(places)?).ok();
        if clock == RowClock::Time {
            let label = self.labels.first().and_then(|label| TimeUnit::of_column(label));
            return match label {
                Some(TimeUnit::Seconds(places)) => Timebase::new(1, unit(places)?),
                _ => None,
            };
        }
        let rate = self.rate?;
        Timebase::new(unit(rate.places)?, u64::try_from(rate.mantissa).ok()?)
    }
}

/// `24 MHz`, `1.000000007 GHz`, `1000000`: a rate in Hz.
pub(in crate::read) fn parse_rate(text: &str) -> Option<Decimal> {
    let end = text.rfind(|letter: char| letter.is_ascii_digit()).map_or(0, |last| last + 1);
    let (number, unit) = text.split_at(end);
    let exponent = match unit.trim().to_lowercase().as_str() {
        "" | "hz" => 0,
        "khz" | "k" => 3,
        "mhz" | "m" => 6,
        "ghz" | "g" => 9,
        _ => return None,
    };
    Decimal::parse(number.trim().as_bytes())?.shifted(exponent).filter(|rate| rate.mantissa > 0)
}

/// Whether a line says something beside the table: comments, and what sigrok-cli itself prints into the same file, the
/// sample rate (`META samplerate: 1000000`) and analogue values (`A0: -10.00 V DC`).
pub(in crate::read) fn is_comment(line: &[u8]) -> bool {
    if line.first().is_none_or(u8::is_ascii_digit) {
        return false;
    }
    line.starts_with(b"META ")
        || line.windows(9).any(|text| text == b"libsigrok")
        || matches!(line, [b';' | b'#' | b'%' | b'/' | b'!' | b'*', ..]) && !is_row(line)
        || is_analogue_value(line)
}

/// A name, a colon, and a number with its unit.
fn is_analogue_value(line: &[u8]) -> bool {
    let mut words = line.split(|byte| *byte == b' ');
    words.next().is_some_and(|name| name.ends_with(b":") && name.len() > 1)
        && words.next().is_some_and(|value| Decimal::parse(value).is_some())
        && words.next().is_some()
}

/// Whether a line is a row of samples: its first field is a number.
fn is_row(line: &[u8]) -> bool {
    let end = line.iter().position(|byte| b",;\t|: ".contains(byte)).unwrap_or(line.len());
    line.get(..end).is_some_and(|first| whole(first).is_some() || Decimal::parse(first).is_some())
}
