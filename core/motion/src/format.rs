//! Formats numbers in texts about a move.

use alloc::{format, string::String};

/// `value` rounded to an integer, with groups of three digits and a minus sign (U+2212).
pub fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let whole = digits.trim_start_matches('-');
    let mut text = String::from(if whole.len() < digits.len() { "\u{2212}" } else { "" });
    for (index, digit) in whole.chars().enumerate() {
        if index > 0 && (whole.len() - index) % 3 == 0 {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Text about the longest ramp of a move of `duration_s` within the bus limit; empty if there is none.
pub(super) fn ramp_up_to(longest_s: Option<f64>, duration_s: f64) -> String {
    longest_s.map_or_else(String::new, |longest_s| {
        let longest_s = longest_s.min(duration_s / 2.0);
        format!("; the bus limit allows ramps of up to {longest_s:.4} s")
    })
}

pub(super) fn count(number: u64, singular: &str, plural: &str) -> String {
    format!("{} {}", grouped(number as f64), if number == 1 { singular } else { plural })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_digits_by_thousands() {
        let rows = [
            (0.0, "0"),
            (999.4, "999"),
            (1000.0, "1\u{202f}000"),
            (-1_234_567.0, "\u{2212}1\u{202f}234\u{202f}567"),
        ];
        for (given, expected) in rows {
            assert_eq!(grouped(given), expected);
        }
        assert_eq!((count(1, "row", "rows"), count(0, "row", "rows")), ("1 row".into(), "0 rows".into()));
    }
}
