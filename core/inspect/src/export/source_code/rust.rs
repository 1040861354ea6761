//! Rust: an array per number of an entry.

use super::source::{Capitals, Language, NamedTable, Source};
use alloc::format;
use core::fmt::{self, Write};
use stepscope_motion::step_tables::{Entry, EntryFormat, Stored};

const NUMBERS_PER_LINE: usize = 8;

impl Source<'_> {
    pub(super) fn rust(&self, out: &mut impl Write) -> fmt::Result {
        let mut head = self.head(Language::Rust);
        head.push(format!("{}.", self.origin.inputs));
        head.retain(|line| line != ".");
        head.iter().try_for_each(|line| writeln!(out, "// {line}"))?;
        let bits = self.tables.first().map_or(0, |first| first.table.format.fraction_bits());
        writeln!(out, "//\n// To use a table, start with time = 0 and DIR = 0. For each entry")?;
        writeln!(out, "//   with count > 0, repeat count times:")?;
        writeln!(out, "//     time += interval; make a step at cycle time >> {bits}; interval += add")?;
        writeln!(out, "//   with count = 0: time += interval; DIR = add (0 left, 1 right)")?;
        self.tables.iter().try_for_each(|named| self.rust_table(out, named))
    }

    fn rust_table(&self, out: &mut impl Write, named: &NamedTable<'_>) -> fmt::Result {
        let NamedTable { name, table } = named;
        let (capitals, format) = (Capitals(name), table.format);
        writeln!(out, "\n/// Steps of the table.")?;
        writeln!(out, "pub const {capitals}_STEPS: u64 = {};", table.error.steps)?;
        writeln!(out, "/// Fractional bits of interval and add.")?;
        writeln!(out, "pub const {capitals}_FRACTION_BITS: u32 = {};", format.fraction_bits())?;
        writeln!(out, "/// Clock of the cycles, in Hz.")?;
        writeln!(out, "pub const {capitals}_CLOCK_HZ: u32 = {};", self.clock_hz)?;
        writeln!(out, "/// Largest timing error of a step, in cycles.")?;
        writeln!(out, "pub const {capitals}_MAX_ERROR_CYCLES: u64 = {};", table.error.max_cycles)?;
        Column::ALL.iter().try_for_each(|column| column.write(out, name, table))
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
            Self::Interval => "INTERVAL",
            Self::Count => "COUNT",
            Self::Add => "ADD",
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

    fn write(self, out: &mut impl Write, name: &str, table: &Stored) -> fmt::Result {
        let (sign, about) = match self {
            Self::Interval => ('u', "Time before an entry's first step, or of its wait."),
            Self::Count => ('u', "Steps; 0 for a wait."),
            Self::Add => {
                ('i', "Increment of the interval after each step; for a wait the level of DIR after it.")
            }
        };
        let (bits, length) = (self.bits(table.format), table.entries.len());
        let (capitals, array) = (Capitals(name), self.name());
        writeln!(out, "\n/// {about}\npub static {capitals}_{array}: [{sign}{bits}; {length}] = [")?;
        for line in table.entries.chunks(NUMBERS_PER_LINE) {
            write!(out, "   ")?;
            for Entry { interval, count, add } in line {
                match self {
                    Self::Interval => write!(out, " {interval},")?,
                    Self::Count => write!(out, " {count},")?,
                    Self::Add => write!(out, " {add},")?,
                }
            }
            writeln!(out)?;
        }
        writeln!(out, "];")
    }
}
