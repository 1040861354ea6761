//! Step tables as source code that a firmware is built with, and as CSV (DESIGN Part D).
//!
//! The entries go into three arrays, so that a table takes exactly the bytes of its numbers on every machine:
//!
//! ```text
//! NAME_interval[]  NAME_count[]  NAME_add[]        of NAME_ENTRIES entries each
//! ```
//!
//! What the numbers mean and how to walk them stands in the comment at the head of the file; CSV has a head line alone.
//!
//! ```
//! use stepscope_inspect::source_code::{Language, Source, is_name};
//! use stepscope_motion::{
//!     moves::Axis,
//!     plan_axis,
//!     quantise::{EntryFormat, Form, stored},
//! };
//! use stepscope_peripheral::{segment::PulseTimes, units::Cycles};
//!
//! let plan = plan_axis(&Axis::default(), "x").expect("it can be planned");
//! let pulse = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) };
//! let table = stored(&plan, Form::Exact, EntryFormat::Q16, pulse, 16_000_000).expect("it fits");
//! assert!(is_name("axis_0"));
//! let source = Source { name: "axis_0", title: "one turn", clock_hz: 16_000_000, table: &table };
//! let mut text = String::new();
//! source.write(Language::C, &mut text).expect("a string takes it");
//! assert!(text.contains("#define AXIS_0_STEPS 3200ull"));
//! ```

use alloc::{format, string::String};
use core::fmt::{self, Write};
use stepscope_motion::quantise::{Entry, Stored};
use stepscope_motion::round_half_up;

/// Numbers in a line.
const IN_A_LINE: usize = 8;

/// The language of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// C99.
    C,
    /// C for avr-gcc, the arrays in program memory.
    Avr,
    /// Rust without the standard library.
    Rust,
    /// Comma-separated values.
    Csv,
}

/// A table and what its file says of it.
#[derive(Clone, Copy, Debug)]
pub struct Source<'s> {
    /// Name of the table, an identifier in small letters such as `axis_0`; see [`is_name`].
    pub name: &'s str,
    /// What it is, in a line.
    pub title: &'s str,
    /// The clock whose cycles are counted, in Hz.
    pub clock_hz: u32,
    /// The table.
    pub table: &'s Stored,
}

/// Whether a name can stand in the source code of every language: a small letter, then small letters, digits and
/// underscores, at most 32, and with a digit or an underscore among them, so that it is no keyword.
#[must_use]
pub fn is_name(name: &str) -> bool {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.len() <= 32
        && name.chars().all(fits)
        && !name.chars().all(|c| c.is_ascii_lowercase())
}

/// What a file says that it is: the scenario's title, if it has one, the axis and the form of its table.
#[must_use]
pub fn headline(title: &str, axis: usize, form: &str) -> String {
    let separator = if title.is_empty() { "" } else { ": " };
    format!("{title}{separator}axis {axis}, {form} step table")
}

impl Source<'_> {
    /// Writes the file.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, language: Language, out: &mut impl Write) -> fmt::Result {
        match language {
            Language::C => self.c(out, false),
            Language::Avr => self.c(out, true),
            Language::Rust => self.rust(out),
            Language::Csv => self.csv(out),
        }
    }

    /// The comment at the head, each line after `mark`.
    fn head(&self, out: &mut impl Write, mark: &str) -> fmt::Result {
        let format = self.table.format;
        let error = self.table.error;
        // A comment in C must not end before its end, nor may a line be continued.
        let plain = |c: char| {
            if c.is_control() || matches!(c, '*' | '\\' | '\u{2028}' | '\u{2029}') { ' ' } else { c }
        };
        write!(out, "{mark}")?;
        self.title.chars().take(200).map(plain).try_for_each(|c| out.write_char(c))?;
        let nanos = |cycles: f64| round_half_up(cycles * 1e9 / f64::from(self.clock_hz.max(1)));
        writeln!(out, "\n{}", mark.trim_end())?;
        writeln!(
            out,
            "{mark}{} steps in {} entries of {} bytes ({}), {} bytes in all.",
            error.steps,
            self.table.entries.len(),
            format.bytes(),
            format.name,
            self.table.bytes()
        )?;
        writeln!(
            out,
            "{mark}Largest timing error {} cycles ({} ns), r.m.s. {:.2} cycles ({} ns).",
            error.greatest,
            nanos(error.greatest as f64),
            error.rms(),
            nanos(error.rms())
        )?;
        writeln!(out, "{}", mark.trim_end())?;
        writeln!(
            out,
            "{mark}Clock: {} Hz. Unit of interval and add: 1/{} cycle.",
            self.clock_hz,
            1_u32 << format.fraction_bits
        )?;
        writeln!(out, "{mark}To walk it, begin with time = 0 and DIR = 0, and for each entry")?;
        writeln!(out, "{mark}  with count > 0, count times:")?;
        writeln!(
            out,
            "{mark}    time += interval; make a step at cycle time >> {}; interval += add",
            format.fraction_bits
        )?;
        writeln!(out, "{mark}  with count = 0: time += interval; DIR = add (0 left, 1 right)")
    }

    fn c(&self, out: &mut impl Write, avr: bool) -> fmt::Result {
        let (name, format) = (self.name, self.table.format);
        let capitals = Capitals(name);
        writeln!(out, "/*")?;
        self.head(out, " * ")?;
        writeln!(out, " */\n#include <stdint.h>")?;
        if avr {
            writeln!(out, "#include <avr/pgmspace.h>")?;
        }
        writeln!(out)?;
        writeln!(out, "#define {capitals}_ENTRIES {}ul", self.table.entries.len())?;
        writeln!(out, "#define {capitals}_STEPS {}ull", self.table.error.steps)?;
        writeln!(out, "#define {capitals}_FRACTION_BITS {}", format.fraction_bits)?;
        writeln!(out, "#define {capitals}_CLOCK_HZ {}ul", self.clock_hz)?;
        // An array has an element in C.
        let length = self.table.entries.len().max(1);
        let memory = if avr { " PROGMEM" } else { "" };
        for column in Column::ALL {
            let kind = match column {
                Column::Interval => format!("uint{}_t", format.interval_bits),
                Column::Count => format!("uint{}_t", format.count_bits),
                Column::Add => format!("int{}_t", format.add_bits),
            };
            writeln!(out, "\nconst {kind} {name}_{}[{length}]{memory} = {{", column.name())?;
            if self.table.entries.is_empty() {
                writeln!(out, "0")?;
            }
            self.numbers(out, |out, entry| match column {
                Column::Interval => write!(out, "{}ull", entry.interval),
                Column::Count => write!(out, "{}ul", entry.count),
                // The least number of all has no literal.
                Column::Add if entry.add == i64::MIN => write!(out, "-9223372036854775807ll - 1"),
                Column::Add => write!(out, "{}ll", entry.add),
            })?;
            writeln!(out, "}};")?;
        }
        Ok(())
    }

    fn rust(&self, out: &mut impl Write) -> fmt::Result {
        let (capitals, format) = (Capitals(self.name), self.table.format);
        self.head(out, "// ")?;
        writeln!(out, "\n/// Steps of the table.")?;
        writeln!(out, "pub const {capitals}_STEPS: u64 = {};", self.table.error.steps)?;
        writeln!(out, "/// Bits of a cycle's fraction in interval and add.")?;
        writeln!(out, "pub const {capitals}_FRACTION_BITS: u32 = {};", format.fraction_bits)?;
        writeln!(out, "/// The clock whose cycles are counted, in Hz.")?;
        writeln!(out, "pub const {capitals}_CLOCK_HZ: u32 = {};", self.clock_hz)?;
        for column in Column::ALL {
            let (kind, about) = match column {
                Column::Interval => (
                    format!("u{}", format.interval_bits),
                    "Time before an entry's first step, or of its wait.",
                ),
                Column::Count => (format!("u{}", format.count_bits), "Steps; 0 for a wait."),
                Column::Add => (
                    format!("i{}", format.add_bits),
                    "What each next interval is longer; of a wait the level of DIR after it.",
                ),
            };
            let (array, length) = (Capitals(column.name()), self.table.entries.len());
            writeln!(out, "\n/// {about}\npub static {capitals}_{array}: [{kind}; {length}] = [")?;
            self.numbers(out, |out, entry| match column {
                Column::Interval => write!(out, "{}", entry.interval),
                Column::Count => write!(out, "{}", entry.count),
                Column::Add => write!(out, "{}", entry.add),
            })?;
            writeln!(out, "];")?;
        }
        Ok(())
    }

    fn csv(&self, out: &mut impl Write) -> fmt::Result {
        let bits = self.table.format.fraction_bits;
        writeln!(out, "interval_q{bits},count,add_q{bits}")?;
        let mut rows = self.table.entries.iter();
        rows.try_for_each(|entry| writeln!(out, "{},{},{}", entry.interval, entry.count, entry.add))
    }

    /// One number of every entry, some in a line.
    fn numbers<W: Write>(&self, out: &mut W, one: impl Fn(&mut W, &Entry) -> fmt::Result) -> fmt::Result {
        for line in self.table.entries.chunks(IN_A_LINE) {
            write!(out, "   ")?;
            for entry in line {
                write!(out, " ")?;
                one(out, entry)?;
                write!(out, ",")?;
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

/// One of the arrays.
#[derive(Clone, Copy)]
enum Column {
    Interval,
    Count,
    Add,
}

impl Column {
    const ALL: [Self; 3] = [Self::Interval, Self::Count, Self::Add];

    const fn name(self) -> &'static str {
        match self {
            Self::Interval => "interval",
            Self::Count => "count",
            Self::Add => "add",
        }
    }
}

/// A name in capitals.
struct Capitals<'n>(&'n str);

impl fmt::Display for Capitals<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|c| f.write_char(c.to_ascii_uppercase()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{string::String, vec, vec::Vec};
    use stepscope_motion::quantise::{EntryFormat, TimingError};
    use stepscope_peripheral::{segment::SegmentList, units::Instant};

    fn written(entries: Vec<Entry>, title: &str, language: Language) -> String {
        let list = SegmentList { start: Instant(1), segments: Vec::new() };
        let (format, error) = (EntryFormat::Q16, TimingError::default());
        let table = Stored { list, format, entries, document_bytes: None, error };
        let mut out = String::new();
        Source { name: "axis_0", title, clock_hz: 16_000_000, table: &table }
            .write(language, &mut out)
            .unwrap();
        out
    }

    #[test]
    fn a_title_cannot_end_the_comment_that_it_stands_in() {
        for title in ["*/ int main", "two\nlines", "back\\", "\u{2028}"] {
            let c = written(Vec::new(), title, Language::C);
            assert_eq!(c.matches("*/").count(), 1, "{c}");
            let rust = written(Vec::new(), title, Language::Rust);
            assert!(!rust.contains("\nlines"), "{rust}");
        }
    }

    #[test]
    fn the_least_and_the_greatest_numbers_have_their_literals() {
        let entry = Entry { interval: u64::MAX, count: u32::MAX, add: i64::MIN };
        let c = written(vec![entry], "", Language::C);
        for literal in ["18446744073709551615ull", "4294967295ul", "-9223372036854775807ll - 1"] {
            assert!(c.contains(literal), "{c}");
        }
        let csv = written(vec![entry], "", Language::Csv);
        let row = "18446744073709551615,4294967295,-9223372036854775808";
        assert_eq!(csv, format!("interval_q16,count,add_q16\n{row}\n"));
    }

    #[test]
    fn a_name_is_an_identifier_and_no_keyword() {
        for (name, expected) in
            [("axis_0", true), ("x1", true), ("int", false), ("", false), ("a-1", false), ("_a", false)]
        {
            assert_eq!(is_name(name), expected, "{name}");
        }
    }
}
