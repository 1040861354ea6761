//! Texts about a move, with numbers as people write them.

use alloc::{format, string::String};

/// An integer with digit groups and a true minus.
#[must_use]
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

/// Text about the longest ramp with which a bus can follow a move of `duration_s`.
pub(super) fn ramp_up_to(longest_s: Option<f64>, duration_s: f64) -> String {
    longest_s.map_or_else(String::new, |longest_s| {
        let longest_s = longest_s.min(duration_s / 2.0);
        format!("; with a ramp of up to {longest_s:.4} s the bus can still follow")
    })
}

/// A number with its noun, in the plural unless it is one.
pub(super) fn count(number: u64, one: &str, several: &str) -> String {
    format!("{} {}", grouped(number as f64), if number == 1 { one } else { several })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_by_thousands() {
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
