//! Splits a file into lines or words with a bounded buffer.

use super::reading::ReadError;
use std::io::{BufRead, ErrorKind};

/// A row of 64 channels has less than 1000 bytes, but all bytes of a hexadecimal file may be on one line.
pub(super) const MAX_LINE: usize = 1 << 20;
/// Also the size of the head from which the kind is detected.
const PIECE: usize = 1 << 16;
/// 10 ms at 26 MB/s.
pub(super) const WATCH_EVERY: u64 = 1 << 18;

/// A file that is being read.
///
/// `start..` of the buffer has not been read yet; at most [`MAX_LINE`] + [`PIECE`] bytes.
pub(super) struct Source<'w, R> {
    input: R,
    watch: &'w mut dyn FnMut(u64) -> bool,
    buffer: Vec<u8>,
    start: usize,
    read: u64,
    watched: u64,
    line: u64,
    /// Reported when all bytes before it are taken.
    failed: Option<String>,
}

impl<'w, R: BufRead> Source<'w, R> {
    /// Skips a byte order mark.
    pub(super) fn open(input: R, watch: &'w mut dyn FnMut(u64) -> bool) -> Result<Self, String> {
        let mut source =
            Self { input, watch, buffer: Vec::new(), start: 0, read: 0, watched: 0, line: 0, failed: None };
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
    fn more(&mut self, left: usize) -> Result<bool, String> {
        let start = self.buffer.len() - left;
        bounded(self.buffer.get(start..).unwrap_or_default())?;
        self.start = start;
        self.fill()
    }

    pub(super) fn lines(&mut self, mut each: impl FnMut(&[u8]) -> Result<(), String>) -> Option<ReadError> {
        loop {
            let mut rest = self.buffer.get(self.start..).unwrap_or_default();
            while let Some(length) = rest.iter().position(|byte| *byte == b'\n') {
                self.line += 1;
                let (line, after) = rest.split_at(length);
                if let Err(what) = bounded(line).and_then(|()| each(without_return(line))) {
                    return Some(ReadError { line: self.line, what });
                }
                rest = after.get(1..).unwrap_or_default();
            }
            let left = rest.len();
            match self.more(left) {
                Ok(true) => {}
                Ok(false) => break,
                Err(what) => return Some(self.error(what, self.line + 1)),
            }
        }
        let last = self.buffer.get(self.start..).unwrap_or_default();
        if last.is_empty() {
            return None;
        }
        self.line += 1;
        each(without_return(last)).err().map(|what| ReadError { line: self.line, what })
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
                if let Err(what) = bounded(word).and_then(|()| each(word)) {
                    return Some(ReadError { line: self.line, what });
                }
                rest = after;
            }
            let left = rest.len();
            match self.more(left) {
                Ok(true) => {}
                Ok(false) => break,
                Err(what) => return Some(self.error(what, self.line)),
            }
        }
        let last = self.buffer.get(self.start..).unwrap_or_default();
        if last.is_empty() {
            return None;
        }
        each(last).err().map(|what| ReadError { line: self.line, what })
    }

    /// A stop by `watch` belongs to no line.
    fn error(&self, what: String, line: u64) -> ReadError {
        ReadError { line: if what == ReadError::CANCELLED { 0 } else { line }, what }
    }

    fn fill(&mut self) -> Result<bool, String> {
        if let Some(what) = self.failed.take() {
            return Err(what);
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
                    self.failed = Some(format!("the file cannot be read further: {error}"));
                    break;
                }
            }
        }
        self.buffer.truncate(end);
        self.read += (end - before) as u64;
        let over = end == before;
        if self.read - self.watched >= WATCH_EVERY || over && self.read > self.watched {
            self.watched = self.read;
            if !(self.watch)(self.read) {
                return Err(ReadError::CANCELLED.into());
            }
        }
        match self.failed.take_if(|_| over) {
            Some(what) => Err(what),
            None => Ok(!over),
        }
    }
}

fn bounded(line: &[u8]) -> Result<(), String> {
    if line.len() <= MAX_LINE {
        return Ok(());
    }
    Err(format!("longer than {MAX_LINE} bytes; no kind of file that is read here has such lines"))
}

fn without_return(line: &[u8]) -> &[u8] {
    line.strip_suffix(b"\r").unwrap_or(line)
}

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}
