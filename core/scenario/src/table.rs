//! Tables of comma-separated values as they are read: rows, each with its place, and messages that
//! name the line.

use alloc::{
    format,
    string::{String, ToString},
    vec,
    vec::Vec,
};
use core::fmt;
use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

/// Most bytes of a table that is read.
pub const MAX_TABLE_BYTES: usize = 32 << 20;

/// Why a table cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadTable {
    /// Line of the text, from 1.
    pub line: usize,
    /// What is wrong there.
    pub what: String,
}

impl fmt::Display for BadTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.what)
    }
}

impl core::error::Error for BadTable {}

/// The beginning of a text that a message quotes.
pub(super) fn short(text: &str) -> String {
    text.chars().take(20).chain((text.chars().count() > 20).then_some('…')).collect()
}

/// The rows of a table, each with the place where it begins.
pub(super) struct Rows<'a> {
    text: &'a str,
    pub(super) at: usize,
    reader: Reader,
}

impl<'a> Rows<'a> {
    /// Of a text whose fields have `separator` between them.
    ///
    /// # Errors
    /// If it has more than [`MAX_TABLE_BYTES`].
    pub(super) fn new(text: &'a str, separator: u8) -> Result<Self, BadTable> {
        let bytes = text.len();
        if bytes > MAX_TABLE_BYTES {
            let what = format!("{bytes} bytes are too many; at most {MAX_TABLE_BYTES}");
            return Err(BadTable { line: 1, what });
        }
        let reader = ReaderBuilder::new().delimiter(separator).build();
        Ok(Self { text: text.trim_start_matches('\u{feff}'), at: 0, reader })
    }

    /// What is wrong with the row that begins at `at`.
    pub(super) fn bad(&self, at: usize, what: String) -> BadTable {
        // Line ends before a row belong to the one before it.
        let rest = self.text.get(at..).unwrap_or_default();
        let begin = at + rest.len() - rest.trim_start_matches(['\r', '\n']).len();
        let before = self.text.get(..begin).unwrap_or_default();
        BadTable { line: 1 + before.matches('\n').count(), what }
    }

    /// The next row and where it begins.
    pub(super) fn next(&mut self) -> Option<(usize, Vec<String>)> {
        let begin = self.at;
        let (mut out, mut ends) = (vec![0; 256], vec![0; 16]);
        let (mut written, mut fields) = (0, 0);
        loop {
            let (result, read, wrote, ended) = self.reader.read_record(
                self.text.as_bytes().get(self.at..).unwrap_or_default(),
                out.get_mut(written..).unwrap_or_default(),
                ends.get_mut(fields..).unwrap_or_default(),
            );
            (self.at, written, fields) = (self.at + read, written + wrote, fields + ended);
            match result {
                // Once more without input: that is how the reader learns of the end.
                ReadRecordResult::InputEmpty => {}
                ReadRecordResult::OutputFull => out.resize(out.len() * 2, 0),
                ReadRecordResult::OutputEndsFull => ends.resize(ends.len() * 2, 0),
                ReadRecordResult::End => return None,
                ReadRecordResult::Record => break,
            }
        }
        let mut from = 0;
        let row = ends.iter().take(fields).map(|&end| {
            let field = out.get(from..end).unwrap_or_default();
            from = end;
            String::from_utf8_lossy(field).to_string()
        });
        Some((begin, row.collect()))
    }
}
