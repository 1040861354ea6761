//! Exact decimal numbers: an integer and the number of its decimal places.
//!
//! ```text
//! 0.00125   125 and 5 places        1e-05   1 and 5 places        -2.5E3   -2500 and 0 places
//! ```
//!
//! ```
//! use stepscope_capture::read::decimal::Decimal;
//!
//! assert_eq!(Decimal::parse(b"0.00125"), Some(Decimal { mantissa: 125, places: 5 }));
//! ```

/// `mantissa / 10^places`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimal {
    pub mantissa: i128,
    pub places: u32,
}

/// Maximum number of digits without leading zeros.
const MAX_DIGITS: u32 = 30;

impl Decimal {
    /// Reads a number with optional sign, point and exponent; `None` if it is not one or does not fit.
    pub fn parse(text: &[u8]) -> Option<Self> {
        let (negative, text) = match text {
            [b'-', rest @ ..] => (true, rest),
            [b'+', rest @ ..] => (false, rest),
            _ => (false, text),
        };
        // 18 digits fit into 64 bits, which is faster and enough for most files.
        let (mut mantissa, mut wide_mantissa) = (0_u64, None::<u128>);
        let (mut digits, mut places, mut has_point) = (0_u32, 0_u32, false);
        let mut has_digit = false;
        let mut rest = text;
        while let [byte, after @ ..] = rest {
            match byte {
                b'0'..=b'9' => {
                    has_digit = true;
                    let digit = byte - b'0';
                    digits += u32::from(digits > 0 || digit > 0);
                    places += u32::from(has_point);
                    if digits <= 18 {
                        mantissa = mantissa * 10 + u64::from(digit);
                    } else if digits <= MAX_DIGITS {
                        wide_mantissa =
                            Some(wide_mantissa.unwrap_or_else(|| mantissa.into()) * 10 + u128::from(digit));
                    } else {
                        return None;
                    }
                }
                b'.' if !has_point => has_point = true,
                _ => break,
            }
            rest = after;
        }
        let exponent = match rest {
            [] => 0,
            [b'e' | b'E', power @ ..] => exponent(power)?,
            _ => return None,
        };
        let mantissa = i128::try_from(wide_mantissa.unwrap_or_else(|| mantissa.into())).ok()?;
        let number = Self { mantissa: if negative { -mantissa } else { mantissa }, places };
        if has_digit { number.shifted(exponent) } else { None }
    }

    /// Like [`Self::parse`], also with a decimal comma.
    pub(super) fn parse_with_comma(text: &[u8]) -> Option<Self> {
        Self::parse(text).or_else(|| {
            let comma = text.iter().position(|byte| *byte == b',')?;
            let mut text = text.to_vec();
            *text.get_mut(comma)? = b'.';
            Self::parse(&text)
        })
    }

    pub(super) fn shifted(self, exponent: i32) -> Option<Self> {
        let places = i64::from(self.places) - i64::from(exponent);
        if let Ok(places) = u32::try_from(places) {
            return (places <= 60).then_some(Self { places, ..self });
        }
        let mantissa = self.mantissa.checked_mul(power_of_ten(u32::try_from(-places).ok()?)?)?;
        Some(Self { mantissa, places: 0 })
    }

    /// The same number with at least `places` places; `None` if it does not fit.
    pub fn with_places(self, places: u32) -> Option<Self> {
        if self.places <= places {
            let mantissa = self.mantissa.checked_mul(power_of_ten(places - self.places)?)?;
            return Some(Self { mantissa, places });
        }
        let mut number = self;
        while number.places > places && number.mantissa % 10 == 0 {
            number.mantissa /= 10;
            number.places -= 1;
        }
        Some(number)
    }

    pub(super) fn minus(self, other: Self) -> Option<Self> {
        let places = self.places.max(other.places);
        let mantissa = |number: Self| number.mantissa.checked_mul(power_of_ten(places - number.places)?);
        Some(Self { mantissa: mantissa(self)?.checked_sub(mantissa(other)?)?, places })
    }

    /// Rounded to exactly `places` places, halves up; `None` if it does not fit.
    pub(super) fn rounded(self, places: u32) -> Option<Self> {
        let number = self.with_places(places)?;
        let Some(unit) = power_of_ten(number.places - places) else {
            return Some(Self { mantissa: 0, places });
        };
        let mantissa = number.mantissa.checked_add(unit / 2)?.div_euclid(unit);
        Some(Self { mantissa, places })
    }

    pub(super) fn whole(self) -> Option<i128> {
        self.with_places(0).filter(|number| number.places == 0).map(|number| number.mantissa)
    }
}

pub(super) const fn power_of_ten(power: u32) -> Option<i128> {
    10_i128.checked_pow(power)
}

fn exponent(text: &[u8]) -> Option<i32> {
    let digits = text.strip_prefix(b"-").or_else(|| text.strip_prefix(b"+")).unwrap_or(text);
    if !(1..=4).contains(&digits.len()) || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let value = digits.iter().fold(0, |value, digit| value * 10 + i32::from(digit - b'0'));
    Some(if text.starts_with(b"-") { -value } else { value })
}

pub(super) fn whole(text: &[u8]) -> Option<u64> {
    if text.is_empty() {
        return None;
    }
    text.iter().try_fold(0_u64, |value, byte| {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 { None } else { value.checked_mul(10)?.checked_add(digit.into()) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact_and_what_is_none_is_refused() {
        for (text, expected) in [
            ("0", Some((0, 0))),
            ("0.00125", Some((125, 5))),
            ("-0.5", Some((-5, 1))),
            ("+7.", Some((7, 0))),
            (".25", Some((25, 2))),
            ("1e-05", Some((1, 5))),
            ("2.5e-05", Some((25, 6))),
            ("1.25E3", Some((1250, 0))),
            ("0.000000000000123456789012345", Some((123_456_789_012_345, 27))),
            ("12345678901234567890.5", Some((123_456_789_012_345_678_905, 1))),
            ("1e-60", Some((1, 60))),
            ("1e-61", None),
            ("1e99999", None),
            ("1e400", None),
            ("1234567890123456789012345678901", None),
            ("", None),
            (".", None),
            ("-", None),
            ("1e", None),
            ("e5", None),
            ("1.2.3", None),
            ("0x10", None),
            ("1 ", None),
        ] {
            let parsed = Decimal::parse(text.as_bytes()).map(|number| (number.mantissa, number.places));
            assert_eq!(parsed, expected, "{text}");
        }
        assert_eq!(Decimal::parse(b"12.00").and_then(Decimal::whole), Some(12));
        assert_eq!(Decimal::parse(b"12.50").and_then(Decimal::whole), None);
        let rounded =
            |text: &str, places| Decimal::parse(text.as_bytes())?.rounded(places).map(|found| found.mantissa);
        for (text, places, expected) in [
            ("0.25", 1, Some(3)),
            ("-0.25", 1, Some(-2)),
            ("5.000000000000013e-06", 18, Some(5_000_000_000_000)),
            ("5.0000000000005e-06", 18, Some(5_000_000_000_001)),
            ("1e-60", 0, Some(0)),
            ("7", 3, Some(7000)),
            ("1e30", 18, None),
        ] {
            assert_eq!(rounded(text, places), expected, "{text}");
        }
        assert_eq!(whole(b"18446744073709551615"), Some(u64::MAX));
        assert_eq!(whole(b"18446744073709551616"), None);
    }
}
