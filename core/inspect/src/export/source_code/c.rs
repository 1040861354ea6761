//! C99, for avr-gcc in program memory. `stepscope_walk.h` has the types and makes the functions.

use super::source::{Capitals, Extremes, Language, NamedTable, Source, WALKER_FILE};
use alloc::{format, string::String};
use core::fmt::{self, Write};
use stepscope_motion::step_tables::EntryFormat;

const ENTRIES_PER_LINE: usize = 4;

impl Source<'_> {
    pub(super) fn c(&self, out: &mut impl Write, avr: bool) -> fmt::Result {
        let language = if avr { Language::Avr } else { Language::C };
        let guard = Capitals(self.name);
        let mut head = self.head(language);
        let inputs = &self.origin.inputs;
        let end = if inputs.is_empty() || inputs.ends_with('.') { "" } else { ". " };
        let name = self.tables.first().map_or(self.name, |first| first.name.as_str());
        head.push(format!("{inputs}{end}Walk it with {name}_begin() and {name}_next()."));
        head.extend(self.warnings(language).into_iter().map(|warning| format!("WARNING: {warning}.")));
        writeln!(out, "/* {} */", head.join("\n * "))?;
        writeln!(out, "#ifndef {guard}_TABLE_H\n#define {guard}_TABLE_H\n\n#include \"{WALKER_FILE}\"")?;
        self.tables.iter().try_for_each(|named| self.c_table(out, named, avr))?;
        writeln!(out, "\n#endif")
    }

    fn c_table(&self, out: &mut impl Write, named: &NamedTable<'_>, avr: bool) -> fmt::Result {
        let NamedTable { name, table } = named;
        let capitals = Capitals(name);
        let (entries, extremes) = (named.entries(), Extremes::of(table.walk()));
        let kind = if table.format == EntryFormat::Q16 {
            "q16"
        } else if table.format == EntryFormat::Q8 {
            "q8"
        } else {
            "ticks"
        };
        writeln!(out, "\n#define {capitals}_ENTRIES {}", count(entries.len() as u64))?;
        writeln!(out, "#define {capitals}_STEPS {}", long(table.error.steps))?;
        writeln!(out, "#define {capitals}_CLOCK_HZ {}", long(self.clock_hz.into()))?;
        writeln!(out, "#define {capitals}_FRACTION_BITS {}", count(table.format.fraction_bits().into()))?;
        writeln!(out, "#define {capitals}_MAX_ERROR_CYCLES {}", long(table.error.max_cycles))?;
        writeln!(
            out,
            "#define {capitals}_MIN_CYCLES {} /* shortest event of {name}_next(), without waits of 0 */",
            long(extremes.min.unwrap_or(0))
        )?;
        writeln!(out, "#define {capitals}_MAX_CYCLES {}", long(extremes.max))?;
        let memory = if avr { " PROGMEM" } else { "" };
        writeln!(
            out,
            "\nstatic const stepscope_{kind}_entry {name}_entries[{capitals}_ENTRIES]{memory} = {{"
        )?;
        // Literals are as wide as their type: `int` has 16 bits on an AVR.
        let (wide, suffixes) = match table.format.widths() {
            [64, ..] => ("LL", ["ULL", "UL"]),
            _ => ("", ["UL", "U"]),
        };
        let [interval, steps] = suffixes;
        for line in entries.chunks(ENTRIES_PER_LINE) {
            write!(out, "   ")?;
            for entry in line {
                // The minimum of a type has no literal.
                let add = if entry.add == table.format.min_add() {
                    format!("({}{wide} - 1{wide})", entry.add + 1)
                } else {
                    format!("{}{wide}", entry.add)
                };
                write!(out, " {{{}{interval}, {}{steps}, {add}}},", entry.interval, entry.count)?;
            }
            writeln!(out)?;
        }
        let memory = if avr { "_P" } else { "" };
        writeln!(out, "}};\n\nSTEPSCOPE_{}_TABLE{memory}({name})", Capitals(kind))
    }
}

fn count(number: u64) -> String {
    if number > u16::MAX.into() { long(number) } else { format!("{number}U") }
}

fn long(number: u64) -> String {
    format!("{number}{}", if number > u32::MAX.into() { "ULL" } else { "UL" })
}
