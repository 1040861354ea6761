//! Times that are written as decimals, as whole ticks: the time base follows the longest of them.
//!
//! ```text
//! 0.001      places 3, tick 1           the time base is 1 ms
//! 0.00125    places 5, tick 125         and now 10 us: the tick before becomes 100
//! ```

use super::{
    decimal::{Decimal, power_of_ten},
    recorder::{Recorder, quoted},
};
use crate::timebase::Timebase;

/// Most places behind the point: ticks of 1 as.
const MAX_PLACES: u32 = 18;
/// Most places that are taken over from the first time even where they are zeros.
const MAX_FIRST_PLACES: u32 = 12;

/// In what a table's times are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TimeUnit {
    /// `10^-places` seconds: 0 for s, 3 for ms.
    Seconds(u32),
    /// Whole cycles of a clock that the file does not tell.
    Cycles,
}

impl TimeUnit {
    /// A unit as it is written: `s`, `ms`, `µs`, `cycles`.
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

    /// The unit of a table's column of times by its name: `Time [s]`, `t_ms`, `cycle`; `None` where it is no such name.
    pub(super) fn of_column(name: &str) -> Option<Self> {
        let name = name.trim().to_lowercase();
        if let Some(unit) = Self::parse(&name).filter(|_| name.len() > 2) {
            return Some(unit);
        }
        let rest =
            ["timestamp", "start_time", "time", "t"].iter().find_map(|prefix| name.strip_prefix(prefix))?;
        let unit = rest.trim_matches(|letter: char| " _-[](){}/,".contains(letter));
        match unit {
            "" => Some(Self::Seconds(0)),
            unit if unit.len() < rest.len() => Self::parse(unit),
            _ => None,
        }
    }
}

/// The ticks of a file's times.
pub(super) struct Times {
    unit: TimeUnit,
    /// Places of the time base; `None` before the first time.
    places: Option<u32>,
    /// The time of tick 0, in ticks.
    origin: i128,
    /// The first time, where it is not tick 0 by itself.
    shifted_by: Option<String>,
}

impl Times {
    pub(super) const fn new(unit: TimeUnit) -> Self {
        Self { unit, places: None, origin: 0, shifted_by: None }
    }

    /// The tick of a time in the column's unit, not before the last tick that `recorder` has.
    pub(super) fn tick(&mut self, text: &[u8], recorder: &mut Recorder) -> Result<u64, String> {
        let time = match (Decimal::parse(text), self.unit) {
            (Some(time), TimeUnit::Seconds(0)) => time,
            (Some(time), TimeUnit::Seconds(places)) => Decimal { places: time.places + places, ..time },
            (Some(time), TimeUnit::Cycles) => {
                let whole = time.whole().filter(|cycle| *cycle >= 0);
                let mantissa = whole
                    .ok_or_else(|| format!("{} is not a cycle; give a whole number from 0", quoted(text)))?;
                Decimal { mantissa, places: 0 }
            }
            (None, _) => return self.date(text, recorder),
        };
        self.tick_of(time, text, recorder)
    }

    /// The tick of a time in s.
    pub(super) fn tick_of(
        &mut self,
        time: Decimal,
        text: &[u8],
        recorder: &mut Recorder,
    ) -> Result<u64, String> {
        let too_long = || format!("the time {} has more digits than fit: at most 19 are kept", quoted(text));
        let places = match self.places {
            Some(places) => places,
            None => {
                let places = time.places.min(MAX_FIRST_PLACES);
                self.places = Some(places);
                if time.mantissa < 0 {
                    self.begin_at(time, text);
                }
                places
            }
        };
        let mut time = time.with_places(places).ok_or_else(too_long)?;
        if time.places > places {
            time = self.refine(time, recorder).ok_or_else(too_long)?;
        }
        let tick = time.mantissa - self.origin;
        if tick < i128::from(recorder.capture.end) {
            return Err(format!(
                "the time {} is before the one of the row before; times must rise: sort the rows by time",
                quoted(text)
            ));
        }
        u64::try_from(tick).map_err(|_| too_long())
    }

    /// The first time becomes tick 0.
    fn begin_at(&mut self, first: Decimal, text: &[u8]) {
        self.shifted_by = Some(quoted(text));
        self.places = Some(first.places.min(MAX_PLACES));
        self.origin = first.with_places(first.places.min(MAX_PLACES)).map_or(0, |first| first.mantissa);
    }

    /// Makes the time base as fine as this time needs.
    fn refine(&mut self, time: Decimal, recorder: &mut Recorder) -> Option<Decimal> {
        let places = self.places?;
        if time.places > MAX_PLACES {
            return None;
        }
        let factor = power_of_ten(time.places - places)?;
        let ticks = u64::try_from(factor).ok()?;
        let origin = self.origin.checked_mul(factor)?;
        recorder.retime(|tick| tick.checked_mul(ticks))?;
        (self.origin, self.places) = (origin, Some(time.places));
        Some(time)
    }

    /// The tick of a date and time (ISO 8601), the first of which is tick 0.
    fn date(&mut self, text: &[u8], recorder: &mut Recorder) -> Result<u64, String> {
        let time = date(text).filter(|_| self.unit == TimeUnit::Seconds(0)).ok_or_else(|| {
            format!("{} is not a time; give a number, such as 0.00125 or 1.25e-3", quoted(text))
        })?;
        if self.places.is_none() {
            self.begin_at(time, text);
        }
        self.tick_of(time, text, recorder)
    }

    /// Tells the recorder the time base, and where tick 0 is.
    pub(super) fn finish(self, recorder: &mut Recorder) {
        if let (TimeUnit::Seconds(_), Some(places)) = (self.unit, self.places) {
            let denominator = power_of_ten(places).and_then(|power| u64::try_from(power).ok());
            recorder.capture.timebase = denominator.and_then(|denominator| Timebase::new(1, denominator));
        }
        if let Some(first) = self.shifted_by {
            recorder.leave_out(format!(
                "the first time is {first}: it is taken as 0, and all others count from it"
            ));
        }
    }
}

/// Seconds since 1970 of a date and time such as `2026-01-31T12:34:56.789012+01:00`.
fn date(text: &[u8]) -> Option<Decimal> {
    let text = core::str::from_utf8(text).ok()?;
    let number = |from: usize, to: usize| {
        text.get(from..to).and_then(|digits| super::decimal::whole(digits.as_bytes()))
    };
    let mark = |at: usize, allowed: &str| text.get(at..=at).is_some_and(|mark| allowed.contains(mark));
    if !(mark(4, "-") && mark(7, "-") && mark(10, "T ") && mark(13, ":") && mark(16, ":")) {
        return None;
    }
    let (year, month, day) = (number(0, 4)?, number(5, 7)?, number(8, 10)?);
    let (hour, minute, second) = (number(11, 13)?, number(14, 16)?, number(17, 19)?);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let rest = text.get(19..)?;
    let zone = rest.find(['Z', 'z', '+', '-']).unwrap_or(rest.len());
    let (fraction, zone) = rest.split_at(zone);
    let fraction = match fraction.strip_prefix('.') {
        Some(digits) => Decimal::parse(digits.as_bytes())
            .filter(|number| digits.len() <= 12 && number.places == 0 && number.mantissa >= 0)
            .map(|number| Decimal { places: digits.len() as u32, ..number })?,
        None if fraction.is_empty() => Decimal { mantissa: 0, places: 0 },
        None => return None,
    };
    // Days from the first of March of year 0, whose last day of the year is the leap day.
    let (years, months) = if month > 2 { (year, month - 3) } else { (year.checked_sub(1)?, month + 9) };
    let days = 365 * years + years / 4 - years / 100 + years / 400 + (153 * months + 2) / 5 + day - 1;
    let seconds =
        i128::from(days) * 86_400 - 719_468 * 86_400 + i128::from(hour * 3600 + minute * 60 + second);
    let seconds = seconds - i128::from(zone_seconds(zone)?);
    let mantissa = seconds * power_of_ten(fraction.places)? + fraction.mantissa;
    Some(Decimal { mantissa, places: fraction.places })
}

/// Seconds of `Z`, `+01:00` or nothing.
fn zone_seconds(zone: &str) -> Option<i64> {
    if zone.is_empty() || zone.eq_ignore_ascii_case("z") {
        return Some(0);
    }
    let (sign, digits) = zone.split_at_checked(1)?;
    let digits: String = digits.chars().filter(|letter| *letter != ':').collect();
    let number = super::decimal::whole(digits.as_bytes()).filter(|_| digits.len() == 4)?;
    let seconds = i64::try_from(number / 100 * 3600 + number % 100 * 60).ok()?;
    Some(if sign == "-" { -seconds } else { seconds })
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
            ("TX", None),
            ("timer", None),
            ("s", None),
            ("name", None),
        ] {
            assert_eq!(TimeUnit::of_column(name), unit, "{name}");
        }
    }

    #[test]
    fn dates_are_seconds_since_1970() {
        for (text, expected) in [
            ("1970-01-01T00:00:00Z", Some((0, 0))),
            ("2000-02-29T12:00:00.5Z", Some((9_518_256_005, 1))),
            ("2026-01-31 12:34:56.789012+01:00", Some((1_769_859_296_789_012, 6))),
            ("1969-12-31T23:59:59", Some((-1, 0))),
            ("2026-13-01T00:00:00Z", None),
            ("2026-01-01", None),
            ("0000-01-01T00:00:00Z", None),
        ] {
            assert_eq!(date(text.as_bytes()).map(|time| (time.mantissa, time.places)), expected, "{text}");
        }
    }
}
