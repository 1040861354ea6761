//! What an exported file of step tables has in every language: the tables, their size, error and origin.

use super::origin::Origin;
use alloc::{format, string::String, vec::Vec};
use core::fmt::{self, Write as _};
use stepscope_motion::step_tables::{Entry, Stored, TableEvent, TableWalk};

/// Name of the file of the walker that tables in C include.
pub const WALKER_FILE: &str = "stepscope_walk.h";

/// Maximum bytes of an array. avr-gcc has signed 16-bit sizes, and C99 requires no more.
const MAX_AVR_BYTES: u64 = 32_767;
const MAX_C_BYTES: u64 = 65_535;
/// Bytes of program memory that an AVR reads by near pointers.
const NEAR_BYTES: u64 = 65_536;

/// The language of an exported step table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    C,
    /// C with arrays in program memory (avr-gcc).
    Avr,
    Rust,
    Csv,
}

impl Language {
    /// As `--format` names it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::C => "c",
            Self::Avr => "avr",
            Self::Rust => "rust",
            Self::Csv => "csv",
        }
    }
}

/// A step table and the prefix of its identifiers, which must be valid for [`check_name`](super::check_name).
#[derive(Clone, Debug)]
pub struct NamedTable<'s> {
    pub name: String,
    pub table: &'s Stored,
}

/// Step tables to write as one file of source code.
#[derive(Clone, Copy, Debug)]
pub struct Source<'s> {
    /// Name of the include guard; for one table its own name.
    pub name: &'s str,
    /// CSV takes only the first.
    pub tables: &'s [NamedTable<'s>],
    pub clock_hz: u32,
    pub origin: &'s Origin,
}

impl Source<'_> {
    /// Size and error of each table, and where they are from, one line each.
    pub(super) fn head(&self, language: Language) -> Vec<String> {
        let mut lines = Vec::new();
        for named in self.tables {
            let NamedTable { name, table } = named;
            let (error, format) = (table.error, table.format);
            let is_c = matches!(language, Language::C | Language::Avr);
            let count = if is_c { named.entries().len() } else { table.entries.len() };
            let bytes = count as u64 * format.bytes();
            // A struct of 64-bit numbers has padding on most machines, and none on an AVR.
            let is_padded = language == Language::C && format.widths().contains(&64);
            let padded =
                |bytes: u64| if is_padded { format!(" ({bytes} with padding)") } else { String::new() };
            lines.push(format!(
                "{name}: {} in {} of {} bytes{}, {bytes} bytes{}; largest timing error {} ({} us), r.m.s. {}.",
                counted(error.steps, "step", "steps"),
                counted(count as u64, "entry", "entries"),
                format.bytes(),
                padded(24),
                padded(24 * count as u64),
                counted(error.max_cycles, "cycle", "cycles"),
                self.micros(error.max_cycles as f64),
                short(error.rms()),
            ));
            if let Some(shortest) = Extremes::of(table.walk()).shortest {
                lines.push(format!(
                    "The largest error is {} % of the shortest step interval, {} ({} us).",
                    short(100.0 * error.max_cycles as f64 / shortest as f64),
                    counted(shortest, "cycle", "cycles"),
                    self.micros(shortest as f64)
                ));
            }
        }
        let bits = self.tables.first().map_or(0, |first| first.table.format.fraction_bits());
        let unit = if bits == 0 { "cycles".into() } else { format!("1/{} cycle", 1_u32 << bits) };
        lines.push(format!("Clock: {} Hz. Unit of interval and add: {unit}. Do not edit.", self.clock_hz));
        lines.push(self.origin.made_by.clone());
        lines
    }

    fn micros(&self, cycles: f64) -> String {
        short(cycles * 1e6 / f64::from(self.clock_hz.max(1)))
    }

    /// What a compiler or chip may reject, with numbers and a fix.
    pub fn warnings(&self, language: Language) -> Vec<String> {
        let (max_bytes, allows) = match language {
            Language::Avr => (MAX_AVR_BYTES, "avr-gcc allows"),
            Language::C => (MAX_C_BYTES, "C99 compilers may allow only"),
            Language::Rust | Language::Csv => return Vec::new(),
        };
        let fix = "use --form compressed with a larger error, or one table per part of the motion";
        let (mut warnings, mut sum) = (Vec::new(), 0);
        for named in self.tables {
            let format = named.table.format;
            let is_padded = language == Language::C && format.widths().contains(&64);
            let bytes = named.entries().len() as u64 * if is_padded { 24 } else { format.bytes() };
            sum += bytes;
            if bytes > max_bytes {
                warnings.push(format!(
                    "{}_entries has {bytes} bytes; {allows} {max_bytes} bytes per array; {fix}",
                    named.name
                ));
            }
        }
        if language == Language::Avr && sum > NEAR_BYTES {
            warnings.push(format!(
                "the tables have {sum} bytes; the walker reads only the first {NEAR_BYTES} bytes of program memory; {fix}"
            ));
        }
        warnings
    }
}

impl NamedTable<'_> {
    /// C has no empty arrays: a table without steps is a wait of 0.
    pub(super) fn entries(&self) -> &[Entry] {
        const NONE: &[Entry] = &[Entry { interval: 0, count: 0, add: 0 }];
        if self.table.entries.is_empty() { NONE } else { &self.table.entries }
    }
}

/// Times of a table's walk, in cycles.
#[derive(Default)]
pub(super) struct Extremes {
    /// Shortest event, without waits of 0.
    pub(super) min: Option<u64>,
    pub(super) max: u64,
    /// From one step to the next.
    pub(super) shortest: Option<u64>,
}

impl Extremes {
    pub(super) fn of(walk: TableWalk<'_>) -> Self {
        let mut extremes = Self::default();
        let mut since_step: Option<u64> = None;
        let shorter = |found: Option<u64>, cycles: u64| Some(found.map_or(cycles, |found| found.min(cycles)));
        for event in walk {
            let (TableEvent::Step { cycles, .. } | TableEvent::Wait { cycles, .. }) = event;
            since_step = since_step.map(|before| before.saturating_add(cycles));
            extremes.max = extremes.max.max(cycles);
            if matches!(event, TableEvent::Step { .. }) || cycles > 0 {
                extremes.min = shorter(extremes.min, cycles);
            }
            if matches!(event, TableEvent::Step { .. }) {
                if let Some(interval) = since_step {
                    extremes.shortest = shorter(extremes.shortest, interval);
                }
                since_step = Some(0);
            }
        }
        extremes
    }
}

pub(super) fn counted(number: u64, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// Three significant digits or more, without trailing zeros.
fn short(number: f64) -> String {
    let decimals = match number {
        100.0.. => 0,
        10.0.. => 1,
        1.0.. => 2,
        0.1.. => 3,
        _ => 5,
    };
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

pub(super) struct Capitals<'n>(pub(super) &'n str);

impl fmt::Display for Capitals<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.chars().try_for_each(|c| f.write_char(c.to_ascii_uppercase()))
    }
}
