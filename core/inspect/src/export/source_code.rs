//! Step tables as source code for firmware, and as CSV (DESIGN Part D, BINDINGS section 3).
//!
//! C has one array of structs per table, walked by `stepscope_walk.h` ([`WALKER`]); Rust has three arrays
//! `NAME_INTERVAL`, `NAME_COUNT` and `NAME_ADD`. A comment at the head of the file has its size, error and origin.

mod c;
mod name;
mod origin;
mod read;
mod rust;
mod source;

pub use name::check_name;
pub use origin::{Origin, Request, quoted, unquoted};
pub use read::{WrittenTable, first_axis, read_c};
pub use source::{Language, NamedTable, Source, WALKER_FILE};

use core::fmt::{self, Write};

/// The walker that tables in C include, as a file.
pub const WALKER: &str = include_str!("../../include/stepscope_walk.h");

impl Source<'_> {
    /// Writes the tables as a complete file. The same tables give the same bytes.
    pub fn write(&self, language: Language, out: &mut impl Write) -> fmt::Result {
        match language {
            Language::C => self.c(out, false),
            Language::Avr => self.c(out, true),
            Language::Rust => self.rust(out),
            Language::Csv => self.csv(out),
        }
    }

    fn csv(&self, out: &mut impl Write) -> fmt::Result {
        let Some(NamedTable { table, .. }) = self.tables.first() else { return Ok(()) };
        let bits = table.format.fraction_bits();
        writeln!(out, "interval_q{bits},count,add_q{bits}")?;
        let mut rows = table.entries.iter();
        rows.try_for_each(|entry| writeln!(out, "{},{},{}", entry.interval, entry.count, entry.add))
    }
}

#[cfg(test)]
mod tests;
