//! Options and result of reading a file.

use super::base::Base;
use crate::capture::Capture;
use core::fmt;

/// Limits of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Changes, bytes or positions: a byte or position takes 16 bytes, a change usually two to four.
    pub max_rows: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { max_rows: 120_000_000 }
    }
}

/// Choices that a file leaves open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Channels to read first: full names or their last parts.
    pub channels: Vec<String>,
    /// Base of decoded bytes; `None` detects it.
    pub base: Option<Base>,
}

/// Why a reading ended early.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// Line of the text, from 1; 0 if the file has no lines.
    pub line: u64,
    /// The problem and its fix.
    pub message: String,
}

impl ReadError {
    /// The text of `message` after `watch` has canceled reading.
    pub const CANCELED: &str = "canceled";

    pub(super) const fn of_file(message: String) -> Self {
        Self { line: 0, message }
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        f.write_str(&self.message)
    }
}

impl core::error::Error for ReadError {}

/// The contents up to the end or the first error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reading {
    pub capture: Capture,
    /// Why reading stopped before the end of the file.
    pub error: Option<ReadError>,
}

pub(super) trait Reader {
    /// Reads a line or word. Errors: the problem and its fix.
    fn take(&mut self, text: &[u8]) -> Result<(), String>;

    fn finish(self) -> (Capture, Result<(), String>);
}
