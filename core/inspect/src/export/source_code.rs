//! Step tables as source code for firmware, and as CSV (DESIGN Part D).
//!
//! Three arrays `NAME_interval`, `NAME_count` and `NAME_add` take exactly the bytes of their numbers on every
//! machine. A comment at the head of the file explains them.

use crate::export::plain_text::needs_escape;
use alloc::{format, string::String, vec::Vec};
use core::fmt::{self, Write};
use stepscope_motion::round_half_up;
use stepscope_motion::step_tables::{Entry, EntryFormat, Stored};

const NUMBERS_PER_LINE: usize = 8;
/// Maximum bytes of an array. avr-gcc has signed 16-bit sizes, and C99 requires no more.
const MAX_AVR_BYTES: u64 = 32_767;
const MAX_C_BYTES: u64 = 65_535;
/// Bytes of program memory that an AVR reads by near pointers.
const NEAR_BYTES: u64 = 65_536;
/// Prefixes that C reserves for functions of its headers (C11 7.31), if a lowercase letter follows.
const RESERVED_FUNCTIONS: [&str; 6] = ["is", "to", "str", "mem", "wcs", "e"];
/// Prefixes that C reserves for types and uppercase macros; `errno.h` also reserves `e` with a digit.
const RESERVED_TYPES: [&str; 13] =
    ["int", "uint", "sig", "lc_", "fe_", "pri", "scn", "atomic_", "memory_", "cnd_", "mtx_", "thrd_", "tss_"];

/// The language of an exported step table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    C,
    /// C with arrays in program memory (avr-gcc).
    Avr,
    Rust,
    Csv,
}

/// A step table to write as source code.
#[derive(Clone, Copy, Debug)]
pub struct Source<'s> {
    /// Prefix of all identifiers; must be valid for [`is_name`].
    pub name: &'s str,
    /// First line of the comment; unsafe characters become spaces.
    pub title: &'s str,
    pub clock_hz: u32,
    pub table: &'s Stored,
}

/// Whether a name is an identifier in every language: up to 32 lowercase letters, digits and underscores, starting with
/// a letter. A digit or underscore is required, so that it is not a keyword.
pub fn is_name(name: &str) -> bool {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_lowercase())
        && name.len() <= 32
        && name.chars().all(fits)
        && !name.chars().all(|c| c.is_ascii_lowercase())
        && !is_reserved(name)
}

fn is_reserved(name: &str) -> bool {
    let follows = |start: &str, fits: fn(char) -> bool| {
        name.strip_prefix(start).is_some_and(|rest| rest.starts_with(fits))
    };
    RESERVED_FUNCTIONS.iter().any(|start| follows(start, |c| c.is_ascii_lowercase()))
        || follows("e", |c| c.is_ascii_digit())
        || RESERVED_TYPES.iter().any(|start| name.starts_with(start))
}

/// The title of a table: the scenario's title, the axis and the form.
pub fn headline(title: &str, axis: usize, form: &str) -> String {
    let separator = if title.is_empty() { "" } else { ": " };
    format!("{title}{separator}axis {axis}, {form} step table")
}

impl Source<'_> {
    /// Writes the table as a complete file.
    pub fn write(&self, language: Language, out: &mut impl Write) -> fmt::Result {
        match language {
            Language::C => self.c(out, false),
            Language::Avr => self.c(out, true),
            Language::Rust => self.rust(out),
            Language::Csv => self.csv(out),
        }
    }

    fn comment(&self, out: &mut impl Write, prefix: &str) -> fmt::Result {
        let format = self.table.format;
        let error = self.table.error;
        // Keeps the text from ending the comment, continuing the line, or reordering it.
        let plain = |c: char| {
            if needs_escape(c) || matches!(c, '*' | '\\') { ' ' } else { c }
        };
        write!(out, "{prefix}")?;
        self.title.chars().take(200).map(plain).try_for_each(|c| out.write_char(c))?;
        let nanos = |cycles: f64| round_half_up(cycles * 1e9 / f64::from(self.clock_hz.max(1)));
        writeln!(out, "\n{}", prefix.trim_end())?;
        writeln!(
            out,
            "{prefix}{} steps in {} entries of {} bytes ({}): {} bytes in total.",
            error.steps,
            self.table.entries.len(),
            format.bytes(),
            format.name,
            self.table.bytes()
        )?;
        writeln!(
            out,
            "{prefix}Largest timing error {} cycles ({} ns), RMS {:.2} cycles ({} ns).",
            error.max_cycles,
            nanos(error.max_cycles as f64),
            error.rms(),
            nanos(error.rms())
        )?;
        writeln!(out, "{}", prefix.trim_end())?;
        writeln!(
            out,
            "{prefix}Clock: {} Hz. Unit of interval and add: 1/{} cycle.",
            self.clock_hz,
            1_u32 << format.fraction_bits()
        )?;
        writeln!(out, "{prefix}To use the table, start with time = 0 and DIR = 0. For each entry")?;
        writeln!(out, "{prefix}  with count > 0, repeat count times:")?;
        writeln!(
            out,
            "{prefix}    time += interval; make a step at cycle time >> {}; interval += add",
            format.fraction_bits()
        )?;
        writeln!(out, "{prefix}  with count = 0: time += interval; DIR = add (0 left, 1 right)")?;
        let Maxima { time, interval } = self.maxima();
        let (time_bits, interval_bits) = (bits(time), bits(interval));
        writeln!(
            out,
            "{prefix}time reaches {time}: {time_bits} bits (uint{}_t), or fewer if it is relative to the last step.",
            width(time_bits)
        )?;
        writeln!(
            out,
            "{prefix}interval reaches {interval}: {interval_bits} bits (uint{}_t).",
            width(interval_bits)
        )
    }

    /// The maximum values of the variables that execute the table.
    fn maxima(&self) -> Maxima {
        let mut maxima = Maxima::default();
        for entry in &self.table.entries {
            let (count, first, add) =
                (i128::from(entry.count), i128::from(entry.interval), i128::from(entry.add));
            // For a wait, `add` is a direction.
            let (duration, last) = match count {
                0 => (first, first),
                _ => (first * count + add * (count * (count - 1) / 2), first + add * (count - 1)),
            };
            maxima.time += u128::try_from(duration).unwrap_or(0);
            maxima.interval = maxima.interval.max(u128::try_from(first.max(last)).unwrap_or(0));
        }
        maxima
    }

    /// What a compiler or chip may reject, with numbers and a fix.
    pub fn warnings(&self, language: Language) -> Vec<String> {
        let format = self.table.format;
        let entries = self.table.entries.len() as u64;
        let (max_bytes, allows) = match language {
            Language::Avr => (MAX_AVR_BYTES, "avr-gcc allows"),
            Language::C => (MAX_C_BYTES, "C99 compilers may allow only"),
            Language::Rust | Language::Csv => return Vec::new(),
        };
        let fix = "use a larger error, narrower entries, or one table per part of the motion";
        let mut warnings = Vec::new();
        for column in Column::ALL {
            let bytes = entries * u64::from(column.bits(format) / 8);
            if bytes > max_bytes {
                warnings.push(format!(
                    "{}_{} has {bytes} bytes; {allows} {max_bytes} bytes per array; {fix}",
                    self.name,
                    column.name()
                ));
            }
        }
        if language == Language::Avr && self.table.bytes() > NEAR_BYTES {
            warnings.push(format!(
                "the table has {} bytes; pgm_read_byte reaches only the first {NEAR_BYTES} bytes of program memory; use pgm_read_byte_far, or {fix}",
                self.table.bytes()
            ));
        }
        warnings
    }

    fn c(&self, out: &mut impl Write, avr: bool) -> fmt::Result {
        let (capitals, format) = (Capitals(self.name), self.table.format);
        writeln!(out, "/*")?;
        self.comment(out, " * ")?;
        for warning in self.warnings(if avr { Language::Avr } else { Language::C }) {
            writeln!(out, " *\n * WARNING: {warning}.")?;
        }
        writeln!(out, " */\n#ifndef {capitals}_H\n#define {capitals}_H\n\n#include <stdint.h>")?;
        if avr {
            writeln!(out, "#include <avr/pgmspace.h>")?;
        }
        writeln!(out)?;
        writeln!(out, "#define {capitals}_ENTRIES {}ul", self.table.entries.len())?;
        writeln!(out, "#define {capitals}_STEPS {}ull", self.table.error.steps)?;
        writeln!(out, "#define {capitals}_FRACTION_BITS {}", format.fraction_bits())?;
        writeln!(out, "#define {capitals}_CLOCK_HZ {}ul", self.clock_hz)?;
        Column::ALL.iter().try_for_each(|column| self.c_array(out, *column, avr))?;
        writeln!(out, "\n#endif")
    }

    fn c_array(&self, out: &mut impl Write, column: Column, avr: bool) -> fmt::Result {
        // C has no empty arrays.
        let length = self.table.entries.len().max(1);
        let memory = if avr { " PROGMEM" } else { "" };
        let sign = if matches!(column, Column::Add) { "" } else { "u" };
        let bits = column.bits(self.table.format);
        let (name, array) = (self.name, column.name());
        writeln!(out, "\nstatic const {sign}int{bits}_t {name}_{array}[{length}]{memory} = {{")?;
        if self.table.entries.is_empty() {
            writeln!(out, "0")?;
        }
        // Literals are as wide as the array's type: `int` has 16 bits on an AVR.
        let suffix = match bits {
            ..=16 => "",
            17..=32 => "l",
            _ => "ll",
        };
        let min = self.table.format.min_add();
        self.numbers(out, |out, entry| match column {
            Column::Interval => write!(out, "{}u{suffix}", entry.interval),
            Column::Count => write!(out, "{}u{suffix}", entry.count),
            // The minimum of a type has no literal.
            Column::Add if entry.add == min => write!(out, "{}{suffix} - 1", entry.add + 1),
            Column::Add => write!(out, "{}{suffix}", entry.add),
        })?;
        writeln!(out, "}};")
    }

    fn rust(&self, out: &mut impl Write) -> fmt::Result {
        let (capitals, format) = (Capitals(self.name), self.table.format);
        self.comment(out, "// ")?;
        writeln!(out, "\n/// Steps of the table.")?;
        writeln!(out, "pub const {capitals}_STEPS: u64 = {};", self.table.error.steps)?;
        writeln!(out, "/// Fractional bits of interval and add.")?;
        writeln!(out, "pub const {capitals}_FRACTION_BITS: u32 = {};", format.fraction_bits())?;
        writeln!(out, "/// Clock of the cycles, in Hz.")?;
        writeln!(out, "pub const {capitals}_CLOCK_HZ: u32 = {};", self.clock_hz)?;
        for column in Column::ALL {
            let (kind, about) = match column {
                Column::Interval => (
                    format!("u{}", column.bits(format)),
                    "Time before an entry's first step, or of its wait.",
                ),
                Column::Count => (format!("u{}", column.bits(format)), "Steps; 0 for a wait."),
                Column::Add => (
                    format!("i{}", column.bits(format)),
                    "Increment of the interval after each step; for a wait the level of DIR after it.",
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
        let bits = self.table.format.fraction_bits();
        writeln!(out, "interval_q{bits},count,add_q{bits}")?;
        let mut rows = self.table.entries.iter();
        rows.try_for_each(|entry| writeln!(out, "{},{},{}", entry.interval, entry.count, entry.add))
    }

    fn numbers<W: Write>(&self, out: &mut W, one: impl Fn(&mut W, &Entry) -> fmt::Result) -> fmt::Result {
        for line in self.table.entries.chunks(NUMBERS_PER_LINE) {
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

    const fn bits(self, format: EntryFormat) -> u32 {
        let [interval, count, add] = format.widths();
        match self {
            Self::Interval => interval,
            Self::Count => count,
            Self::Add => add,
        }
    }
}

#[derive(Default)]
struct Maxima {
    time: u128,
    interval: u128,
}

const fn bits(number: u128) -> u32 {
    u128::BITS - number.leading_zeros()
}

const fn width(bits: u32) -> u32 {
    match bits {
        ..=16 => 16,
        17..=32 => 32,
        33..=64 => 64,
        _ => 128,
    }
}

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
    use stepscope_motion::step_tables::{EntryFormat, TimingError};
    use stepscope_peripheral::{segment::SegmentList, units::Instant};

    fn table(entries: Vec<Entry>, format: EntryFormat) -> Stored {
        let list = SegmentList { start: Instant(1), segments: Vec::new() };
        Stored { list, format, entries, document_bytes: None, error: TimingError::default(), surplus: None }
    }

    fn source<'s>(table: &'s Stored, title: &'s str) -> Source<'s> {
        Source { name: "axis_0", title, clock_hz: 16_000_000, table }
    }

    fn written(entries: Vec<Entry>, title: &str, language: Language) -> String {
        let mut out = String::new();
        source(&table(entries, EntryFormat::Q16), title).write(language, &mut out).unwrap();
        out
    }

    #[test]
    fn literals_are_as_wide_as_their_arrays() {
        let entry = Entry { interval: 887_218, count: 3, add: i64::from(i16::MIN) };
        let mut c = String::new();
        source(&table(vec![entry], EntryFormat::TICKS), "").write(Language::Avr, &mut c).unwrap();
        for line in [" 887218ul,", " 3u,", " -32767 - 1,"] {
            assert!(c.lines().any(|found| found.trim_start() == line.trim_start()), "{line} in {c}");
        }
    }

    #[test]
    fn the_comment_gives_the_width_of_the_variables() {
        // 3 steps after 10, 15 and 20 cycles, and a wait of 100: 145 cycles.
        let entries = vec![
            Entry { interval: 10 << 16, count: 3, add: 5 << 16 },
            Entry { interval: 100 << 16, count: 0, add: 1 },
        ];
        let c = written(entries, "", Language::C);
        let (time, interval) = (145 << 16, 100 << 16);
        for line in [
            format!(
                " * time reaches {time}: 24 bits (uint32_t), or fewer if it is relative to the last step."
            ),
            format!(" * interval reaches {interval}: 23 bits (uint32_t)."),
        ] {
            assert!(c.lines().any(|found| found == line), "{line} in {c}");
        }
        assert!(c.contains("#ifndef AXIS_0_H\n#define AXIS_0_H\n") && c.ends_with("\n#endif\n"), "{c}");
    }

    #[test]
    fn too_long_an_array_is_a_warning() {
        let entry = Entry { interval: 1, count: 1, add: 0 };
        let warnings = |entries: usize, language| {
            let table = table(vec![entry; entries], EntryFormat::Q16);
            source(&table, "").warnings(language).len()
        };
        // 8, 4 and 8 bytes a row: of 4095 rows none has more than 32767 bytes, of 4096 two arrays.
        assert_eq!((warnings(4095, Language::Avr), warnings(4096, Language::Avr)), (1, 3));
        assert_eq!((warnings(3276, Language::Avr), warnings(3277, Language::Avr)), (0, 1));
        assert_eq!((warnings(8191, Language::C), warnings(8192, Language::C)), (0, 2));
        assert_eq!(warnings(100_000, Language::Rust), 0);
        let long = vec![entry; 8192];
        let c = written(long, "", Language::C);
        assert!(
            c.contains(" * WARNING: axis_0_interval has 65536 bytes; C99 compilers may allow only 65535 bytes per array"),
            "{}",
            &c[..1500]
        );
    }

    #[test]
    fn a_title_cannot_end_its_comment() {
        for title in ["*/ int main", "two\nlines", "back\\", "\u{2028}"] {
            let c = written(Vec::new(), title, Language::C);
            assert_eq!(c.matches("*/").count(), 1, "{c}");
            let rust = written(Vec::new(), title, Language::Rust);
            assert!(!rust.contains("\nlines"), "{rust}");
        }
    }

    #[test]
    fn minimum_and_maximum_numbers_are_written_as_literals() {
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
        for (name, expected) in [
            ("axis_0", true),
            ("x1", true),
            ("e_1", true),
            ("is_1", true),
            ("total_1", false),
            ("memory_1", false),
            ("e1_x", false),
            ("uint32_t", false),
            ("sigma_1", false),
            ("int", false),
            ("", false),
            ("a-1", false),
            ("_a", false),
        ] {
            assert_eq!(is_name(name), expected, "{name}");
        }
    }

    #[test]
    fn a_table_is_three_arrays() {
        use crate::export::source_code::{Language, Source, is_name};
        use stepscope_motion::{
            moves::Axis,
            plan_axis,
            step_tables::{EntryFormat, Form, stored},
        };
        use stepscope_peripheral::{segment::PulseTimes, units::Cycles};

        let plan = plan_axis(&Axis::default(), "x").expect("it can be planned");
        let pulse = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) };
        let table = stored(&plan, Form::Exact, EntryFormat::Q16, pulse, 16_000_000).expect("it fits");
        assert!(is_name("axis_0"));
        let source = Source { name: "axis_0", title: "one turn", clock_hz: 16_000_000, table: &table };
        let mut text = String::new();
        source.write(Language::C, &mut text).expect("a string takes it");
        assert!(text.contains("#define AXIS_0_STEPS 3200ull"));
    }
}
