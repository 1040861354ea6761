//! Number types of the command line, one per quantity, with a finite range. NaN and values out of range are usage
//! errors.
//!
//! An option has such a type (`error_us: Option<Microseconds>`), or for a whole number the `value_parser` [`whole`].

use std::{fmt, ops::RangeInclusive, str::FromStr};
use stepscope_core::{capture::read::decimal::Decimal, inspect::recording::tolerance::Tolerance};

macro_rules! quantities {
    ($($name:ident: $range:expr, $unit:literal;)*) => {$(
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) struct $name(f64);

        impl $name {
            pub(crate) const fn get(self) -> f64 {
                self.0
            }
        }

        impl FromStr for $name {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, String> {
                let (from, to) = $range.into_inner();
                number(text, from, to, $unit).map(Self)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    )*};
}

quantities! {
    Microseconds: 0.0..=1e9, "microseconds";
    Seconds: 1e-6..=1e9, "seconds";
    Hertz: 1e-6..=1e9, "Hz";
    Millimeters: 1e-9..=1e6, "mm";
    Rate: 1e-6..=1e6, "steps/s";
    Acceleration: 1000.0..=1e9, "steps/s^2";
    AmplitudePart: 1e-6..=1.0, "of the amplitude";
    PeakPart: 0.0..=0.999_999, "of the peak";
}

fn number(text: &str, from: f64, to: f64, unit: &str) -> Result<f64, String> {
    let allowed = || format!("use {from} to {to} {unit}");
    match text.parse::<f64>() {
        Ok(value) if (from..=to).contains(&value) => Ok(value),
        Ok(value) if !value.is_nan() => Err(format!("out of range; {}", allowed())),
        _ => Err(format!("not a number; {}", allowed())),
    }
}

/// The `value_parser` of a type whose errors are messages.
pub(crate) fn parsed<T: FromStr<Err = &'static str>>(text: &str) -> Result<T, String> {
    text.parse().map_err(str::to_owned)
}

/// The `value_parser` of an integer. `range` has no maximum if the number is checked later.
pub(crate) fn whole<T: FromStr>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    let (from, to) = range.into_inner();
    move |text| {
        let found = text.parse::<u64>().ok().filter(|number| (from..=to).contains(number));
        found.and_then(|_| text.parse().ok()).ok_or_else(|| {
            let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
            let is_whole = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit());
            let what = if is_whole { "out of range" } else { "not a whole number" };
            if to == u64::MAX {
                format!("{what}; use {from} or more")
            } else {
                format!("{what}; use {from} to {to}")
            }
        })
    }
}

/// A time in us as an exact decimal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExactMicroseconds(pub(crate) Tolerance);

impl FromStr for ExactMicroseconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.parse::<Microseconds>()?;
        let exact = Decimal::parse(text.as_bytes()).and_then(|number| {
            let number = number.with_places(0)?;
            Tolerance::from_micros(number.mantissa.try_into().ok()?, number.places)
        });
        exact.map(Self).ok_or_else(|| "too many digits; use at most 13 decimal places".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accepts_only_finite_numbers_in_range() {
        let range = "use 0 to 1000000000 microseconds";
        for (text, expected) in [
            ("0", Ok(0.0)),
            ("20", Ok(20.0)),
            ("2.5e1", Ok(25.0)),
            ("1000000000", Ok(1e9)),
            ("-0", Ok(0.0)),
            ("NaN", Err("not a number; ")),
            ("-nan", Err("not a number; ")),
            ("", Err("not a number; ")),
            ("20us", Err("not a number; ")),
            ("20,5", Err("not a number; ")),
            ("inf", Err("out of range; ")),
            ("-inf", Err("out of range; ")),
            ("1e999", Err("out of range; ")),
            ("-1", Err("out of range; ")),
            ("1000000000.1", Err("out of range; ")),
        ] {
            let expected = expected.map_err(|what| format!("{what}{range}"));
            assert_eq!(text.parse::<Microseconds>().map(Microseconds::get), expected, "{text}");
            assert_eq!(text.parse::<ExactMicroseconds>().map(|_| ()), expected.map(|_| ()), "{text}");
        }
        assert_eq!("25".parse::<Microseconds>().expect("a time").to_string(), "25");
        assert!("0.00000000000001".parse::<ExactMicroseconds>().is_err());
    }

    #[test]
    fn accepts_only_whole_numbers_in_range() {
        let parse = whole::<u8>(1..=16);
        assert_eq!(parse("16"), Ok(16));
        for text in ["0", "17", "-1", "256", "18446744073709551616", "-99999999999999999999999"] {
            assert_eq!(parse(text), Err("out of range; use 1 to 16".to_owned()), "{text}");
        }
        for text in ["", "-", "1.5", "1e3", "NaN", "inf", "0x10", "1_000", " 1"] {
            assert_eq!(parse(text), Err("not a whole number; use 1 to 16".to_owned()), "{text}");
        }
        let parse = whole::<std::num::NonZero<usize>>(1..=u64::MAX);
        assert_eq!(parse("0"), Err("out of range; use 1 or more".to_owned()));
        assert!(parse("18446744073709551616").is_err());
    }
}
