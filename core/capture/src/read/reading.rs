//! What is given to a reading, and what comes of it.

use super::base::Base;
use crate::capture::Capture;
use core::fmt;

/// How much is read of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Most changes, bytes or positions: of bytes and positions 16 bytes each, of changes mostly two to four.
    pub most: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { most: 120_000_000 }
    }
}

/// What whoever reads a file decides.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// Channels that are read before all others: whole names, or their last parts.
    pub channels: Vec<String>,
    /// The base of decoded bytes; without it their digits or the head of their column tell it.
    pub base: Option<Base>,
}

/// Where a file goes wrong, and how.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// Line of a text, from 1; 0 where the file has no lines.
    pub line: u64,
    /// What was found, what is allowed, what to change.
    pub what: String,
}

impl ReadError {
    /// What `what` is when `watch` has ended the reading.
    pub const CANCELLED: &str = "cancelled";

    /// Of the file as a whole.
    pub(super) const fn whole(what: String) -> Self {
        Self { line: 0, what }
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        f.write_str(&self.what)
    }
}

impl core::error::Error for ReadError {}

/// What came of reading: all up to the end, or up to where it went wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reading {
    /// What could be read.
    pub capture: Capture,
    /// Why that is not all.
    pub error: Option<ReadError>,
}

/// A reader of a text: takes its lines (or words) one by one.
pub(super) trait Reader {
    /// Takes the next line or word; its text says what is wrong with it.
    fn take(&mut self, text: &[u8]) -> Result<(), String>;

    /// The file is over: what was read, and what is missing at its end.
    fn finish(self) -> (Capture, Result<(), String>);
}
