//! Converts decimal times to whole ticks. The longest time so far sets the time base.
//!
//! ```text
//! 0.001      places 3, tick 1           the time base is 1 ms
//! 0.00125    places 5, tick 125         and now 10 us: the tick before becomes 100
//! ```
//!
//! Ticks have 64 bits. Times with more places than fit, such as 5.000000000000013e-06, are rounded to the nearest tick,
//! and a note reports it.

use super::clock::{Dated, Stamp};
use super::decimal::{Decimal, power_of_ten};
use super::recorder::{Recorder, quoted};
use crate::timebase::Timebase;
use core::{cmp::Ordering, ops::Range};

/// Maximum decimal places: ticks of 1 as.
const MAX_PLACES: u32 = 18;
/// Maximum decimal places of the first time, including trailing zeros.
const MAX_FIRST_PLACES: u32 = 12;
/// Minimum decimal places of long recordings: 1 ns.
const MIN_PLACES: u32 = 9;
/// A first time in this range (s) counts from 1970 or from the start of a long-running clock: it becomes tick 0.
const EPOCH_S: Range<i128> = 100_000_000..100_000_000_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeUnit {
    Seconds(u32),
    /// The file does not give the clock rate.
    Cycles,
}

impl TimeUnit {
    pub(super) fn parse(text: &str) -> Option<Self> {
        Some(match text.to_lowercase().as_str() {
            "s" | "sec" | "secs" | "second" | "seconds" => Self::Seconds(0),
            "ms" | "msec" | "millisecond" | "milliseconds" => Self::Seconds(3),
            "us" | "usec" | "µs" | "μs" | "microsecond" | "microseconds" => Self::Seconds(6),
            "ns" | "nsec" | "nanosecond" | "nanoseconds" => Self::Seconds(9),
            "ps" | "picosecond" | "picoseconds" => Self::Seconds(12),
            "cycle" | "cycles" | "tick" | "ticks" => Self::Cycles,
            _ => return None,
        })
    }

    pub(super) fn of_column(name: &str) -> Option<Self> {
        Self::named(name).map(|(unit, _)| unit)
    }

    pub(super) fn is_stated(name: Option<&String>) -> bool {
        name.and_then(|name| Self::named(name)).is_some_and(|(_, stated)| stated)
    }

    /// The unit, and whether the name gives it: `Time` alone means s by default.
    pub(super) fn named(name: &str) -> Option<(Self, bool)> {
        let lower = name.trim().to_lowercase();
        let words: Vec<&str> = lower.split(|letter: char| !letter.is_alphanumeric()).collect();
        let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty() && *word != "in").collect();
        let is_time = |word: &&str| TIME_WORDS.contains(word);
        match words.as_slice() {
            ["sample" | "samples" | "samplenum" | "index"]
            | ["sample", "number" | "no" | "num" | "nr" | "index"] => Some((Self::Cycles, true)),
            ["start" | "elapsed"] => None,
            [word] if is_time(word) => Some((Self::Seconds(0), false)),
            // `s` is too short to be a time.
            [word] if *word != "s" => {
                let unit = match *word {
                    "micros" => Some(Self::Seconds(6)),
                    "millis" => Some(Self::Seconds(3)),
                    "nanos" => Some(Self::Seconds(9)),
                    word => Self::parse(word),
                };
                unit.or_else(|| camel_case_unit(name.trim())).map(|unit| (unit, true))
            }
            [.., word] if words.iter().any(is_time) => match Self::parse(word) {
                Some(unit) => Some((unit, true)),
                None => words.iter().all(is_time).then_some((Self::Seconds(0), false)),
            },
            _ => None,
        }
    }
}

const TIME_WORDS: [&str; 7] = ["t", "time", "timestamp", "ts", "start", "elapsed", "uptime"];

/// The unit of a name such as `timeUs`.
fn camel_case_unit(name: &str) -> Option<TimeUnit> {
    let unit = name.find(|letter: char| letter.is_uppercase()).filter(|at| *at > 0)?;
    let (time, unit) = name.split_at(unit);
    TIME_WORDS.contains(&time).then(|| TimeUnit::parse(unit)).flatten()
}

pub(super) struct Times {
    unit: TimeUnit,
    places: Option<u32>,
    origin: Decimal,
    is_rounded: bool,
    shifted_by: Option<String>,
    /// For times without a date: whole days so far, and the latest time of day.
    days: i128,
    latest: Option<Decimal>,
    ambiguous_date: Option<[u64; 3]>,
}

const DAY_S: i128 = 86_400;

impl Times {
    pub(super) const fn new(unit: TimeUnit) -> Self {
        Self {
            unit,
            places: None,
            origin: Decimal { mantissa: 0, places: 0 },
            is_rounded: false,
            shifted_by: None,
            days: 0,
            latest: None,
            ambiguous_date: None,
        }
    }

    pub(super) fn tick(&mut self, text: &[u8], recorder: &mut Recorder) -> Result<u64, String> {
        let time = match (Decimal::parse_with_comma(text), self.unit) {
            (Some(time), TimeUnit::Seconds(0)) => time,
            (Some(time), TimeUnit::Seconds(places)) => Decimal { places: time.places + places, ..time },
            (Some(time), TimeUnit::Cycles) => {
                let whole = time.whole().filter(|cycle| *cycle >= 0);
                let mantissa = whole.ok_or_else(|| {
                    format!("{} is not a cycle number; use a whole number from 0", quoted(text))
                })?;
                Decimal { mantissa, places: 0 }
            }
            (None, _) => return self.clock_tick(text, recorder),
        };
        self.tick_of(time, text, recorder)
    }

    pub(super) fn tick_of(
        &mut self,
        time: Decimal,
        text: &[u8],
        recorder: &mut Recorder,
    ) -> Result<u64, String> {
        let too_long = || {
            format!(
                "the time {} does not fit into 64 bits; use times relative to the start of the recording",
                quoted(text)
            )
        };
        if self.places.is_none() {
            self.places = Some(time.places.min(MAX_FIRST_PLACES));
            let is_epoch = self.unit != TimeUnit::Cycles
                && time.rounded(0).is_some_and(|seconds| EPOCH_S.contains(&seconds.mantissa));
            if time.mantissa < 0 || is_epoch {
                self.set_origin(time, text);
            }
        }
        let since = time.minus(self.origin).ok_or_else(too_long)?;
        let tick = if since.mantissa < 0 {
            None
        } else {
            Some(self.refined_tick(since, recorder).ok_or_else(too_long)?)
        };
        tick.filter(|tick| *tick >= recorder.capture.end).ok_or_else(|| {
            format!("the time {} is before the time of the previous row; sort the rows by time", quoted(text))
        })
    }

    fn set_origin(&mut self, first: Decimal, text: &[u8]) {
        self.shifted_by = Some(quoted(text));
        self.origin = first;
    }

    /// The tick of a time. Refines the time base first if the time has more places and the ticks still fit.
    fn refined_tick(&mut self, since: Decimal, recorder: &mut Recorder) -> Option<u64> {
        let base = self.places?;
        let needed = since.with_places(base).map_or(since.places.max(base), |since| since.places);
        for places in (base.min(MIN_PLACES)..=needed.min(MAX_PLACES)).rev() {
            let Some(tick) = since.rounded(places).and_then(|since| u64::try_from(since.mantissa).ok())
            else {
                continue;
            };
            let factor = power_of_ten(places.abs_diff(base)).and_then(|factor| u64::try_from(factor).ok())?;
            let is_retimed = match places.cmp(&base) {
                Ordering::Equal => Some(()),
                Ordering::Greater => recorder.retime(|tick| tick.checked_mul(factor)),
                Ordering::Less => recorder.coarsen(factor),
            };
            if is_retimed.is_some() {
                self.is_rounded |= places < needed;
                self.places = Some(places);
                return Some(tick);
            }
        }
        None
    }

    fn clock_tick(&mut self, text: &[u8], recorder: &mut Recorder) -> Result<u64, String> {
        let stamp = Stamp::parse(text)
            .filter(|stamp| self.unit == TimeUnit::Seconds(0) && stamp.length == text.len())
            .ok_or_else(|| {
                format!("{} is not a time; use a number such as 0.00125 or 1.25e-3", quoted(text))
            })?;
        self.stamp_tick(stamp, text, recorder)
    }

    /// Without dates, a time that falls by more than half a day belongs to the next day.
    pub(super) fn stamp_tick(
        &mut self,
        stamp: Stamp,
        text: &[u8],
        recorder: &mut Recorder,
    ) -> Result<u64, String> {
        let mut time = stamp.seconds;
        if let Dated::Ambiguous(date) = stamp.dated
            && *self.ambiguous_date.get_or_insert(date) != date
        {
            return Err(format!(
                "{} is on another day, and the order of day and month is unclear; use dates such as 2026-11-26",
                quoted(text)
            ));
        }
        if stamp.dated == Dated::No {
            let before = self.latest.replace(time);
            let fell = |before: Decimal| {
                let places = before.places.max(time.places);
                let whole = |time: Decimal| time.with_places(places).map(|time| time.mantissa);
                let fall = whole(before)?.checked_sub(whole(time)?)?;
                Some(fall > power_of_ten(places)? * (DAY_S / 2))
            };
            if before.and_then(fell) == Some(true) {
                self.days += 1;
            }
            let days = power_of_ten(time.places).and_then(|second| second.checked_mul(self.days * DAY_S));
            time.mantissa += days.unwrap_or(0);
        }
        if self.places.is_none() {
            self.set_origin(time, text);
        }
        self.tick_of(time, text, recorder)
    }

    pub(super) fn finish(self, recorder: &mut Recorder) {
        if let (TimeUnit::Seconds(_), Some(places)) = (self.unit, self.places) {
            let denominator = power_of_ten(places).and_then(|power| u64::try_from(power).ok());
            recorder.capture.timebase = denominator.and_then(|denominator| Timebase::new(1, denominator));
        }
        if self.is_rounded {
            recorder.note(format!(
                "times have too many decimal places and are rounded to the nearest 1e-{} s",
                self.places.unwrap_or(MAX_PLACES)
            ));
        }
        if self.days > 0 {
            let times = if self.days == 1 { "once".into() } else { format!("{} times", self.days) };
            recorder.note(format!("the clock passes midnight {times}; later times belong to the next day"));
        }
        if let Some(first) = self.shifted_by {
            recorder.note(format!(
                "the first time is {first} and is read as 0; all other times are relative to it"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_times_are_known_by_their_names() {
        for (name, unit) in [
            ("Time [s]", Some(TimeUnit::Seconds(0))),
            ("Time[s]", Some(TimeUnit::Seconds(0))),
            ("time_s", Some(TimeUnit::Seconds(0))),
            ("t", Some(TimeUnit::Seconds(0))),
            ("Time", Some(TimeUnit::Seconds(0))),
            ("t_us", Some(TimeUnit::Seconds(6))),
            ("Time (µs)", Some(TimeUnit::Seconds(6))),
            ("time_ns", Some(TimeUnit::Seconds(9))),
            ("nanoseconds", Some(TimeUnit::Seconds(9))),
            ("cycle", Some(TimeUnit::Cycles)),
            ("time [cycles]", Some(TimeUnit::Cycles)),
            ("t/ms", Some(TimeUnit::Seconds(3))),
            ("time [us]", Some(TimeUnit::Seconds(6))),
            ("micros", Some(TimeUnit::Seconds(6))),
            ("millis", Some(TimeUnit::Seconds(3))),
            ("µs", Some(TimeUnit::Seconds(6))),
            ("ns", Some(TimeUnit::Seconds(9))),
            ("timeUs", Some(TimeUnit::Seconds(6))),
            ("Timestamp (ms)", Some(TimeUnit::Seconds(3))),
            ("Time in µs", Some(TimeUnit::Seconds(6))),
            ("Elapsed time [s]", Some(TimeUnit::Seconds(0))),
            ("Sample", Some(TimeUnit::Cycles)),
            ("sample number", Some(TimeUnit::Cycles)),
            ("start_time", Some(TimeUnit::Seconds(0))),
            ("start", None),
            ("time step", None),
            ("TX", None),
            ("timer", None),
            ("s", None),
            ("name", None),
        ] {
            assert_eq!(TimeUnit::of_column(name), unit, "{name}");
        }
    }
}
