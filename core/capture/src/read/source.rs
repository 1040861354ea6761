//! Splits a file into lines or words with a bounded buffer.

use super::reading::ReadError;
use std::io::{BufRead, ErrorKind};

/// A row of 64 channels has less than 1000 bytes, but all bytes of a hexadecimal file may be on one line.
pub(super) const MAX_LINE: usize = 1 << 20;
/// Bytes per read, and at the beginning of a file that determine its format.
const PIECE: usize = 1 << 16;
/// Bytes between two calls of `watch`: 10 ms at 26 MB/s.
pub(super) const WATCH_EVERY: u64 = 1 << 18;

/// A file that is being read.
///
/// `start..` of the buffer has not been read yet; at most [`MAX_LINE`] + [`PIECE`] bytes.
pub(super) struct Source<'w, R> {
    input: R,
    watch: &'w mut dyn FnMut(u64) -> bool,
    buffer: Vec<u8>,
    start: usize,
    bytes_read: u64,
    bytes_reported: u64,
    line: u64,
    /// Reported when all bytes before it are taken.
    failed: Option<String>,
}

impl<'w, R: BufRead> Source<'w, R> {
    /// Skips a byte order mark.
    pub(super) fn open(input: R, watch: &'w mut dyn FnMut(u64) -> bool) -> Result<Self, String> {
        let mut source = Self {
            input,
            watch,
            buffer: Vec::new(),
            start: 0,
            bytes_read: 0,
            bytes_reported: 0,
            line: 0,
            failed: None,
        };
        source.fill()?;
        if source.buffer.starts_with(b"\xef\xbb\xbf") {
            source.start = 3;
        }
        Ok(source)
    }

    pub(super) fn head(&self) -> &[u8] {
        self.buffer.get(self.start..).unwrap_or_default()
    }

    pub(super) const fn line(&self) -> u64 {
        self.line
    }

    pub(super) fn into_parts(self) -> (R, &'w mut dyn FnMut(u64) -> bool) {
        (self.input, self.watch)
    }

    /// Reads more behind the last `left` bytes; false at the end of the file.
    fn read_more(&mut self, left: usize) -> Result<bool, String> {
        let start = self.buffer.len() - left;
        check_length(self.buffer.get(start..).unwrap_or_default())?;
        self.start = start;
        self.fill()
    }

    pub(super) fn lines(&mut self, mut each: impl FnMut(&[u8]) -> Result<(), String>) -> Option<ReadError> {
        loop {
            let mut rest = self.buffer.get(self.start..).unwrap_or_default();
            while let Some(length) = rest.iter().position(|byte| *byte == b'\n') {
                self.line += 1;
                let (line, after) = rest.split_at(length);
                if let Err(message) = check_length(line).and_then(|()| each(without_return(line))) {
                    return Some(ReadError { line: self.line, message });
                }
                rest = after.get(1..).unwrap_or_default();
            }
            let left = rest.len();
            match self.read_more(left) {
                Ok(true) => {}
                Ok(false) => break,
                Err(message) => return Some(self.error(message, self.line + 1)),
            }
        }
        let last = self.buffer.get(self.start..).unwrap_or_default();
        if last.is_empty() {
            return None;
        }
        self.line += 1;
        each(without_return(last)).err().map(|message| ReadError { line: self.line, message })
    }

    pub(super) fn words(&mut self, mut each: impl FnMut(&[u8]) -> Result<(), String>) -> Option<ReadError> {
        self.line = 1;
        loop {
            let mut rest = self.buffer.get(self.start..).unwrap_or_default();
            loop {
                let word = rest.iter().position(|byte| !is_blank(*byte)).unwrap_or(rest.len());
                let (blanks, after) = rest.split_at(word);
                self.line += blanks.iter().filter(|byte| **byte == b'\n').count() as u64;
                rest = after;
                let Some(length) = rest.iter().position(|byte| is_blank(*byte)) else { break };
                let (word, after) = rest.split_at(length);
                if let Err(message) = check_length(word).and_then(|()| each(word)) {
                    return Some(ReadError { line: self.line, message });
                }
                rest = after;
            }
            let left = rest.len();
            match self.read_more(left) {
                Ok(true) => {}
                Ok(false) => break,
                Err(message) => return Some(self.error(message, self.line)),
            }
        }
        let last = self.buffer.get(self.start..).unwrap_or_default();
        if last.is_empty() {
            return None;
        }
        each(last).err().map(|message| ReadError { line: self.line, message })
    }

    /// A stop by `watch` belongs to no line.
    fn error(&self, message: String, line: u64) -> ReadError {
        ReadError { line: if message == ReadError::CANCELED { 0 } else { line }, message }
    }

    fn fill(&mut self) -> Result<bool, String> {
        if let Some(message) = self.failed.take() {
            return Err(message);
        }
        self.buffer.drain(..self.start);
        self.start = 0;
        let before = self.buffer.len();
        self.buffer.resize(before + PIECE, 0);
        let mut end = before;
        while let Some(room) = self.buffer.get_mut(end..).filter(|room| !room.is_empty()) {
            match self.input.read(room) {
                Ok(0) => break,
                Ok(count) => end += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => {
                    self.failed = Some(format!("the rest of the file cannot be read: {error}"));
                    break;
                }
            }
        }
        self.buffer.truncate(end);
        self.bytes_read += (end - before) as u64;
        let is_end = end == before;
        if self.bytes_read - self.bytes_reported >= WATCH_EVERY
            || is_end && self.bytes_read > self.bytes_reported
        {
            self.bytes_reported = self.bytes_read;
            if !(self.watch)(self.bytes_read) {
                return Err(ReadError::CANCELED.into());
            }
        }
        match self.failed.take_if(|_| is_end) {
            Some(message) => Err(message),
            None => Ok(!is_end),
        }
    }
}

fn check_length(line: &[u8]) -> Result<(), String> {
    if line.len() <= MAX_LINE {
        return Ok(());
    }
    Err(format!("the line is longer than {MAX_LINE} bytes; use a text file in a supported format"))
}

fn without_return(line: &[u8]) -> &[u8] {
    line.strip_suffix(b"\r").unwrap_or(line)
}

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}
