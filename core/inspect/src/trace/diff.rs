//! Compares a saved trace with a run: a table of edges ([`write_edges_row`](crate::export::tables::write_edges_row))
//! or a trace's text ([`write_record`](stepscope_peripheral::trace::write_record)), in pieces of any size.
//!
//! The file may be a part of a run: its first row has all levels, and the run may continue after its last.
//!
//! ```
//! use stepscope_inspect::trace::{diff::TraceDiff, stored_run::record_run};
//! use stepscope_peripheral::trace::write_record;
//! use stepscope_sim::Experiment;
//!
//! let (_, runs) = record_run(&Experiment::from_json("{}").expect("it is valid"), 1).expect("it is short");
//! let (mut file, mut diff) = (String::new(), TraceDiff::new(1));
//! runs[0].trace.iter().for_each(|&record| write_record(&mut file, record).expect("a string takes it"));
//! diff.feed(&runs[0].trace, file.as_bytes()).expect("it is a trace");
//! assert_eq!(diff.finish(&runs[0].trace).expect("it has edges").difference, None);
//! ```

use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use core::fmt;
use stepscope_peripheral::signal::{self, Levels, Record};
use stepscope_peripheral::trace::{parse_line, shown_signals};
use stepscope_peripheral::units::Instant;

/// Maximum line length in bytes: a row of 36 signals has less than 200.
const MAX_LINE: usize = 1000;

/// A line of the file that is invalid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadLine {
    pub line: u64,
    pub problem: String,
}

impl fmt::Display for BadLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.problem)
    }
}

impl core::error::Error for BadLine {}

/// The first difference of file and run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    pub line: u64,
    pub cycle: Instant,
    pub file: Levels,
    pub run: Levels,
}

impl Difference {
    /// Differing signals; none where the run has ended.
    pub const fn signals(&self) -> u64 {
        self.file.0 ^ self.run.0
    }
}

/// Result of comparing a file with a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    pub same: u64,
    /// First and last cycle that agree.
    pub range: (Instant, Instant),
    pub difference: Option<Difference>,
    /// Whether the run continues after the end of the file.
    pub run_continues: bool,
}

#[derive(Clone, Debug)]
enum FileFormat {
    /// Before the first line.
    Unknown,
    Trace,
    Table(Vec<u32>),
}

/// Compares a file piece by piece. Every method takes the trace of the same run.
#[derive(Clone, Debug)]
pub struct TraceDiff {
    channels: u8,
    format: FileFormat,
    partial: Vec<u8>,
    line: u64,
    next: Option<usize>,
    first: Instant,
    last: Record,
    same: u64,
    difference: Option<Difference>,
}

impl TraceDiff {
    /// For a run of a controller with `channels` channels.
    pub const fn new(channels: u8) -> Self {
        Self {
            channels,
            format: FileFormat::Unknown,
            partial: Vec::new(),
            line: 0,
            next: None,
            first: Instant::RESET,
            last: Record { cycle: Instant::RESET, levels: Levels(0) },
            same: 0,
            difference: None,
        }
    }

    /// Compares the next piece of the file. Returns true if a difference is found, so that the rest is not needed.
    pub fn feed(&mut self, run: &[Record], piece: &[u8]) -> Result<bool, BadLine> {
        for part in piece.split_inclusive(|byte| *byte == b'\n') {
            if self.difference.is_some() {
                return Ok(true);
            }
            self.partial.extend(part.iter().take(MAX_LINE + 1 - self.partial.len().min(MAX_LINE)));
            if part.last() == Some(&b'\n') || self.partial.len() > MAX_LINE {
                self.end_of_line(run)?;
            }
        }
        Ok(self.difference.is_some())
    }

    /// Ends the file; fails if the last line is invalid or the file empty.
    pub fn finish(mut self, run: &[Record]) -> Result<Outcome, BadLine> {
        if !self.partial.is_empty() && self.difference.is_none() {
            self.end_of_line(run)?;
        }
        if self.next.is_none() && self.difference.is_none() {
            return Err(self.bad("the file has no edges".into()));
        }
        Ok(Outcome {
            same: self.same,
            range: (self.first, self.last.cycle),
            difference: self.difference,
            run_continues: self.next.is_some_and(|next| next < run.len()),
        })
    }

    fn bad(&self, problem: String) -> BadLine {
        BadLine { line: self.line, problem }
    }

    fn end_of_line(&mut self, run: &[Record]) -> Result<(), BadLine> {
        self.line += 1;
        let bytes = core::mem::take(&mut self.partial);
        if bytes.len() > MAX_LINE {
            return Err(
                self.bad(format!("longer than {MAX_LINE} characters; use a table of edges or a trace"))
            );
        }
        let text = core::str::from_utf8(&bytes).map_err(|_| self.bad("not UTF-8 text".into()))?;
        let text = text.trim_start_matches('\u{feff}').trim();
        if matches!(self.format, FileFormat::Unknown) {
            if text.starts_with("cycle,") {
                self.format = FileFormat::Table(self.columns(text)?);
                return Ok(());
            }
            self.format = FileFormat::Trace;
        }
        if text.is_empty() {
            return Ok(());
        }
        let record = match &self.format {
            FileFormat::Table(bits) => parse_row(text, bits).map_err(|problem| self.bad(problem))?,
            _ => parse_line(text).map_err(|error| self.bad(error.to_string()))?,
        };
        if self.next.is_some() && record.cycle <= self.last.cycle {
            let (given, before) = (record.cycle.0, self.last.cycle.0);
            return Err(self.bad(format!("cycle {given} follows cycle {before}; cycles must increase")));
        }
        self.compare(run, record);
        Ok(())
    }

    fn columns(&self, head: &str) -> Result<Vec<u32>, BadLine> {
        let expected: Vec<u32> = shown_signals(self.channels).collect();
        let names = expected.iter().filter_map(|bit| signal::name(*bit));
        if head.split(',').skip(2).eq(names) && head.split(',').nth(1) == Some("time_s") {
            return Ok(expected);
        }
        let (given, own) = (head.split(',').count().saturating_sub(2), expected.len());
        Err(self.bad(format!(
            "the columns do not match this controller with {} channels: expected cycle, time_s and {own} signals, found {given} signals",
            self.channels
        )))
    }

    fn compare(&mut self, run: &[Record], record: Record) {
        let next = match self.next {
            Some(next) => next,
            None => {
                self.first = record.cycle;
                let after = run.partition_point(|own| own.cycle <= record.cycle);
                let Some(own) = after.checked_sub(1).and_then(|at| run.get(at)) else {
                    // The file begins before the run.
                    self.differ(record.cycle, record.levels, Levels(0));
                    return;
                };
                if own.levels == record.levels {
                    self.accept(after, record);
                } else {
                    self.differ(record.cycle, record.levels, own.levels);
                }
                return;
            }
        };
        match run.get(next) {
            Some(own) if *own == record => self.accept(next + 1, record),
            Some(own) if own.cycle == record.cycle => self.differ(own.cycle, record.levels, own.levels),
            Some(own) if own.cycle < record.cycle => self.differ(own.cycle, self.last.levels, own.levels),
            _ => self.differ(record.cycle, record.levels, self.last.levels),
        }
    }

    fn accept(&mut self, next: usize, record: Record) {
        self.next = Some(next);
        self.last = record;
        self.same += 1;
    }

    fn differ(&mut self, cycle: Instant, file: Levels, run: Levels) {
        self.difference = Some(Difference { line: self.line, cycle, file, run });
    }
}

fn parse_row(text: &str, bits: &[u32]) -> Result<Record, String> {
    let mut fields = text.split(',');
    let cycle = fields.next().unwrap_or_default();
    let cycle = cycle.parse().map_err(|_| format!("“{cycle}” is not a cycle; use a whole number from 0"))?;
    // The time follows from the cycle.
    let _ = fields.next();
    let mut levels = 0;
    for &bit in bits {
        match fields.next() {
            Some("0") => {}
            Some("1") => levels |= 1 << bit,
            given => {
                let name = signal::name(bit).unwrap_or_default();
                return Err(format!("{name} is “{}”, not a level; use 0 or 1", given.unwrap_or_default()));
            }
        }
    }
    match fields.next() {
        None => Ok(Record { cycle: Instant(cycle), levels: Levels(levels) }),
        Some(_) => Err("more fields than the header has; use the same number".into()),
    }
}

#[cfg(test)]
mod tests;
