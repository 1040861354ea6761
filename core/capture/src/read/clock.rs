//! Reads times of day, with or without a date.
//!
//! ```text
//! 2026-11-26T12:00:00.123456+01:00     2026/11/26 12:00:00,123     26.11.2026 12:00:00.123     12:00:00.123
//! ```

use super::decimal::{Decimal, power_of_ten, whole};

/// Maximum digits of a fraction of a second.
const MAX_FRACTION: usize = 12;
/// Days from March 1 of year 0 to January 1, 1970.
const EPOCH_DAY: i128 = 719_468;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Stamp {
    /// Seconds since 1970, or since midnight without a date.
    pub(super) seconds: Decimal,
    pub(super) dated: Dated,
    pub(super) length: usize,
    pub(super) has_seconds: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dated {
    No,
    Yes,
    /// Day and month cannot be told apart, as in `05/06/2026`.
    Ambiguous([u64; 3]),
}

impl Stamp {
    pub(super) fn parse(text: &[u8]) -> Option<Self> {
        let Some((days, dated, date)) = date(text) else {
            let (seconds, length) = clock(text)?;
            return Some(Self { seconds, dated: Dated::No, length, has_seconds: true });
        };
        let gap = text.get(date).filter(|gap| b"Tt _".contains(gap)).map(|_| date + 1)?;
        let time = text.get(gap..)?;
        let seconds = clock(time);
        let (of_day, clock) = seconds.or_else(|| minutes(time))?;
        let mut length = gap + clock;
        let rest = text.get(length..)?;
        let zone = zone(rest).or_else(|| {
            let (seconds, length) = zone(rest.strip_prefix(b" ").filter(|rest| !rest.starts_with(b"Z"))?)?;
            Some((seconds, length + 1))
        });
        length += zone.map_or(0, |(_, length)| length);
        let before = days * 86_400 - i128::from(zone.map_or(0, |(seconds, _)| seconds));
        let mantissa = before.checked_mul(power_of_ten(of_day.places)?)?.checked_add(of_day.mantissa)?;
        let has_seconds = seconds.is_some();
        Some(Self { seconds: Decimal { mantissa, ..of_day }, dated, length, has_seconds })
    }

    /// `12:34` may also be second_length bytes.
    pub(super) fn without_seconds(text: &[u8]) -> Option<Self> {
        let (seconds, length) = minutes(text)?;
        Some(Self { seconds, dated: Dated::No, length, has_seconds: false })
    }
}

/// A number of up to four digits, and its length.
fn number(text: &[u8]) -> Option<(u64, usize)> {
    let length = text.iter().take(5).take_while(|byte| byte.is_ascii_digit()).count();
    let value = text.get(..length).and_then(whole)?;
    (length <= 4).then_some((value, length))
}

fn date(text: &[u8]) -> Option<(i128, Dated, usize)> {
    let (first, first_length) = number(text)?;
    let mark = *text.get(first_length).filter(|mark| b"-/.".contains(mark))?;
    let (second, second_length) = number(text.get(first_length + 1..)?)?;
    text.get(first_length + 1 + second_length).filter(|other| **other == mark)?;
    let (third, third_length) = number(text.get(first_length + second_length + 2..)?)?;
    let length = first_length + second_length + third_length + 2;
    if first_length == 4 && second_length <= 2 && third_length <= 2 {
        return Some((days(first, second, third)?, Dated::Yes, length));
    }
    if first_length > 2 || second_length > 2 || third_length != 4 {
        return None;
    }
    // With points, or if the number is not a month, the day comes first.
    if mark == b'.' || first > 12 {
        return Some((days(third, second, first)?, Dated::Yes, length));
    }
    if second > 12 {
        return Some((days(third, first, second)?, Dated::Yes, length));
    }
    Some((days(third, second, first)?, Dated::Ambiguous([first, second, third]), length))
}

/// Days since 1970.
fn days(year: u64, month: u64, day: u64) -> Option<i128> {
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // Counting from March 1 of year 0 puts the leap day at the end of the year.
    let (years, months) = if month > 2 { (year, month - 3) } else { (year.checked_sub(1)?, month + 9) };
    let days = 365 * years + years / 4 - years / 100 + years / 400 + (153 * months + 2) / 5 + day - 1;
    Some(i128::from(days) - EPOCH_DAY)
}

/// Seconds of `12:00:00.125`, and the length of the text.
fn clock(text: &[u8]) -> Option<(Decimal, usize)> {
    let (hour, first_length) = number(text).filter(|(_, length)| *length <= 2)?;
    let part = |from: usize| {
        text.get(from).filter(|mark| **mark == b':')?;
        let (value, length) = number(text.get(from + 1..)?)?;
        (length == 2).then_some(value)
    };
    let (minute, second) = (part(first_length)?, part(first_length + 3)?);
    if hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let whole_seconds = i128::from(hour * 3600 + minute * 60 + second);
    let length = first_length + 6;
    let digits = text.get(length + 1..).unwrap_or_default();
    let count = digits.iter().take_while(|digit| digit.is_ascii_digit()).count();
    let has_fraction = match text.get(length) {
        Some(b'.' | b',') => count > 0,
        Some(b':') => count == 3,
        _ => false,
    };
    if !has_fraction {
        return Some((Decimal { mantissa: whole_seconds, places: 0 }, length));
    }
    if count > MAX_FRACTION {
        return None;
    }
    let fraction = digits.get(..count).and_then(whole)?;
    let places = u32::try_from(count).ok()?;
    let mantissa = whole_seconds * power_of_ten(places)? + i128::from(fraction);
    Some((Decimal { mantissa, places }, length + 1 + count))
}

fn minutes(text: &[u8]) -> Option<(Decimal, usize)> {
    let (hour, first_length) = number(text).filter(|(_, length)| *length <= 2)?;
    text.get(first_length).filter(|mark| **mark == b':')?;
    let (minute, second_length) = number(text.get(first_length + 1..)?)?;
    let is_end = match text.get(first_length + 3..).unwrap_or_default() {
        [b':', next, ..] => !next.is_ascii_digit(),
        [next, ..] => !next.is_ascii_alphanumeric(),
        [] => true,
    };
    let mantissa = i128::from(hour * 3600 + minute * 60);
    (hour <= 23 && second_length == 2 && minute <= 59 && is_end)
        .then_some((Decimal { mantissa, places: 0 }, first_length + 3))
}

/// Seconds of a time zone such as `+01:00`, and the length of the text.
fn zone(text: &[u8]) -> Option<(i64, usize)> {
    let sign = match text.first()? {
        b'Z' | b'z' => return Some((0, 1)),
        b'+' => 1,
        b'-' => -1,
        _ => return None,
    };
    let hours = text.get(1..3).and_then(whole)?;
    let minutes = if text.get(3) == Some(&b':') { 4 } else { 3 };
    let minute = text.get(minutes..minutes + 2).and_then(whole)?;
    let seconds = i64::try_from(hours * 3600 + minute * 60).ok()?;
    Some((sign * seconds, minutes + 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_seconds_since_1970_or_midnight() {
        for (text, expected) in [
            ("1970-01-01T00:00:00Z", Some((0, 0, ""))),
            ("2000-02-29T12:00:00.5Z", Some((9_518_256_005, 1, ""))),
            ("2026-01-31 12:34:56.789012+01:00", Some((1_769_859_296_789_012, 6, ""))),
            ("2026-01-31 12:34:56.789012 +0100 RX", Some((1_769_859_296_789_012, 6, " RX"))),
            ("2026/01/31 11:34:56,789012: 55", Some((1_769_859_296_789_012, 6, ": 55"))),
            ("31.01.2026 11:34:56.789", Some((1_769_859_296_789, 3, ""))),
            ("1/31/2026 11:34:56.789", Some((1_769_859_296_789, 3, ""))),
            ("1969-12-31T23:59:59", Some((-1, 0, ""))),
            ("12:00:00.123] 55", Some((43_200_123, 3, "] 55"))),
            ("9:00:00:123 55", Some((32_400_123, 3, " 55"))),
            ("12:00:00: 55", Some((43_200, 0, ": 55"))),
            ("2026-13-01T00:00:00Z", None),
            ("2026-01-01", None),
            ("0000-01-01T00:00:00Z", None),
            ("24:00:00", None),
            ("12:00", None),
            ("2026-01-31 12:34 55", Some((1_769_862_840, 0, " 55"))),
            ("2026-01-31 12:34:99 55", None),
            ("12:00:00.1234567890123", None),
        ] {
            let found = Stamp::parse(text.as_bytes())
                .map(|stamp| (stamp.seconds.mantissa, stamp.seconds.places, &text[stamp.length..]));
            assert_eq!(found, expected, "{text}");
        }
        let unclear = Stamp::parse(b"05/06/2026 00:00:00").map(|stamp| stamp.dated);
        assert_eq!(unclear, Some(Dated::Ambiguous([5, 6, 2026])));
    }
}
