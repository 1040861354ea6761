//! Reads tables of separated values, with line numbers for messages.

use alloc::string::{String, ToString};
use alloc::{format, vec, vec::Vec};
use core::fmt;
use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

/// Maximum bytes of a table.
pub const MAX_TABLE_BYTES: usize = 32 << 20;

/// Why a table cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BadTable {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub what: String,
}

impl fmt::Display for BadTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.what)
    }
}

impl core::error::Error for BadTable {}

pub(super) fn short(text: &str) -> String {
    text.chars().take(20).chain((text.chars().count() > 20).then_some('…')).collect()
}

pub(super) struct Rows<'a> {
    text: &'a str,
    /// Bytes read so far.
    pub(super) position: usize,
    reader: Reader,
}

impl<'a> Rows<'a> {
    pub(super) fn new(text: &'a str, separator: u8) -> Result<Self, BadTable> {
        let bytes = text.len();
        if bytes > MAX_TABLE_BYTES {
            let what = format!("{bytes} bytes are too many; use at most {MAX_TABLE_BYTES}");
            return Err(BadTable { line: 1, what });
        }
        let reader = ReaderBuilder::new().delimiter(separator).build();
        Ok(Self { text: text.trim_start_matches('\u{feff}'), position: 0, reader })
    }

    pub(super) fn error_at(&self, position: usize, what: String) -> BadTable {
        // Skip line ends, so that the number is the row's own.
        let rest = self.text.get(position..).unwrap_or_default();
        let begin = position + rest.len() - rest.trim_start_matches(['\r', '\n']).len();
        let before = self.text.get(..begin).unwrap_or_default();
        BadTable { line: 1 + before.matches('\n').count(), what }
    }

    pub(super) fn next(&mut self) -> Option<(usize, Vec<String>)> {
        let begin = self.position;
        let (mut out, mut ends) = (vec![0; 256], vec![0; 16]);
        let (mut written, mut fields) = (0, 0);
        loop {
            let (result, read, wrote, ended) = self.reader.read_record(
                self.text.as_bytes().get(self.position..).unwrap_or_default(),
                out.get_mut(written..).unwrap_or_default(),
                ends.get_mut(fields..).unwrap_or_default(),
            );
            (self.position, written, fields) = (self.position + read, written + wrote, fields + ended);
            match result {
                // The reader reports the end at a call without input.
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
