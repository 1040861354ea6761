//! A trace as text: one record per line, cycle and levels in hexadecimal with a space between.

use crate::signal::{Levels, Record};
use crate::units::Instant;
use core::fmt;

/// Writes one record and a line feed: `1f4a 700000001`.
pub fn write_record(out: &mut impl fmt::Write, record: Record) -> fmt::Result {
    writeln!(out, "{:x} {:x}", record.cycle.0, record.levels.0)
}

/// A line that is not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParseError;

impl fmt::Display for ParseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("not a record; use the cycle and the levels in hexadecimal, separated by a space")
    }
}

impl core::error::Error for ParseError {}

/// Reads a line written by [`write_record`].
/// Errors: [`ParseError`] if it is not a record.
pub fn parse_line(line: &str) -> Result<Record, ParseError> {
    let (cycle, levels) = line.trim_end().split_once(' ').ok_or(ParseError)?;
    let number = |text| u64::from_str_radix(text, 16).map_err(|_| ParseError);
    Ok(Record { cycle: Instant(number(cycle)?), levels: Levels(number(levels)?) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;

    #[test]
    fn writing_and_parsing_are_inverses() {
        for (cycle, levels) in [(0, 0), (0x1f4a, 0x7_0000_0001), (u64::MAX, 0xf_ffff_ffff)] {
            let record = Record { cycle: Instant(cycle), levels: Levels(levels) };
            let mut text = String::new();
            write_record(&mut text, record).expect("strings do not fail");
            assert_eq!(parse_line(&text), Ok(record));
        }
        for line in ["", "1", "1 ", "1 g", "-1 0"] {
            assert_eq!(parse_line(line), Err(ParseError), "{line:?}");
        }
    }
}
